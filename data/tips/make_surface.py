#!/usr/bin/env python3
"""make_surface.py: how the top of a cube of 24 mm, bonded to its floor, moves around a sphere in its middle, by CalculiX: surface.csv.
A row is a node of the top on the line through the tip's axis; x is its distance from the axis at rest, down and out its
displacement. Needs ccx; a quarter of an hour."""
import os

import ccx_block

HEIGHT = 24.0
FILE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "surface.csv")


def main():
    rows = []
    for radius in (3, 5, 10):
        for poisson in (0.25, 0.45, 0.49):
            surface, depths = [], (0.5, 1) if radius == 3 else (0.5, 1, 2)
            ccx_block.press(radius / HEIGHT, poisson, depths[-1] / HEIGHT, round(2 * depths[-1]), 3, surface=surface)
            for depth in depths:
                rows += [(radius, poisson, depth, HEIGHT * x, -HEIGHT * y, HEIGHT * out) for d, x, out, y, _ in sorted(surface)
                         if abs(HEIGHT * d - depth) < 1e-3]
    with open(FILE, "w") as f:
        f.write("radius_mm,poisson,depth_mm,x_mm,down_mm,out_mm\n")
        f.writelines("%g,%g,%g,%.4f,%.4f,%.4f\n" % row for row in rows)


if __name__ == "__main__":
    main()
