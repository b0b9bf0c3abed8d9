#!/usr/bin/env python3
"""make_palpation.py: a map of presses of a cube of 24 mm with a hidden ball, bonded to its floor: palpation.csv. Rows that are there are not
run again.

A smooth sphere of 5 mm is pressed 1.2 mm into the top at 16 places. The elements are linear, 1.5 mm long and all alike, neo-Hookean, Poisson's
ratio 0.3; an element belongs to the ball if its middle does. Forces are over G h^2, at half and at all of the depth."""
import csv
import math
import os
import sys
import tempfile

import ccx_block
from ccx_tip import gap, nset

HERE = os.path.dirname(os.path.abspath(__file__))
FILE = os.path.join(HERE, "palpation.csv")
HEIGHT, CELLS, RADIUS, DEPTH, NU = 24.0, 16, 5.0, 1.2, 0.3
PLACES = (5.0, 9.5, 14.5, 19.0)
# name: middle in mm from the corner, radius in mm, factor of stiffness
BALLS = {"none": None, "near": ((15.0, 19.0, 9.0), 3.5, 20.0)}


def disc(f, radius, edge, place, node0, element0, m):
    """A disc of thin stiff bricks behind the tip's surface over a place of the top, all its nodes moved."""
    f.write("*NODE,NSET=TIP\n")
    number = lambda i, j, k: node0 + 1 + 2 * (i * (2 * m + 1) + j) + k
    for i in range(2 * m + 1):
        for j in range(2 * m + 1):
            u, v = i / m - 1, j / m - 1
            x, z = edge * u * math.sqrt(1 - v * v / 2), edge * v * math.sqrt(1 - u * u / 2)  # a square onto a disc
            for k in range(2):
                f.write("%d,%.12g,%.12g,%.12g\n" % (number(i, j, k), place[0] + x, 1 + gap("sphere", radius, math.hypot(x, z)) + 0.1 * k, place[1] + z))
    f.write("*ELEMENT,TYPE=C3D8,ELSET=RIGID\n")
    for i in range(2 * m):
        for j in range(2 * m):
            lower = [number(i, j, 0), number(i, j + 1, 0), number(i + 1, j + 1, 0), number(i + 1, j, 0)]
            f.write("%d,%s\n" % (element0 + 1 + i * 2 * m + j, ",".join(map(str, lower + [x + 1 for x in lower]))))
    f.write("*MATERIAL,NAME=STIFF\n*ELASTIC\n1000,0.3\n*SOLID SECTION,ELSET=RIGID,MATERIAL=STIFF\n*SURFACE,NAME=STIP,TYPE=ELEMENT\nRIGID,S1\n")


def press(ball, place, steps):
    """[(depth, force)] over the height and G h^2."""
    radius, depth = RADIUS / HEIGHT, DEPTH / HEIGHT
    at = [p / HEIGHT for p in place]
    edge = 1.5 * math.sqrt(radius * depth)
    points = [i / CELLS for i in range(CELLS + 1)]
    with tempfile.TemporaryDirectory() as folder:
        name = os.path.join(folder, "map")
        with open(name + ".inp", "w") as f:
            number, cell = ccx_block.bricks(f, points, points, points, True)
            nset(f, "FLOOR", [q for p, q in number.items() if p[1] == 0])
            middles = {e: [HEIGHT * (c + 0.5) / CELLS for c in p] for p, e in cell.items()}
            inside = lambda e: ball and math.dist(middles[e], ball[0]) <= ball[1]
            for n, factor in ((0, 1), (1, ball[2] if ball else 1)):
                elements = [e for e in cell.values() if bool(inside(e)) == bool(n)]
                if elements:
                    f.write("*ELSET,ELSET=PART%d\n%s\n" % (n, ",\n".join(map(str, elements))))
                    f.write("*MATERIAL,NAME=SOLID%d\n*HYPERELASTIC,NEO HOOKE\n%.12g,%.12g\n" % (n, 0.5 * factor, 3 * (1 - 2 * NU) / (1 + NU) / factor))
                    f.write("*SOLID SECTION,ELSET=PART%d,MATERIAL=SOLID%d\n" % (n, n))
            disc(f, radius, edge, at, len(number), len(cell), 16)
            f.write("*SURFACE,NAME=STOP,TYPE=ELEMENT\n")
            for (i, j, k), e in cell.items():
                if j == CELLS - 1 and math.hypot((i + 0.5) / CELLS - at[0], (k + 0.5) / CELLS - at[1]) < edge:
                    f.write("%d,S2\n" % e)
            f.write("*SURFACE INTERACTION,NAME=TOUCH\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n%g,1e-4\n" % (100.0 * CELLS))
            f.write("*CONTACT PAIR,INTERACTION=TOUCH,TYPE=SURFACE TO SURFACE\nSTOP,STIP\n*BOUNDARY\nFLOOR,1,3\nTIP,1,1\nTIP,3,3\n")
            f.write("*STEP,NLGEOM,INC=200\n*STATIC\n%g,1,1e-4,%g\n*BOUNDARY\nTIP,2,2,%.12g\n" % (1 / steps, 1 / steps, -depth))
            f.write("*NODE PRINT,NSET=FLOOR,TOTALS=ONLY\nRF\n*END STEP\n")
        found, told = ccx_block.solve(name, folder, 1800)
        curve = [(t, v[1]) for t, v in found]
        if not curve or curve[-1][0] < 0.999:
            raise RuntimeError("ccx stopped at %s: %s" % (curve[-1:], told))
        return curve


def main():
    new = not os.path.exists(FILE)
    done = set() if new else {(r["ball"], float(r["x_mm"]), float(r["z_mm"])) for r in csv.DictReader(open(FILE))}
    with open(FILE, "a") as out:
        if new:
            out.write("ball,x_mm,z_mm,half,whole\n")
        for name in sys.argv[1:] or BALLS:
            for x in PLACES:
                for z in PLACES:
                    if (name, x, z) in done:
                        continue
                    for steps in (2, 4, 8):
                        try:
                            curve = press(BALLS[name], (x, z), steps)
                        except RuntimeError as error:
                            print(name, x, z, str(error).split("\n")[0], file=sys.stderr)
                            continue
                        half = min(curve, key=lambda c: abs(c[0] - 0.5))
                        out.write("%s,%g,%g,%.6g,%.6g\n" % (name, x, z, half[1], curve[-1][1]))
                        out.flush()
                        break


if __name__ == "__main__":
    main()
