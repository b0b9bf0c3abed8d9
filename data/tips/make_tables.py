#!/usr/bin/env python3
"""make_tables.py: forces.csv as the factors of lib/material/indentation_tables.h.

Each factor is a force over that of the same mesh, so that most of what the mesh misses cancels:
large: at a depth over that of a depth of 0.001, times the depths' ratio, of a sphere or cone over that of a scale of 0.01; wide: of a specimen over that of a wide layer;
stick: of a punch that sticks over one that slides; glue: of a cylinder glued to both plates over one that slides."""
import csv
import math
import os

HERE = os.path.dirname(os.path.abspath(__file__))
NU = ["0.3", "0.4", "0.45", "0.49", "0.4999"]
RATIO = ["0.2", "0.5", "1", "2"]
SLENDER = ["0.2", "0.5", "1", "2", "4"]
AROUND = [1.0, 1.25, 1.5, 2.0, 3.0]

force = {}
for r in csv.DictReader(open(os.path.join(HERE, "forces.csv"))):
    force[r["kind"], r["ratio"], r["poisson"], r["wide"], r["depth"]] = float(r["force"])


def f(*key):
    return force[tuple(key)]


def large(nu, ratio):
    deepest = min(0.2, 0.4 * float(ratio))
    small = f("flat", ratio, nu, "0", "0.001") / 0.001
    return [f("flat", ratio, nu, "0", "%.6g" % (deepest * k / 4)) / (deepest * k / 4) / small for k in range(1, 5)]


def wide(nu, ratio):
    return [f("wide", ratio, nu, "%g" % (x * float(ratio)), "0.001") / f("wide", ratio, nu, "0", "0.001") for x in AROUND]


def stick(nu, ratio):
    return f("flat_stick", ratio, nu, "0", "0.001") / f("flat", ratio, nu, "0", "0.001")


def glue(nu, ratio):
    return f("plate_stick", ratio, nu, "0", "0.001") / (2 * (1 + float(nu)) * 3.14159265358979 * float(ratio) ** 2 * 0.001)


def solve(matrix, right):
    """Gauss' elimination."""
    rows = [row + [b] for row, b in zip(matrix, right)]
    for i in range(len(rows)):
        p = max(range(i, len(rows)), key=lambda r: abs(rows[r][i]))
        rows[i], rows[p] = rows[p], rows[i]
        for r in range(len(rows)):
            if r != i:
                rows[r] = [x - rows[r][i] / rows[i][i] * y for x, y in zip(rows[r], rows[i])]
    return [row[-1] / row[i] for i, row in enumerate(rows)]


def terms(tip, ratio, nu, part):
    """As large_curved() of lib/material/indentation_factor.c has them."""
    n, s = 10 * (nu - 0.4), math.sqrt(part)
    if tip == "sphere":
        x = math.log(ratio)
        return [s, s * n, s * n * n, s * x, s * x * n, part, part * n, part * x, part * x * n]
    c = 1 / math.tan(math.radians(ratio))
    return [1, n, n * n, part, part * n, c, c * n, c * part, c * part * n]


def curved(tip):
    """Coefficients of the terms: least squares with Tukey's weights, since a contact of CalculiX now and then stops short of where it settles."""
    known = [(terms(tip, float(k[1]), float(k[2]), float(k[4]) / deepest[k[1]]), force[k] / force[(tip + "_small",) + k[1:]] - 1)
             for deepest in [{k[1]: max(float(j[4]) for j in force if j[:2] == k[:2]) for k in force if k[0] == tip}] for k in force if k[0] == tip]
    weight = [1.0] * len(known)
    for _ in range(50):
        found = solve([[sum(w * t[i] * t[j] for w, (t, _) in zip(weight, known)) for j in range(9)] for i in range(9)],
                      [sum(w * t[i] * y for w, (t, y) in zip(weight, known)) for i in range(9)])
        miss = [abs(y - sum(c * x for c, x in zip(found, t))) for t, y in known]
        scale = 4.685 * 1.4826 * sorted(miss)[len(miss) // 2]
        weight = [max(1 - (m / scale) ** 2, 0) ** 2 for m in miss]
    return found


def array(name, about, rows, shape):
    out = ["/* %s */" % about, "static const double %s%s = {" % (name, shape)]
    for row in rows:
        out.append("    {" + ", ".join(x if isinstance(x, str) else "%.5f" % x for x in row) + "},")
    return out + ["};", ""]


def braces(values):
    return "{" + ", ".join("%.5f" % x for x in values) + "}"


lines = ["/* indentation_tables.h: factors of the forces of CalculiX; data/tips/make_tables.py writes it. Internal. */", "#ifndef INDENTATION_TABLES_H",
         "#define INDENTATION_TABLES_H", "", "enum { TABLE_NU = %d, TABLE_RATIO = %d, TABLE_DEPTH = 4, TABLE_AROUND = %d, TABLE_SLENDER = %d };" %
         (len(NU), len(RATIO), len(AROUND), len(SLENDER)),
         "static const double table_nu[TABLE_NU] = {%s};" % ", ".join(NU[:-1] + ["0.5"]),
         "static const double table_ratio[TABLE_RATIO] = {%s}; /* punch over thickness */" % ", ".join(RATIO),
         "static const double table_around[TABLE_AROUND] = {%s}; /* specimen over punch */" % ", ".join("%g" % x for x in AROUND),
         "static const double table_slender[TABLE_SLENDER] = {%s}; /* radius over height */" % ", ".join(SLENDER), ""]
lines += array("table_large", "Flat punch, neo-Hookean, at a quarter, a half, three quarters and all of a depth of 0.2 thicknesses or 0.4 radii.",
               [[braces(large(nu, x)) for x in RATIO] for nu in NU], "[TABLE_NU][TABLE_RATIO][TABLE_DEPTH]")
lines += array("table_wide", "Flat punch on a cylinder.", [[braces(wide(nu, x)) for x in RATIO] for nu in NU], "[TABLE_NU][TABLE_RATIO][TABLE_AROUND]")
lines += array("table_stick", "Flat punch that sticks.", [[stick(nu, x) for x in RATIO] for nu in NU], "[TABLE_NU][TABLE_RATIO]")
lines += array("table_glue", "Cylinder glued to both plates.", [[glue(nu, x) for x in SLENDER] for nu in NU], "[TABLE_NU][TABLE_SLENDER]")
lines += ["/* Sphere and cone, neo-Hookean: coefficients of the terms of large_curved(); the sizes and depths that they hold for, over the thickness h: radius,",
          " * half angle's tangent, and the deepest, 0.16 R h / (R + 0.1 h) and 0.15 h. */", "enum { LARGE_TERMS = 9 };"]
lines += ["static const double large_%s[LARGE_TERMS] = %s;" % (tip, braces(curved(tip))) for tip in ("sphere", "cone")]
lines += ["static const double SPHERE_DEPTH = 0.16, SPHERE_SHARE = 0.1, SPHERE_LEAST = 0.3, SPHERE_MOST = 4.0;",
          "static const double CONE_DEPTH = 0.15, CONE_LEAST = %.6f, CONE_MOST = %.6f;" % tuple(math.tan(math.radians(bound(float(k[1]) for k in force if k[0] == "cone"))) for bound in (min, max)), ""]
lines.append("#endif")
open(os.path.join(HERE, "../../lib/material/indentation_tables.h"), "w").write("\n".join(lines) + "\n")
