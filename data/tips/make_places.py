#!/usr/bin/env python3
"""make_places.py: forces of tips at many places of a cube of 24 mm that is bonded to its floor: places.csv. Rows that are there are not
run again.

    make_places.py [MINUTES]        stops before a run when so much time has passed

face top: x and z are distances from two edges of the top. face side: x is the height above the floor, z the distance from an edge. A tip
at 12 mm is in the middle, where the model is symmetric. A capsule lies along z, length between the centres of its ends; sphere: 0.
Each line of JOBS is one run, whose steps give the depths. fine: quadratic elements under the contact at the largest depth.
force and reference are over G h^2, h = 24 mm. reference: of a sphere, the force of the axisymmetric cylinder in block.csv, times the
ratio of two forces on meshes of the cube that are equally fine, there and in the middle. Of a capsule it is the force itself.
0: a row that shows the mesh's error only."""
import csv
import os
import sys
import time

import ccx_block

HERE = os.path.dirname(os.path.abspath(__file__))
FILE = os.path.join(HERE, "places.csv")
COLUMNS = "face,radius_mm,length_mm,x_mm,z_mm,poisson,depth_mm,fine,force,reference".split(",")
HEIGHT = 24.0
FINE = "12"  # of the rows of block.csv
# face, radius, length, x, z, Poisson's ratios, depths, fine
JOBS = [
    ("top", 5, 0, 12, 12, (0.45, 0.3), (0.5, 1, 2), 3),
    ("top", 5, 0, 7.5, 12, (0.45, 0.3), (0.5, 1, 2), 3),
    ("side", 5, 0, 12, 12, (0.45, 0.3), (0.5, 1, 2), 3),
    ("top", 3, 8, 12, 12, (0.45, 0.3), (0.5, 1), 3),
    ("top", 5, 0, 12, 12, (0.45,), (0.5, 1, 2), 2),
    ("top", 5, 0, 7.5, 12, (0.45,), (0.5, 1, 2), 2),
    ("top", 5, 0, 7.5, 7.5, (0.45,), (0.5, 1, 2), 2),
    ("top", 3, 8, 12, 12, (0.45,), (0.5, 1), 5),
    ("top", 3, 0, 12, 12, (0.45, 0.3), (0.5, 1), 3),
    ("top", 3, 0, 4.5, 12, (0.45, 0.3), (0.5, 1), 3),
    ("side", 5, 0, 16.5, 12, (0.45,), (0.5, 1, 2), 3),
    ("top", 3, 8, 12, 12, (0.49, 0.25), (0.5, 1), 3),
    ("top", 5, 0, 12, 12, (0.49, 0.25), (0.5, 1, 2), 3),
    ("top", 5, 0, 7.5, 12, (0.49, 0.25), (0.5, 1, 2), 3),
    ("side", 5, 0, 12, 12, (0.49, 0.25), (0.5, 1, 2), 3),
    ("side", 5, 0, 16.5, 12, (0.3,), (0.5, 1, 2), 3),
    ("side", 3, 0, 12, 12, (0.45,), (0.5, 1), 3),
]


def run(face, radius, length, x, z, nu, depths, fine):
    """Forces at these depths, of the first number of steps that CalculiX follows to the end."""
    at = [p / HEIGHT for p in (x, z)]
    while at and at[-1] == 0.5 and (len(at) == 2 or face == "top"):
        at.pop()
    for steps in (1, 2, 4):
        try:
            steps *= round(depths[-1] / depths[0])
            curve = ccx_block.press(radius / HEIGHT, nu, depths[-1] / HEIGHT, steps, fine, at=at, side=face == "side",
                                    length=length / HEIGHT, limit=360)
            return [next(force for d, force in curve if abs(d * HEIGHT - depth) < 1e-6) for depth in depths]
        except RuntimeError as error:
            print(face, radius, length, x, z, nu, fine, str(error).split("\n")[0], file=sys.stderr)
    return []


def reference(run, runs, block):
    """Of a run, 0: it is for the mesh's error only, or the middle of its mesh is not there yet."""
    place = lambda r: [r[name] for name in COLUMNS[:7]]
    load = lambda r: (r["radius_mm"], r["poisson"], r["depth_mm"])
    middle = lambda r: (r["face"], r["length_mm"], r["x_mm"], r["z_mm"]) == ("top", "0", "12", "12")
    if middle(run) or any(place(r) == place(run) and int(r["fine"]) > int(run["fine"]) for r in runs):
        return 0
    if run["length_mm"] != "0":
        return float(run["force"])
    for r in runs:
        if middle(r) and load(r) == load(run) and r["fine"] == run["fine"]:
            return float(run["force"]) / float(r["force"]) * block[load(run)]
    return 0


def add_references():
    """Rewrites the file: the spheres of block.csv, then every run, with the last column."""
    runs = [r for r in csv.DictReader(open(FILE)) if r["fine"] != FINE]
    block = [r for r in csv.DictReader(open(os.path.join(HERE, "block.csv")))
             if (r["shape"], r["tip"], r["fine"]) == ("cylinder", "sphere", FINE)]
    with open(FILE, "w") as out:
        table = csv.DictWriter(out, COLUMNS, extrasaction="ignore", lineterminator="\n")
        table.writeheader()
        for r in block:
            table.writerow(dict(r, face="top", length_mm=0, x_mm=12, z_mm=12, reference=r["force"]))
        by_load = {(r["radius_mm"], r["poisson"], r["depth_mm"]): float(r["force"]) for r in block}
        for r in runs:
            table.writerow(dict(r, reference="%.8g" % reference(r, runs, by_load)))


def main():
    end = time.time() + 60 * float(sys.argv[1]) if len(sys.argv) > 1 else float("inf")
    new = not os.path.exists(FILE)
    done = set() if new else {",".join(row[:6] + row[7:8]) for row in csv.reader(open(FILE))}
    with open(FILE, "a") as out:
        if new:
            out.write(",".join(COLUMNS) + "\n")
        for face, radius, length, x, z, ratios, depths, fine in JOBS:
            for nu in ratios:
                key = "%s,%g,%g,%g,%g,%g" % (face, radius, length, x, z, nu)
                if "%s,%d" % (key, fine) in done or time.time() > end:
                    continue
                for depth, force in zip(depths, run(face, radius, length, x, z, nu, depths, fine)):
                    out.write("%s,%g,%d,%.8g,0\n" % (key, depth, fine, force))
                out.flush()
    add_references()


main()
