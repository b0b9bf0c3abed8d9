#!/usr/bin/env python3
"""local_compliance.py: the compliance that a lattice lacks right below a tool, as a layer b h / E (h the spacing, E Young's
modulus): Boussinesq's half-space less the half-space of springs that is scaled as a solid (doc/numerics.md), under a pressure
p ~ exp(-r^2 / (2 s^2)) anywhere on its cells, weighed by that pressure. Poisson's ratio 1/4, h = E = 1.
Prints b for linear triangles, for Loop's surface of smoothed nodes (lib/contact/subdivide.h), and by the formula of
lib/contact/contact_find.c for the latter; by the radius a = sqrt(5) s of Hertz's pressure that is as wide."""
import cmath
import itertools
import math

BODY = 3 * math.sqrt(3) * (1 - math.sqrt(0.5)) / 8  # factors of a cube: edges and diagonals of faces 1, of the body
UNIT = 0.4 / (math.sqrt(0.5) + 4 * BODY / math.sqrt(27))  # so that C1212 = 2/5
CELLS, ZONES = 24, 3  # wave vectors to half a Brillouin zone, zones to each side


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def add(a, b, s=1.0):
    return [[a[i][j] + s * b[i][j] for j in range(3)] for i in range(3)]


def inverse(m):
    c = [[m[(j + 1) % 3][(i + 1) % 3] * m[(j + 2) % 3][(i + 2) % 3] - m[(j + 1) % 3][(i + 2) % 3] * m[(j + 2) % 3][(i + 1) % 3]
          for j in range(3)] for i in range(3)]
    d = sum(m[0][j] * c[j][0] for j in range(3))
    return [[v / d for v in row] for row in c]


def outer(a, b):
    return [[complex(a[i]).conjugate() * b[j] for j in range(3)] for i in range(3)]


def compliance(kx, ky, poisson=0.25):
    """Normal displacement of the surface's nodes by normal forces on them, both a wave; the surface's normal is z. Above a ratio of
    1/4 each cell resists the mean of its corners' change of volume (doc/numerics.md)."""
    zero = [[0.0] * 3 for _ in range(3)]
    surface, inside, down, up = zero, zero, zero, zero
    for d in itertools.product((-1, 0, 1), repeat=3):
        n = sum(map(abs, d))
        if n == 0:
            continue
        s = UNIT * (BODY if n == 3 else 1.0) / math.sqrt(n)
        spring = [[s * d[i] * d[j] / n for j in range(3)] for i in range(3)]
        wave = cmath.exp(1j * (kx * d[0] + ky * d[1]))
        inside = add(inside, spring, 1.0 - (wave if d[2] == 0 else 0.0))
        if d[2] == 0:
            surface = add(surface, spring, 0.5 * (1.0 - wave))
        elif d[2] < 0:
            surface = add(surface, spring)
            down = add(down, spring, -wave)
        else:
            up = add(up, spring, -wave)
    if poisson > 0.25:
        modulus = 0.4 * (4 * poisson - 1) / (1 - 2 * poisson)
        sx, sy, cx, cy = math.sin(kx / 2), math.sin(ky / 2), math.cos(kx / 2), math.cos(ky / 2)
        high, low = (1j * sx * cy, 1j * cx * sy, cx * cy), (1j * sx * cy, 1j * cx * sy, -cx * cy)
        surface = add(surface, outer(high, high), modulus)
        inside = add(add(inside, outer(high, high), modulus), outer(low, low), modulus)
        down, up = add(down, outer(high, low), modulus), add(up, outer(low, high), modulus)
    for _ in range(60):  # every other layer is taken out
        g = inverse(inside)
        dg, ug = product(down, g), product(up, g)
        surface = add(surface, product(dg, up), -1.0)
        inside = add(add(inside, product(dg, up), -1.0), product(ug, down), -1.0)
        down, up = ([[-v for v in row] for row in m] for m in (product(dg, down), product(ug, up)))
        if max(abs(v) for row in down for v in row) < 1e-14:
            break
    return inverse(surface)[2][2].real


def sinc(x):
    return math.sin(x) / x if x else 1.0


def main():
    step = math.pi / CELLS
    half = [(i + 0.5) * step for i in range(CELLS)]
    table = {(i, j): compliance(half[i], half[j]) for i in range(CELLS) for j in range(CELLS)}
    waves = []  # size, what linear triangles lack, what Loop's surface lacks
    reach = CELLS * (2 * ZONES + 1)
    for i, j in itertools.product(range(-reach, reach), repeat=2):
        kx, ky = (i + 0.5) * step, (j + 0.5) * step
        k = math.hypot(kx, ky)
        fold = [min(v % (2 * CELLS), 2 * CELLS - 1 - v % (2 * CELLS)) for v in (i, j)]
        hat = sinc(kx / 2) * sinc(ky / 2) * sinc((kx + ky) / 2)
        limit = 0.5 + (math.cos(kx) + math.cos(ky) + math.cos(kx + ky)) / 6
        solid, springs = 2 * (1 - 1 / 16) / k, table[tuple(fold)]
        waves.append((k, solid - hat ** 2 * springs, solid - (limit * hat ** 2) ** 2 * springs))
    print("%6s %8s %8s %8s" % ("a/h", "linear", "Loop", "formula"))
    for a in [i / 10 for i in range(11)] + [1.25, 1.5, 2.0]:
        s = a / math.sqrt(5)
        weights = [math.exp(-(k * s) ** 2) for k, _, _ in waves]
        linear, loop = (sum(w * x[i] for w, x in zip(weights, waves)) / sum(weights) for i in (1, 2))
        print("%6.2f %8.3f %8.3f %8.3f" % (a, linear, loop, (0.15 + 4.20 * a * a) / (1 + 4.93 * a * a)))


if __name__ == "__main__":
    main()
