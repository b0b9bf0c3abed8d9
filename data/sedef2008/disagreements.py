#!/usr/bin/env python3
"""Makes the recordings and models with which palpate explain looks into the disagreements of Sedef 2008.

    data/sedef2008/disagreements.py DIR second-arm   N = 1 (Table 4.2) against the curves of Table 4.3, one depth
    data/sedef2008/disagreements.py DIR static       one law for static loading (Eq. 4.2) and for holds (Table 4.3)
    data/sedef2008/disagreements.py DIR network      27 nodes with constant arms against one lumped material

Each writes DIR/model.json, the model that misses something, and DIR/run_*.csv with 4 mN of noise.

second-arm: three recordings (1 s ramp, 200 s hold) of the row of Table 4.3, the model its row of Table 4.2.
static: the force of Eq. 4.2 itself at 0.1 mm/s to 9.7 mm, twice, and holds at six depths with the arms of
    Table 4.5 beside K_inf(e), the parabola through the twelve K_inf of Table 4.3 (their scatter about it is told);
    the model has Eq. 4.3 and the arms of Table 4.5. With --rows each hold has the K_inf of its own row.
network: Eq. 4.3 with the one arm of Table 4.4, ramps and holds from 2 mm to 9 mm; the model is a network with
    --nodes nodes a side from palpate calibrate, its arm fitted to all depths and constant in strain.

Needs the palpate command (build/palpate, or $PALPATE)."""
import argparse
import json
import os
import subprocess
import sys

from recordings import PALPATE, model, rows

LAW = [8.18, -0.70, 47.47, -131.36, 146.89]


def run(*words):
    subprocess.run([PALPATE, *map(str, words)], check=True, stdout=subprocess.DEVNULL)


def write(folder, name, content):
    with open(os.path.join(folder, name), "w") as f:
        json.dump(content, f, indent=1)
    return os.path.join(folder, name)


def lumped(law, arms):
    m = model(rows("table_4_3.csv")[0])
    m["stiffness"]["coefficients_N"] = law
    m["arms"] = [{"stiffness_N": k, "viscosity_Ns": b} for k, b in arms]
    return m


def table_4_5():
    row = rows("table_4_5.csv")[0]
    return [(row["K%d_N" % j], row["b%d_Ns" % j]) for j in (1, 2)]


def press(o, what, name, seed, *protocol):
    run("simulate", what, *protocol, "--air-s", 1, "--noise-N", 0.004, "--seed", seed,
        "--out", os.path.join(o.dir, "run_%s.csv" % name))


def hold(o, what, name, seed, depth_mm):
    press(o, what, name, seed, "--protocol", "ramp_hold", "--depth-mm", depth_mm, "--ramp-s", 1, "--hold-s", 200,
          "--sample-Hz", o.sample_Hz)


def second_arm(o):
    i = [row["depth_mm"] for row in rows("table_4_3.csv")].index(o.depth_mm)
    one, two = rows("table_4_2.csv")[i], rows("table_4_3.csv")[i]
    write(o.dir, "model.json", lumped([one["Kinf_N"]], [(one["K1_N"], one["b1_Ns"])]))
    truth = write(o.dir, "truth.json", model(two))
    for seed in (1, 2, 3):
        hold(o, truth, seed, seed, o.depth_mm)


def parabola(x, y):
    """Least squares through the points, by the normal equations."""
    a = [[sum(u ** (i + j) for u in x) for j in range(3)] + [sum(v * u ** i for u, v in zip(x, y))] for i in range(3)]
    for i in range(3):
        for j in range(3):
            if j != i:
                f = a[j][i] / a[i][i]
                a[j] = [p - f * q for p, q in zip(a[j], a[i])]
    return [a[i][3] / a[i][i] for i in range(3)]


def static(o):
    table = rows("table_4_3.csv")
    strain, k = [r["strain"] for r in table], [r["Kinf_N"] for r in table]
    law = parabola(strain, k)
    off = [v - sum(c * u ** i for i, c in enumerate(law)) for u, v in zip(strain, k)]
    print("K_inf(e) of the holds: %.3f %+.3f e %+.3f e^2 N, scatter of the rows %.3f N"
          % (*law, (sum(v * v for v in off) / len(off)) ** 0.5))
    write(o.dir, "model.json", lumped(LAW, table_4_5()))
    for seed, row in enumerate(r for r in table if r["depth_mm"] in (2, 3, 4, 5, 6, 7)):
        truth = write(o.dir, "hold.json", lumped([row["Kinf_N"]] if o.rows else law, table_4_5()))
        hold(o, truth, "hold_%dmm" % row["depth_mm"], seed + 1, row["depth_mm"])
    truth = write(o.dir, "static.json", lumped(LAW, []))
    for seed in (11, 12):
        press(o, truth, "static_%d" % (seed - 10), seed, "--protocol", "static", "--depth-mm", 9.7,
              "--rate-mm-s", 0.1, "--sample-Hz", o.sample_Hz)


def network(o):
    arm = rows("table_4_4.csv")[0]
    truth = write(o.dir, "truth.json", lumped(LAW, [(arm["K1_N"], arm["b1_Ns"])]))
    run("calibrate", truth, "--nodes", o.nodes, "--scaling", "none", "--stage", "all",
        "--out", os.path.join(o.dir, "model.json"))
    for seed, depth in enumerate((2, 4, 6, 8, 9)):
        hold(o, truth, "%dmm" % depth, seed + 1, depth)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("dir", help="folder for what is made; made if need be")
    p.add_argument("which", choices=["second-arm", "static", "network"])
    p.add_argument("--depth-mm", type=float, default=6.0, help="of second-arm (default 6)")
    p.add_argument("--rows", action="store_true", help="static: each hold with the K_inf of its row")
    p.add_argument("--nodes", type=int, default=3, help="of network (default 3)")
    p.add_argument("--sample-Hz", type=float, default=5)
    o = p.parse_args()
    os.makedirs(o.dir, exist_ok=True)
    try:
        {"second-arm": second_arm, "static": static, "network": network}[o.which](o)
    except subprocess.CalledProcessError as failed:
        sys.exit(failed.returncode)
    except (OSError, ValueError) as failed:
        sys.exit("%s" % failed)


if __name__ == "__main__":
    main()
