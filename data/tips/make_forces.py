#!/usr/bin/env python3
"""make_forces.py: runs CalculiX for the tables of this folder: forces.csv. Rows that are there are not run again.

    make_forces.py [KIND ...]       flat flat_stick plate_stick wide sphere cone; default all

Lengths in heights of the layer, forces over G h^2. A force at depth 0.001 beside each flat tip is the mesh's own small strain, and
forces of a scale of 0.01 beside a sphere or cone (kinds sphere_small and cone_small): the tip's profile and depth were scaled down."""
import csv
import os
import sys

from ccx_tip import at, run

HERE = os.path.dirname(os.path.abspath(__file__))
FILE = os.path.join(HERE, "forces.csv")
NU = [0.3, 0.4, 0.45, 0.49, 0.4999]
RATIO = [0.2, 0.5, 1.0, 2.0]
CURVED_NU = [0.3, 0.45, 0.49]
SPHERE = [0.3, 0.7, 1.6, 4.0]
CONE = [70, 80]


def sphere_reach(ratio):
    """Deepest of a sphere."""
    return 0.16 * ratio / (ratio + 0.1)


def jobs():
    for nu in NU:
        for ratio in RATIO:
            yield "flat", "flat", ratio, nu, min(0.2, 0.4 * ratio), 4, dict(fine=6)
            for stick in (False, True):
                yield "flat_stick" if stick else "flat", "flat", ratio, nu, 0.001, 1, dict(stick=stick, fine=6)
        for ratio in [0.2, 0.5, 1.0, 2.0, 4.0]:
            yield "plate_stick", "plate", ratio, nu, 0.001, 1, dict(stick=True, fine=8)
        for ratio in RATIO:
            yield "wide", "flat", ratio, nu, 0.001, 1, dict(fine=6)
            for around in [1.0, 1.25, 1.5, 2.0, 3.0]:
                yield "wide", "flat", ratio, nu, 0.001, 1, dict(fine=6, wide=around * ratio)
    for nu in CURVED_NU:
        for tip, ratios in (("sphere", SPHERE), ("cone", CONE)):
            for ratio in ratios:
                depth = sphere_reach(ratio) if tip == "sphere" else 0.15
                for scale in (1.0, 0.01):
                    yield tip if scale == 1 else tip + "_small", tip, ratio, nu, depth, 4, dict(fine=6, limit=60, scale=scale)


def main():
    wanted = sys.argv[1:]
    done = set()
    new = not os.path.exists(FILE)
    if not new:
        done = {tuple(r[:4]) + (r[6],) for r in csv.reader(open(FILE))}
    out = open(FILE, "a")
    if new:
        out.write("kind,ratio,poisson,wide,depth,force,run_depth\n")
    for kind, tip, ratio, nu, depth, steps, options in jobs():
        key = (kind, "%g" % ratio, "%g" % nu, "%g" % (options.get("wide") or 0), "%g" % depth)
        if (wanted and kind.replace("_small", "") not in wanted) or key in done:
            continue
        for more in (1, 2):
            try:
                curve = run(tip, ratio, nu, depth, steps * more, **options)
                break
            except RuntimeError as error:
                curve = []
                print(key, str(error)[:60].replace("\n", " "), file=sys.stderr)
        for part in range(1, steps + 1) if curve else []:
            d = depth * part / steps
            out.write(",".join(key[:4]) + ",%.6g,%.8g,%s\n" % (d, at(curve, d), key[4]))
        out.flush()


main()
