#!/usr/bin/env python3
"""local_fit.py: fits the four constants of the law of local points (local_law.py has the law) on the half-space of springs, and prints
mean and ripple of the force over the solid's along two straight ways at radii and depths that the fit did not use. Needs numpy;
half a minute. The fit is of least squares; the scatter between places and the mean both weigh three times a single force."""
import itertools
import math

import numpy as np

from local_compliance import CELLS, compliance

ES = 0.8 / 0.75  # E / (1 - ratio^2) of the solid, with the springs' modulus 1, Poisson's ratio 1/4
FIT = [(0.5, 0.15), (1.0, 0.15), (1.0, 0.4), (1.6, 0.2), (1.6, 0.6), (3.0, 0.3), (0.7, 0.3)]  # radius, depth in spacings
JUDGE = [(0.75, 0.125), (0.75, 0.25), (1.25, 0.125), (1.25, 0.375), (1.75, 0.25), (2.08, 0.417), (2.5, 0.375), (2.08, 0.83), (4.17, 0.417), (5.83, 0.583),
         (10, 1)]
PLACES = [(0, 0), (0.5, 0), (0.5, 0.5), (0.667, 0.333), (0.3, 0.1), (0.25, 0.25), (0.15, 0.35), (0.6, 0.4), (0.25, 0.75)]
WAYS = [[((i + 0.5) / 8 + 0.075, 0.175) for i in range(8)], [((i + 0.5) / 8 + 0.075, (i + 0.5) / 8 + 0.175) for i in range(8)]]


def displacements():
    """Of nodes by a unit force on one, as in local_law.py."""
    half = [(i + 0.5) * math.pi / CELLS for i in range(CELLS)]
    wave = np.zeros((CELLS, CELLS))
    for i, j in itertools.product(range(CELLS), repeat=2):
        if j <= i:
            wave[i, j] = wave[j, i] = compliance(half[i], half[j])
    cosine = np.cos(np.outer(np.arange(14), half))
    return 1.6155 / (2 * CELLS) / (math.pi * ES) + cosine @ wave @ cosine.T / CELLS ** 2


GREEN = displacements()


def solid(r, d):
    low, high = 0.0, r * (1 - 1e-12)
    for _ in range(80):
        a = 0.5 * (low + high)
        if 0.5 * a * math.log((r + a) / (r - a)) < d:
            low = a
        else:
            high = a
    return ES * (0.5 * (a * a + r * r) * math.log((r + a) / (r - a)) - a * r)


def press(r, d, place, fine):
    """Points below a sphere: shares by node, displacements of nodes, depth, t of the law, area. fine: parts of an edge."""
    reach, nodes, index, shares, aside = min(math.sqrt(2 * r * d) * 1.02, 0.97 * r), {}, [], [], []
    part = [((u + (1 + (v & 1)) / 3) / fine, (v // 2 + (1 + (v & 1)) / 3) / fine) for u in range(fine) for v in range(2 * (fine - u) - 1)]
    part = np.array([(1 - a - b, a, b) for a, b in part])
    m = int(reach) + 2
    for a, b in itertools.product(range(-m, m + 1), repeat=2):
        for corner in (((a, b), (a + 1, b), (a + 1, b + 1)), ((a, b), (a + 1, b + 1), (a, b + 1))):
            at = part @ np.array(corner, float) - place
            away = np.hypot(at[:, 0], at[:, 1])
            inside = away < reach
            if inside.any():
                index += [[nodes.setdefault(c, len(nodes)) for c in corner]] * int(inside.sum())
                shares.append(part[inside])
                aside.append(away[inside])
    shares, aside, index = np.vstack(shares), np.concatenate(aside), np.array(index)
    by_node = np.zeros((len(index), len(nodes)))
    for c in range(3):
        by_node[np.arange(len(index)), index[:, c]] = shares[:, c]
    to = np.array(list(nodes))
    to = abs(to[:, None] - to[None])
    return r, by_node, GREEN[to[..., 0], to[..., 1]], d - (r - np.sqrt(r * r - aside ** 2)), 1.5 * (shares ** 2).sum(1) - 0.5, 0.5 / fine ** 2, solid(r, d)


def force(case, constants):
    """Over the solid's, by Newton's method."""
    r, by_node, green, gap, t, area, whole = case
    a, b, c, e = constants
    root, linear, steep, w = ES / math.pi / math.sqrt(r), a + b * t, (c * t + e * t * t) * math.sqrt(r), np.zeros(len(green))
    for i in range(80):
        u = gap - by_node @ w
        on, s = u > 0, np.sqrt(np.maximum(u, 1e-30))
        f = by_node.T @ np.where(on, root * s + linear * u + steep * u * s, 0) * area
        miss = w - green @ f
        if abs(miss).max() < 1e-8 * gap.max():
            break
        slope = np.where(on, 0.5 * root / s + linear + 1.5 * steep * s, 0) * area
        w = w - (1 if i < 15 else 0.5) * np.linalg.solve(np.eye(len(w)) + green @ (by_node.T @ (slope[:, None] * by_node)), miss)
    return f.sum() / whole


def parts(r, twice):
    """As contact_find.c has them, or twice as many: the fit is to the law, not to few points."""
    return min(max(math.ceil((1 + twice) * 2.5 * 1.138 / r), 3 * (1 + twice)), 12)


def misses(cases, constants):
    over = np.array([[force(case, constants) - 1 for case in row] for row in cases])
    mean = over.mean(1)
    return np.concatenate([3 * mean, 3 * (over - mean[:, None]).ravel()])


def main():
    cases = [[press(r, d, place, parts(r, True)) for place in PLACES] for r, d in FIT]
    x, damp = np.array([1.0, -2.0, 8.0, 20.0]), 1e-4
    miss = misses(cases, x)
    for _ in range(8):
        slope = np.column_stack([(misses(cases, x + 0.05 * e) - miss) / 0.05 for e in np.eye(4)])
        square = slope.T @ slope
        new = x - np.linalg.solve(square + damp * np.diag(np.diag(square)), slope.T @ miss)
        tried = misses(cases, new)
        if tried @ tried < miss @ miss:
            x, miss, damp = new, tried, damp / 10
        else:
            damp *= 100
    print("constants: %.3f %.3f %.3f %.3f" % tuple(x))
    print("%6s %6s  %s" % ("radius", "depth", "mean and ripple % of two ways, as many points as in the library; twice as many an edge"))
    for r, d in JUDGE:
        line = "%6.2f %6.3f " % (r, d)
        for twice in (False, True):
            for way in WAYS:
                over = np.array([force(press(r, d, y, parts(r, twice)), (0.95, -2.05, 8.1, 20.2)) for y in way])
                line += " %.3f %4.1f" % (over.mean(), 100 * np.ptp(over) / over.mean())
        print(line)


if __name__ == "__main__":
    main()
