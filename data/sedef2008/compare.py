#!/usr/bin/env python3
"""Prints the tables of Chapters 4 and 5 of Sedef 2008 beside what palpate finds by the same procedures.

    data/sedef2008/compare.py [TABLE ...] [--depth-mm 2,6,9] [--formulation history] [--dwell equilibrium] [--plot DIR]

TABLE is 4.1 to 4.5, 5.1 to 5.8, 5.7-peaks or 5.8-peaks (the printed coefficients' own peak forces beside the lumped model's);
all of them without one. A row tells the column, ours, the thesis' and the deviation:
in percent of the thesis' value, of errors that are percentages themselves in percentage points. After each table comes
the largest deviation of every column, in lines that begin with "worst". --plot writes figures of the tables over depths, DIR/table_4_2.json
and so on, which tools/picture.py draws: Figures 4.17, 4.19, 5.22 to 5.24 and 5.26 to 5.29.

The thesis' recordings are not printed in it. Table 4.1 is fitted to the force of Eq. 4.2 (the table's fifth degree, whose
residual is taken for the noise that the others have too) as MATLAB's polyfit does it: with a constant, which is then dropped. Tables 4.2 to 4.5 to the curves of the rows of Table 4.3, both without noise.

Needs the palpate command (build/palpate, or $PALPATE)."""
import argparse
import functools
import glob
import json
import math
import os
import subprocess
import sys
import tempfile

from recordings import HERE, PALPATE

LUMPED = os.path.join(HERE, "lumped_n1.json")
LAWS = {3: [0.54, -2.34, 33.25, -124.03, 177.63], 5: [0.19, -1.0, 13.53, -50.59, 68.69]}  # Eq. 5.21, 5.22
LAW = ["c%d_N" % i for i in range(5)]


def rows(table):
    """The table's rows, a column's name to its number; empty fields left out."""
    with open(os.path.join(HERE, "table_%s.csv" % table.replace(".", "_"))) as f:
        lines = [line.strip().split(",") for line in f if not line.startswith("#")]
    return [{k: float(v) for k, v in zip(lines[0], line) if v} for line in lines[1:]]


def palpate(*words):
    out = subprocess.run([PALPATE, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if out.returncode not in (0, 3):  # 3: a loop that stopped short of its own criterion
        sys.exit(out.stderr)
    return json.loads(out.stdout) if "--json" in words else None


def write(path, law, **more):
    with open(path, "w") as f:
        json.dump({"palpate": {"model": 1}, "kind": "lumped", "arms": [], "formulation": "history",
                   "specimen": {"kind": "cylinder", "height_mm": 24.0, "radius_mm": 12.0},
                   "stiffness": {"kind": "polynomial", "coefficients_N": law}, **more}, f)


# ---- Chapter 4: fits of a lumped model ----

def polyfit(x, y, degree):
    """Coefficients of ascending powers and the norm of what is left, by least squares on Legendre polynomials of x from 0 to its end."""
    end, n = max(x), degree + 1
    powers = [[1.0], [-1.0, 2.0]]  # of u = x / end; each polynomial by its coefficients
    for k in range(1, degree):
        up, here, down = [0.0] + [2 * c for c in powers[k]], powers[k] + [0.0], powers[k - 1] + [0.0, 0.0]
        powers.append([((2 * k + 1) * (u - h) - k * d) / (k + 1) for u, h, d in zip(up, here, down)])
    values = [[sum(c * (v / end) ** i for i, c in enumerate(p)) for v in x] for p in powers[:n]]
    matrix = [[sum(a * b for a, b in zip(p, q)) for q in values] + [sum(a * b for a, b in zip(p, y))] for p in values]
    for i in range(n):  # Gauss; the matrix is nearly diagonal
        for k in range(i + 1, n):
            share = matrix[k][i] / matrix[i][i]
            matrix[k] = [a - share * b for a, b in zip(matrix[k], matrix[i])]
    solution = [0.0] * n
    for i in reversed(range(n)):
        solution[i] = (matrix[i][n] - sum(matrix[i][j] * solution[j] for j in range(i + 1, n))) / matrix[i][i]
    left = math.sqrt(sum((f - sum(s * v for s, v in zip(solution, row))) ** 2 for f, row in zip(y, zip(*values))))
    return [sum(solution[k] * powers[k][i] for k in range(i, n)) / end ** i for i in range(n)], left


def table_4_1(_):
    wanted = rows("4.1")
    with tempfile.TemporaryDirectory() as folder:
        model, run = os.path.join(folder, "model.json"), os.path.join(folder, "static.csv")
        write(model, [wanted[-1]["f%d_N" % i] for i in range(1, 6)])
        palpate("simulate", model, "--protocol", "static", "--depth-mm", 9.7, "--rate-mm-s", 0.1, "--sample-Hz", 1000, "--out", run)
        with open(run) as f:
            press = [list(map(float, line.split(","))) for line in f if line[0] in "0123456789"]
    strain, force = [r[1] / 24 for r in press], [r[2] for r in press]
    for row in wanted:
        c, norm = polyfit(strain, force, int(row["degree"]))
        ours = {"f%d_N" % i: c[i] for i in range(1, len(c))}
        yield "degree %d" % row["degree"], {**ours, "residual_N": math.hypot(norm, wanted[-1]["residual_N"])}, row


@functools.lru_cache(None)
def relaxation_fits(arms):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, os.path.join(HERE, "recordings.py"), folder, "--noise-N", "0", "--sample-Hz",
                        "50"], check=True, stdout=subprocess.DEVNULL)
        runs = glob.glob(os.path.join(folder, "*.csv"))
        return palpate("characterize", *runs, "--arms", arms, "--method", "grid", "--json")


def each_depth(table, arms):
    fits = {fit["depth_mm"]: fit["estimates"] for fit in relaxation_fits(arms)["per_depth"]}
    for row in rows(table):
        found = {e["name"].split(" ")[0].replace("_", ""): e["value"] for e in fits[row["depth_mm"]]}
        names = [k for k in row if k not in ("depth_mm", "strain")]
        yield "%.1f mm" % row["depth_mm"], {k: found[k.split("_")[0]] for k in names}, row


def shared(table, arms):
    ours = {}
    for j, arm in enumerate(relaxation_fits(arms)["shared"]["arms"], 1):
        ours.update({"K%d_N" % j: arm["stiffness_N"], "b%d_Ns" % j: arm["viscosity_Ns"]})
    yield "shared", ours, rows(table)[0]


# ---- Chapter 5: loops of a network ----

def table_5_1(_):
    fit = palpate("calibrate", LUMPED, "--nodes", 3, "--scaling", "none", "--stage", "static",
                  "--method", "fixed_point", "--json")
    for i, (row, it) in enumerate(zip(rows("5.1"), fit["iterations"]), 1):
        ours = {"optimum_" + k: c for k, c in zip(LAW, it["coefficients_N"])}
        yield "iteration %d" % i, {**ours, "residual_N": it["residual"]}, row


@functools.lru_cache(None)
def three_phases(formulation, dwell, depth_mm=6.0, nodes=3, arm=(1.296299, 17.873062), law=None):
    with tempfile.TemporaryDirectory() as folder:
        start = os.path.join(folder, "start.json")
        write(start, law or LAWS[nodes], kind="network", arms=[{"stiffness_N": arm[0], "viscosity_Ns": arm[1]}],
              mesh={"kind": "lattice", "nodes": [nodes] * 3, "size_mm": [24.0] * 3})
        return palpate("calibrate", LUMPED, "--stage", "relaxation", "--method", "three_phase", "--formulation",
                       formulation, "--dwell", dwell, "--start", start, "--depth-mm", depth_mm, "--dt-ms", 1,
                       "--json")


def numbers(it):
    """Of an iteration, by the names of the tables' columns."""
    law = it.get("law", {}).get("coefficients_N", [])
    return {"K1_N": it["stiffness_N"], "b1_Ns": it["viscosity_Ns"], **dict(zip(LAW, law)),
            **{k: it[k] for k in it if k.endswith("_percent")}}


def one_phase(table, phase, o):
    """The phase's iterations in the first round of all three."""
    found = three_phases(o.formulation, o.dwell)["iterations"]
    last = [it["phase"] for it in found].index(3) if phase < 3 else len(found)
    found = [it for it in found[:last] if it["phase"] == phase]
    for i, (row, it) in enumerate(zip(rows(table), found), 1):
        yield "iteration %d" % i, {k: v for k, v in numbers(it).items() if k in row}, row


def result(o, row, *how):
    fit = three_phases(o.formulation, o.dwell, *how)
    errors = numbers(fit["iterations"][-1])
    arm = fit["arms"][0]
    ours = {**errors, "K1_N": arm["stiffness_N"], "b1_Ns": arm["viscosity_Ns"], **dict(zip(LAW, fit["coefficients_N"]))}
    return {k: v for k, v in ours.items() if k in row}


def table_5_5(o):
    row = rows("5.5")[0]
    yield "result", result(o, row), row


def table_5_6(o):
    for i, row in enumerate(rows("5.6"), 1):
        arm = row["initial_K1_N"], row["initial_b1_Ns"]
        yield "start %d" % i, result(o, row, 6.0, 3, arm, tuple(row["initial_" + k] for k in LAW)), row


def by_depth(table, nodes, o):
    for row in rows(table):
        if not o.depth_mm or row["depth_mm"] in map(float, o.depth_mm.split(",")):
            yield "%.1f mm" % row["depth_mm"], result(o, row, row["depth_mm"], nodes), row


def peaks(table, nodes):
    """The peak force of the printed coefficients themselves, beside that of Eq. 5.25, which they are to meet within 1 %."""
    with open(LUMPED) as f:
        lumped = json.load(f)
    law, arm = lumped["stiffness"]["coefficients_N"], lumped["arms"][0]
    for row in rows(table):
        strain, tau = row["depth_mm"] / 24, arm["viscosity_Ns"] / arm["stiffness_N"]
        wanted = sum(c * strain ** (i + 1) for i, c in enumerate(law)) + strain * arm["viscosity_Ns"] * (1 - math.exp(-1 / tau))
        with tempfile.TemporaryDirectory() as folder:
            model = os.path.join(folder, "network.json")
            write(model, [row[c] for c in LAW], kind="network", formulation="sedef2008",
                  arms=[{"stiffness_N": row["K1_N"], "viscosity_Ns": row["b1_Ns"]}],
                  mesh={"kind": "lattice", "nodes": [nodes] * 3, "size_mm": [24.0] * 3})
            peak = palpate("simulate", model, "--protocol", "ramp_hold", "--depth-mm", row["depth_mm"], "--ramp-s", 1, "--hold-s",
                           0.001, "--dt-ms", 1, "--json")["peak_force_N"]
        yield "%.1f mm" % row["depth_mm"], {"peak_N": peak}, {"peak_N": wanted}


TABLES = {
    "4.1": table_4_1,
    "4.2": lambda o: each_depth("4.2", 1),
    "4.3": lambda o: each_depth("4.3", 2),
    "4.4": lambda o: shared("4.4", 1),
    "4.5": lambda o: shared("4.5", 2),
    "5.1": table_5_1,
    "5.2": lambda o: one_phase("5.2", 1, o),
    "5.3": lambda o: one_phase("5.3", 2, o),
    "5.4": lambda o: one_phase("5.4", 3, o),
    "5.5": table_5_5,
    "5.6": table_5_6,
    "5.7": lambda o: by_depth("5.7", 3, o),
    "5.8": lambda o: by_depth("5.8", 5, o),
    "5.7-peaks": lambda _: peaks("5.7", 3),
    "5.8-peaks": lambda _: peaks("5.8", 5),
}


# ---- figures ----

def figure(title, x_label, series):
    """As doc/schema/figure.json has it; series: (name, style, colour, points)."""
    return {"name": "table", "title": title, "panels": [{"x_label": x_label, "y_label": title, "x_log": False, "y_log": False, "series": [
        {"title": name, "style": style, "colour": colour, "x": [x for x, _ in points], "y": [y for _, y in points]} for name, style, colour, points in series]}]}


def law_of(row):
    return [(e / 100, sum(row[c] * (e / 100) ** i for i, c in enumerate(LAW))) for e in range(41)]


def draw(table, found, folder):
    """found: (ours, row) at each depth."""
    names = [k for k in found[0][0] if k not in LAW and not k.endswith("_percent")]
    figures = []
    for title, value in [*((name.replace("_", " (").replace("Ns", "N s") + ")", lambda row, k=name: row[k]) for name in names),
                         ("b1 / K1 (s)", lambda row: row["b1_Ns"] / row["K1_N"])]:
        figures.append(figure(title, "depth (mm)", [
            ("palpate", "line", 0, [(row["depth_mm"], value(ours)) for ours, row in found]),
            ("Sedef 2008", "points", 1, [(row["depth_mm"], value(row)) for _, row in found])]))
    if LAW[0] in found[0][0]:
        figures.append(figure("K of an element (N)", "strain", [curve for k, (ours, row) in enumerate((found[0], found[-1])) for curve in (
            ("palpate, %g mm" % row["depth_mm"], "line", k, law_of(ours)), ("Sedef 2008", "points", k, law_of(row)[::2]))]))
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "table_%s.json" % table.replace(".", "_")), "w") as to:
        json.dump(figures, to)


def compare(table, o):
    worst, n, found = {}, 0, []
    print("Table %s: what, column, ours, Sedef 2008, deviation" % table)
    for label, ours, row in TABLES[table](o):
        n += 1
        found.append((ours, row))
        for name, value in ours.items():
            points = name.endswith("_percent")
            off = value - row[name] if points else 100 * (value / row[name] - 1)
            print("%-14s %-30s %11.5g %11.5g %+9.2f %s" % (label, name, value, row[name], off, "points" if points else "%"),
                  flush=True)
            worst[name] = max(worst.get(name, 0), abs(off))
    for name, off in worst.items():
        print("worst %s %s %.2f of %d" % (table, name, off, n))
    print(flush=True)
    if o.plot and found and "depth_mm" in found[0][1]:
        draw(table, found, o.plot)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("tables", nargs="*", metavar="TABLE", help="4.1 to 4.5, 5.1 to 5.8, 5.7-peaks, 5.8-peaks (default: all)")
    p.add_argument("--formulation", default="sedef2008", choices=["sedef2008", "history"])
    p.add_argument("--dwell", default="frozen", choices=["frozen", "equilibrium"])
    p.add_argument("--depth-mm", default="", help="of Tables 5.7 and 5.8, only these depths")
    p.add_argument("--plot", metavar="DIR", help="figures of the tables over depths")
    o = p.parse_args()
    for table in o.tables or TABLES:
        if table not in TABLES:
            p.error("there is no Table %s here" % table)
        compare(table, o)


main()
