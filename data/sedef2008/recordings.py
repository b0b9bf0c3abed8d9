#!/usr/bin/env python3
"""Makes recordings whose answer is known from the tables of Sedef 2008.

    data/sedef2008/recordings.py DIR            12 ramp-and-hold runs of Table 4.3
    data/sedef2008/recordings.py DIR --static   a static run at 0.1 mm/s instead
    data/sedef2008/recordings.py DIR --all      both

ramp_hold_1.5mm.csv ... ramp_hold_7.0mm.csv: 1 s of free air, 1 s ramp, 200 s hold, 1 kHz, 4 mN of white noise;
each depth has the K_inf (constant) and the two arms of its row. static_9.7mm.csv: Eq. 4.2 to 9.7 mm with the arms
of Table 4.5 active (lumped_n2.json), the same air, rate and noise. A seed N gives run i the noise of seed N + i.

Needs the palpate command (build/palpate, or $PALPATE)."""
import argparse
import concurrent.futures
import csv
import json
import os
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
PALPATE = os.path.abspath(os.environ.get("PALPATE", os.path.join(HERE, "..", "..", "build", "palpate")))


def rows(table):
    with open(os.path.join(HERE, table)) as f:
        return [{k: float(v) for k, v in row.items()}
                for row in csv.DictReader(line for line in f if not line.startswith("#"))]


def model(row):
    """One row of Table 4.3 as a lumped model."""
    return {"palpate": {"model": 1}, "kind": "lumped",
            "specimen": {"kind": "cylinder", "height_mm": 24.0, "radius_mm": 12.0},
            "stiffness": {"kind": "polynomial", "coefficients_N": [row["Kinf_N"]]},
            "arms": [{"stiffness_N": row["K%d_N" % j], "viscosity_Ns": row["b%d_Ns" % j]} for j in (1, 2)],
            "formulation": "history"}


def simulate(folder, name, path, seed, settings, *protocol):
    """Runs in the model's folder, so that the recording names the model without a path."""
    subprocess.run([PALPATE, "simulate", name, *protocol, "--sample-Hz", str(settings.sample_Hz),
                    "--air-s", str(settings.air_s), "--noise-N", str(settings.noise_N),
                    *(["--seed", str(seed)] if settings.noise_N > 0 else []),
                    "--out", path], cwd=folder, check=True)
    return path


def jobs(settings, folder):
    if not settings.static or settings.all:
        for i, row in enumerate(rows("table_4_3.csv")):
            name = "table_4_3_%.1fmm.json" % row["depth_mm"]
            with open(os.path.join(folder, name), "w") as f:
                json.dump(model(row), f)
            yield (folder, name, os.path.join(settings.dir, "ramp_hold_%.1fmm.csv" % row["depth_mm"]),
                   settings.seed + i, settings, "--protocol", "ramp_hold", "--depth-mm", str(row["depth_mm"]),
                   "--ramp-s", "1", "--hold-s", str(settings.hold_s))
    if settings.static or settings.all:
        yield (HERE, "lumped_n2.json", os.path.join(settings.dir, "static_9.7mm.csv"), settings.seed + 12, settings,
               "--protocol", "static", "--depth-mm", "9.7", "--rate-mm-s", "0.1")


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("dir", help="folder for the recordings; made if need be")
    p.add_argument("--static", action="store_true", help="the static run only")
    p.add_argument("--all", action="store_true", help="the static run too")
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--noise-N", type=float, default=0.004)
    p.add_argument("--sample-Hz", type=float, default=1000)
    p.add_argument("--hold-s", type=float, default=200)
    p.add_argument("--air-s", type=float, default=1)
    settings = p.parse_args()
    settings.dir = os.path.abspath(settings.dir)
    os.makedirs(settings.dir, exist_ok=True)
    try:
        with tempfile.TemporaryDirectory() as folder, \
                concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            for path in pool.map(lambda job: simulate(*job), jobs(settings, folder)):
                print(path)
    except subprocess.CalledProcessError as failed:
        sys.exit(failed.returncode)
    except OSError as failed:
        sys.exit("%s: %s (build palpate first, or set PALPATE)" % (PALPATE, failed.strerror))


if __name__ == "__main__":
    main()
