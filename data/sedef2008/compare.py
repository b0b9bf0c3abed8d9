#!/usr/bin/env python3
"""Prints the network tables of Sedef 2008 beside what palpate finds by the same procedure.

    data/sedef2008/compare.py 5.5|5.7|5.8 [--formulation history] [--depth-mm 2,6,9]

Needs the palpate command (build/palpate, or $PALPATE)."""
import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
PALPATE = os.environ.get("PALPATE", os.path.join(HERE, "..", "..", "build", "palpate"))
TABLES = {  # table: nodes a side, law the thesis starts from (Eq. 5.21, 5.22), ascending powers
    "5.5": (3, [0.54, -2.34, 33.25, -124.03, 177.63]),
    "5.7": (3, [0.54, -2.34, 33.25, -124.03, 177.63]),
    "5.8": (5, [0.19, -1.0, 13.53, -50.59, 68.69]),
}


def rows(table):
    with open(os.path.join(HERE, "table_%s.csv" % table.replace(".", "_"))) as f:
        return list(csv.DictReader(line for line in f if not line.startswith("#")))


def three_phase(nodes, law, depth, formulation):
    with tempfile.NamedTemporaryFile("w", suffix=".json") as start:
        json.dump({"palpate": {"model": 1}, "kind": "network",
                   "specimen": {"kind": "cylinder", "height_mm": 24.0, "radius_mm": 12.0},
                   "stiffness": {"kind": "polynomial", "coefficients_N": law}, "arms": [],
                   "mesh": {"kind": "lattice", "nodes": [nodes] * 3, "size_mm": [24.0] * 3},
                   "formulation": "history"}, start)
        start.flush()
        out = subprocess.run([PALPATE, "calibrate", os.path.join(HERE, "lumped_n1.json"), "--stage", "relaxation",
                              "--method", "three_phase", "--formulation", formulation, "--nodes", str(nodes),
                              "--depth-mm", str(depth), "--ramp-s", "1", "--hold-s", "60", "--dt-ms", "1",
                              "--start", start.name, "--json"], stdout=subprocess.PIPE, text=True)
    if out.returncode not in (0, 3):
        sys.exit(out.returncode)
    return json.loads(out.stdout)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("table", choices=sorted(TABLES))
    parser.add_argument("--formulation", default="sedef2008", choices=["sedef2008", "history"])
    parser.add_argument("--depth-mm", default="", help="only these depths")
    args = parser.parse_args()
    nodes, law = TABLES[args.table]
    wanted = [float(d) for d in args.depth_mm.split(",") if d]
    print("Table %s, %d nodes a side, formulation %s; ours | Sedef 2008" % (args.table, nodes, args.formulation))
    print("depth_mm      K1_N            b1_Ns           K(0.25)_N")
    first = last = None
    for row in rows(args.table):
        depth = float(row.get("depth_mm", 6))
        if wanted and depth not in wanted:
            continue
        result = three_phase(nodes, law, depth, args.formulation)
        arm, c = result["arms"][0], result["coefficients_N"]
        at = [sum(float(v) * 0.25 ** i for i, v in enumerate(k)) for k in (c, [row["c%d_N" % i] for i in range(5)])]
        print("%5.1f   %7.4f | %6.4f   %7.4f | %6.4f   %7.4f | %6.4f" % (
            depth, arm["stiffness_N"], float(row["K1_N"]), arm["viscosity_Ns"], float(row["b1_Ns"]), *at), flush=True)
        last = (arm["stiffness_N"], float(row["K1_N"]))
        first = first or last
    if first != last:
        print("K1 grows %.2f times | %.2f times" % (last[0] / first[0], last[1] / first[1]))


main()
