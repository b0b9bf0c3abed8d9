#!/usr/bin/env python3
"""make_regions.py: forces on a cube of 24 mm with stiff or soft parts, bonded to its floor: regions.csv. Rows that are there are not run again.

A part is a box of another stiffness and the same Poisson's ratio. press, shear: the cube between bonded plates, force over G h and the
plate's motion, 6 elements a side; sphere: of 5 mm, 1 mm deep into the middle of the top, force over G h^2, 4 elements under the contact."""
import csv
import os
import sys

import ccx_block

HERE = os.path.dirname(os.path.abspath(__file__))
FILE = os.path.join(HERE, "regions.csv")
HEIGHT = 24.0
# name: box in mm, from the corner; factor
PARTS = {
    "none": (None, 1),
    "stiff_upper_half": (((0, 24), (12, 24), (0, 24)), 5),
    "soft_upper_half": (((0, 24), (12, 24), (0, 24)), 0.2),
    "stiff_skin": (((0, 24), (20, 24), (0, 24)), 5),
    "stiff_inclusion": (((8, 16), (8, 16), (8, 16)), 10),
    "soft_inclusion": (((8, 16), (8, 16), (8, 16)), 0.1),
    "stiff_nodule": (((8, 16), (12, 20), (8, 16)), 10),
    "capsule": None,
}


def capsule(nu):
    """Four sides of 0.25 mm, ten times as stiff: nine times that are a membrane on the block."""
    t = 0.25 / HEIGHT
    sides = [((0, t), (0, 1), (0, 1)), ((1 - t, 1), (0, 1), (0, 1)), ((0, 1), (0, 1), (0, t)), ((0, 1), (0, 1), (1 - t, 1))]
    return zip(("press", "shear"), ccx_block.face(nu, 6, regions=[(s, 10) for s in sides], skin=t))


def rows(part, nu):
    if part == "capsule":
        yield from capsule(nu)
        return
    box, factor = PARTS[part]
    whole = [([[x / HEIGHT for x in limits] for limits in box], factor)] if box else []
    pressed, sheared, _ = ccx_block.face(nu, 6, regions=whole)
    yield "press", pressed
    yield "shear", sheared
    axis = [([[x - (0.5 if k != 1 else 0) for x in limits] for k, limits in enumerate(b)], f) for b, f in whole]
    for steps in (2, 4, 8):
        try:
            yield "sphere", ccx_block.press(5 / HEIGHT, nu, 1 / HEIGHT, steps, 4, regions=axis)[-1][1]
            return
        except RuntimeError as error:
            print(part, nu, str(error).split("\n")[0], file=sys.stderr)


def main():
    new = not os.path.exists(FILE)
    done = set() if new else {(r["part"], r["poisson"]) for r in csv.DictReader(open(FILE))}
    with open(FILE, "a") as out:
        if new:
            out.write("part,poisson,load,force\n")
        for nu in (0.25, 0.45):
            for part in PARTS:
                if (part, "%g" % nu) in done:
                    continue
                for load, force in rows(part, nu):
                    out.write("%s,%g,%s,%.8g\n" % (part, nu, load, force))
                out.flush()


main()
