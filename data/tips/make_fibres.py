#!/usr/bin/env python3
"""make_fibres.py: a cube between bonded plates with fibres at an angle to the load, by CalculiX: fibres.csv. Small strain, E = 1 without fibres.

The tissue is isotropic with Poisson's ratio nu; fibres of modulus 5 E are added: C = C_isotropic + 5 a a a a, an anisotropic elastic law
(*ELASTIC,TYPE=ANISO). The angle is that to the load, in the plane of x and y. Force of the upper plate over its strain and a side's square."""
import math
import os
import tempfile

import ccx_block
from ccx_tip import nset

HERE = os.path.dirname(os.path.abspath(__file__))
CELLS, MODULUS = 12, 5.0
PAIRS = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]  # CalculiX: 11 22 33 12 13 23


def stiffness(nu, angle, modulus):
    """The 21 constants in CalculiX' order: 1111, 1122, 2222, 1133, 2233, 3333, 1112 ... by columns of the upper triangle."""
    lame, shear = nu / ((1 + nu) * (1 - 2 * nu)), 0.5 / (1 + nu)
    a = (math.sin(angle), math.cos(angle), 0.0)
    same = lambda i, j: 1.0 if i == j else 0.0

    def c(i, j, k, l):
        return lame * same(i, j) * same(k, l) + shear * (same(i, k) * same(j, l) + same(i, l) * same(j, k)) + modulus * a[i] * a[j] * a[k] * a[l]

    return [c(*PAIRS[row], *PAIRS[column]) for column in range(6) for row in range(column + 1)]


def press(nu, angle, modulus):
    points = [i / CELLS for i in range(CELLS + 1)]
    with tempfile.TemporaryDirectory() as folder:
        name = os.path.join(folder, "fibres")
        with open(name + ".inp", "w") as f:
            number, _ = ccx_block.bricks(f, points, points, points)
            nset(f, "FLOOR", [q for p, q in number.items() if p[1] == 0])
            nset(f, "TOP", [q for p, q in number.items() if p[1] == 2 * CELLS])
            values = ["%.12g" % v for v in stiffness(nu, angle, modulus)]
            f.write("*MATERIAL,NAME=SOLID\n*ELASTIC,TYPE=ANISO\n%s\n%s\n%s\n" % tuple(",".join(values[k : k + 8]) for k in (0, 8, 16)))
            f.write("*SOLID SECTION,ELSET=BLOCK,MATERIAL=SOLID\n*BOUNDARY\nFLOOR,1,3\nTOP,1,1\nTOP,3,3\n*STEP\n*STATIC\n*BOUNDARY\nTOP,2,2,-1e-3\n")
            f.write("*NODE PRINT,NSET=FLOOR,TOTALS=ONLY\nRF\n*END STEP\n")
        found, told = ccx_block.solve(name, folder, 600)
        if not found:
            raise RuntimeError("ccx: %s" % told)
        return 1e3 * found[-1][1][1]


def main():
    with open(os.path.join(HERE, "fibres.csv"), "w") as out:
        out.write("poisson_ratio,angle_deg,modulus,force\n")
        for nu in (0.25, 0.45):
            for angle, modulus in ((0, 0.0), (0, MODULUS), (30, MODULUS), (45, MODULUS), (90, MODULUS)):
                out.write("%g,%g,%g,%.5g\n" % (nu, angle, modulus, press(nu, math.radians(angle), modulus)))
                out.flush()


main()
