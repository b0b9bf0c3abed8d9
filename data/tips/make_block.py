#!/usr/bin/env python3
"""make_block.py: forces of tips on a cube of 24 mm that is bonded to its floor: block.csv. Rows that are there are not run again.

    make_block.py [cylinder cylinder_small cube linear face]       default all

shape cylinder: as high and of the same section, axisymmetric, each depth on a mesh of its own with 12 elements under the contact, some with 24;
cylinder_small: tip and depth scaled down by a hundred, as in make_forces.py, that is small strain; cube: one on a quarter of the cube itself,
4 elements; linear: of linear elements with 5, 7 and 11 nodes a side ("fine"), a node under the tip; face: the cube between bonded plates.
Force over G h^2 (face: over G h and the plate's motion), h = 24 mm; face has the value "press", "shear" or "bulge" in place of a tip."""
import csv
import math
import os
import sys

import ccx_block
import ccx_tip

HERE = os.path.dirname(os.path.abspath(__file__))
FILE = os.path.join(HERE, "block.csv")
HEIGHT = 24.0
NU = [0.25, 0.45, 0.3, 0.49]
RADIUS = [3, 5, 10]
DEPTH = [0.5, 1, 2]
WIDE = math.sqrt(1 / math.pi)


def curve(shape, tip, radius, nu, depth, fine):
    """[(what, force)], of the first settings of the steps that CalculiX follows to the end."""
    for steps in (4, 8, 16):
        try:
            if shape == "cube":
                return [(tip, ccx_block.press(radius / HEIGHT, nu, depth / HEIGHT, steps // 2, fine)[-1][1])]
            if shape == "linear":
                return [(tip, ccx_block.press(radius / HEIGHT, nu, depth / HEIGHT, steps // 2, nodes=fine)[-1][1])]
            scale = 0.01 if shape == "cylinder_small" else 1.0
            return [(tip, ccx_tip.run(tip, radius / HEIGHT, nu, depth / HEIGHT, steps, wide=WIDE, fine=fine, scale=scale)[-1][1])]
        except RuntimeError as error:
            print(shape, tip, radius, nu, depth, fine, str(error).split("\n")[0], file=sys.stderr)
    return []


def jobs():
    for nu in NU:
        for fine in (4, 8, 12) if nu > 0.4 else (4, 8):
            yield "face", "plate", 0, nu, 0, fine
    for fine in (12, 24):
        for nu in NU:
            for radius in RADIUS:
                for depth in DEPTH if fine == 12 else (1,):
                    yield "cylinder", "sphere", radius, nu, depth, fine
                if fine == 12 and radius < 10:
                    yield "cylinder_small", "sphere", radius, nu, 1, fine
            yield "cylinder", "flat", 5, nu, 1, fine
    for radius in RADIUS:
        for nodes in (5, 7, 11):
            yield "linear", "sphere", radius, 0.25, 1, nodes
    yield "cube", "sphere", 5, 0.25, 1, 4


def main():
    wanted = sys.argv[1:]
    new = not os.path.exists(FILE)
    done = set() if new else {(r["shape"], r["radius_mm"], r["poisson"], r["depth_mm"], r["fine"], r["tip"] == "flat") for r in csv.DictReader(open(FILE))}
    with open(FILE, "a") as out:
        if new:
            out.write("shape,tip,radius_mm,poisson,depth_mm,fine,force\n")
        for shape, tip, radius, nu, depth, fine in jobs():
            key = (shape, "%g" % radius, "%g" % nu, "%g" % depth, "%g" % fine, tip == "flat")
            if (wanted and shape not in wanted) or key in done:
                continue
            found = zip(("press", "shear", "bulge"), ccx_block.face(nu, fine)) if shape == "face" else curve(shape, tip, radius, nu, depth, fine)
            for what, force in found:
                out.write("%s,%s,%s,%.8g\n" % (shape, what, ",".join(key[1:5]), force))
            out.flush()


main()
