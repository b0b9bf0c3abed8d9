#!/usr/bin/env python3
"""make_layers.py: maps of presses of a cube of 24 mm with a stiff or soft layer at its top and without, bonded to its floor: layers.csv. Rows
that are there are not run again.

    make_layers.py [LAYER]...

A smooth sphere of 6 mm is pressed 2 mm into the top, neo-Hookean, Poisson's ratio 0.3. The five places are symmetric,
so two runs give them. Under the contact at 2 mm are 3 quadratic elements. Forces are over G h^2 of the tissue below the layer, at half, three
quarters and all of each depth."""
import csv
import os
import sys

import ccx_block

HERE = os.path.dirname(os.path.abspath(__file__))
FILE = os.path.join(HERE, "layers.csv")
HEIGHT, RADIUS, NU, FINE = 24.0, 6.0, 0.3, 3
DEPTHS = (1.0, 2.0)
# name: thickness in mm, factor of stiffness
LAYERS = {"no_layer": None, "stiff_layer": (6.0, 5.0), "soft_layer": (6.0, 0.2)}


def press(layer, x, z):
    """Forces by depth in mm, of the first number of steps that CalculiX follows to the end. x, z: from two edges, 12 being the middle."""
    at = [p / HEIGHT for p in (x, z)]
    while at and at[-1] == 0.5:
        at.pop()
    regions = [(((-1, 1), (1 - layer[0] / HEIGHT, 1), (-1, 1)), layer[1])] if layer else []
    for steps in (8, 16):
        try:
            curve = ccx_block.press(RADIUS / HEIGHT, NU, DEPTHS[-1] / HEIGHT, steps, FINE, at=at, regions=regions)
            return {round(d * HEIGHT, 6): force for d, force in curve}
        except RuntimeError as error:
            print(layer, x, z, str(error).split("\n")[0], file=sys.stderr)
    return None


def main():
    new = not os.path.exists(FILE)
    done = set() if new else {(r["layer"], float(r["x_mm"]), float(r["z_mm"])) for r in csv.DictReader(open(FILE))}
    mirror = lambda p: sorted({p, HEIGHT - p})
    with open(FILE, "a") as out:
        if new:
            out.write("layer,x_mm,z_mm,depth_mm,half,middle,whole\n")
        for name in sys.argv[1:] or LAYERS:
            for x, z in ((12.0, 12.0), (6.0, 12.0)):
                if (name, x, z) in done:
                    continue
                forces = press(LAYERS[name], x, z)
                for place in sorted({p for a in mirror(x) for b in mirror(z) for p in ((a, b), (b, a))}) if forces else ():
                    for depth in DEPTHS:
                        out.write("%s,%g,%g,%g,%.6g,%.6g,%.6g\n" % ((name, *place, depth) + tuple(forces[s * depth] for s in (0.5, 0.75, 1))))
                out.flush()


main()
