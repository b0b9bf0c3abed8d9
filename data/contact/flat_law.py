#!/usr/bin/env python3
"""flat_law.py: the law of a hull's points (contact_hull_law in lib/contact/contact_face.c) on a half-space of springs that is scaled as
a solid: force of a round flat punch over that on the solid, 2 E* a per depth, by its radius in spacings; mean over places and their range.
usage: flat_law.py [POISSON]. Once on the local points of linear triangles, once on Loop's surface with two subdivisions. Needs numpy; a
minute. local_compliance.py has the half-space, local_law.py the rule for Poisson's ratios on triangles."""
import itertools
import math
import sys

import numpy as np

from local_compliance import CELLS, compliance

POISSON = float(sys.argv[1]) if len(sys.argv) > 1 else 0.25
ES, STIFFER = 0.8 / (1 - POISSON), 0.75 / (1 - POISSON)
RADII, PLACES = (0.5, 0.83, 1.25, 2.08, 3), ((0, 0), (0.5, 0.5), (0.667, 0.333), (0.3, 0.1))
LAWS = {"triangles": (STIFFER ** 2, 3.0, 16.0), "smooth": (STIFFER, 1.6, 4.0)}


def displacements():
    """Of nodes by a unit force on one, as in local_law.py."""
    half = [(i + 0.5) * math.pi / CELLS for i in range(CELLS)]
    wave = np.array([[compliance(x, y, POISSON) for y in half] for x in half])
    cosine = np.cos(np.outer(np.arange(18), half))
    return 1.6155 / (2 * CELLS) / (math.pi * ES) + cosine @ wave @ cosine.T / CELLS ** 2


def ring(f):
    """Sum over the six neighbours of each vertex of a regular net."""
    p = np.pad(f, ((1, 1), (1, 1), (0, 0)))
    return p[2:, 1:-1] + p[:-2, 1:-1] + p[1:-1, 2:] + p[1:-1, :-2] + p[2:, 2:] + p[:-2, :-2]


def divide(f):
    """Loop's subdivision there."""
    out, p = np.zeros((2 * len(f) - 1,) * 2 + f.shape[2:]), np.pad(f, ((1, 1), (1, 1), (0, 0)))
    out[::2, ::2] = (10 * f + ring(f)) / 16
    out[1::2, ::2] = (3 * (f[:-1] + f[1:]) + p[1:-2, :-2] + p[2:-1, 2:]) / 8
    out[::2, 1::2] = (3 * (f[:, :-1] + f[:, 1:]) + p[:-2, 1:-2] + p[2:, 2:-1]) / 8
    out[1::2, 1::2] = (3 * (f[:-1, :-1] + f[1:, 1:]) + f[1:, :-1] + f[:-1, 1:]) / 8
    return out


def smooth_points(m):
    """Places and weights of nodes of the vertices within m spacings, and their area."""
    n = 2 * m + 1
    f = np.eye(n * n).reshape(n, n, n * n)
    f = f / 2 + ring(f) / 12
    f = divide(divide(f))
    f = f / 2 + ring(f) / 12
    x = np.arange(len(f)) / 4 - m
    return np.array(list(itertools.product(x, x))), f.reshape(-1, n * n), 1 / 16


def triangle_points(m, fine=4):
    n, places, weights = 2 * m + 1, [], []
    part = [((u + (1 + (v & 1)) / 3) / fine, (v // 2 + (1 + (v & 1)) / 3) / fine) for u in range(fine) for v in range(2 * (fine - u) - 1)]
    for i, j in itertools.product(range(n - 1), repeat=2):
        for corners in (((i, j), (i + 1, j), (i + 1, j + 1)), ((i, j), (i + 1, j + 1), (i, j + 1))):
            for a, b in part:
                w = np.zeros(n * n)
                w[[c[0] * n + c[1] for c in corners]] = 1 - a - b, a, b
                weights.append(w)
                places.append(w[[c[0] * n + c[1] for c in corners]] @ np.array(corners) - m)
    return np.array(places), np.array(weights), 0.5 / fine ** 2


def force(points, green, m, radius, place, law):
    at, weights, area = points
    inset = radius - np.hypot(*(at - place).T)
    inside, scale = inset > 0, law[0]
    used = np.abs(weights[inside]).sum(0) > 0
    w, node = weights[inside][:, used], np.array(list(itertools.product(range(2 * m + 1), repeat=2)))[used]
    apart = abs(node[:, None] - node[None])
    layer = 1 / (scale * area * (law[1] + law[2] * inset[inside] ** 2))
    return np.linalg.solve(w @ green[apart[..., 0], apart[..., 1]] @ w.T + np.diag(layer), np.ones(inside.sum())).sum() / (2 * ES * radius)


def main():
    green, m = displacements(), 8
    for name, points in (("triangles", triangle_points(m)), ("smooth", smooth_points(m))):
        for radius in RADII:
            for stiff, law in (("penalty", (1.0, 24.0, 0.0)), ("law", LAWS[name])):
                over = [force(points, green, m, radius, np.array(place), law) for place in PLACES]
                print("%-10s %5.2f %-7s %.3f %.3f" % (name, radius, stiff, np.mean(over), np.ptp(over)))


if __name__ == "__main__":
    main()
