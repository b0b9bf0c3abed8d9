#!/usr/bin/env python3
"""Writes haptic_minute.csv: a minute of a hand with a round tip on the top of a cube of 24 mm: six times approach,
press, hold, slide, hold, release, in minimum-jerk moves with the tremor of a hand (8 to 12 Hz, 0.05 mm) and its drift.
100 rows a second; a simulator interpolates. Always the same numbers."""
import math
import random

RATE, RADIUS, TOP = 100, 4.0, 24.0
rng = random.Random(2008)


def minimum_jerk(s):
    return s ** 3 * (10 - 15 * s + 6 * s * s)


def corners():
    """(seconds, x, height of the tip above the surface, z) to be reached one after another."""
    for cycle in range(6):
        x0, z0 = rng.uniform(8, 16), rng.uniform(8, 16)
        x1, z1 = x0 + rng.uniform(-5, 5), z0 + rng.uniform(-5, 5)
        depth = rng.uniform(1.5, 3.0)
        yield 1.2, x0, 0.3, z0
        yield 1.3, x0, -depth, z0
        yield 1.5, x0, -depth, z0
        yield 3.0, x1, -depth, z1
        yield 1.0, x1, -depth * rng.uniform(0.7, 1.0), z1
        yield 0.8, x1, 0.3, z1
        yield 1.2, 0.5 * (x1 + 12), 4.0, 0.5 * (z1 + 12)


tremor = [[(0.05 / 3 * rng.uniform(0.5, 1.5), rng.uniform(8, 12), rng.uniform(0, 2 * math.pi)) for _ in range(3)]
          + [(0.15, rng.uniform(0.2, 0.5), rng.uniform(0, 2 * math.pi))] for _ in range(3)]


def hand(t):
    return [sum(a * math.sin(2 * math.pi * f * t + p) for a, f, p in axis) for axis in tremor]


with open(__file__.replace("make_haptic_minute.py", "haptic_minute.csv"), "w") as out:
    out.write("# tool: sphere, radius_mm: %.1f; specimen: cube of 24 mm, one corner at the origin, top at y = 24 mm\n" % RADIUS)
    out.write("time_s,x_mm,y_mm,z_mm\n")
    here, start, moves = (12.0, 4.0, 12.0), 0.0, list(corners())
    row = 0
    for seconds, *there in moves:
        while row / RATE < start + seconds:
            t = row / RATE
            s = minimum_jerk((t - start) / seconds)
            shake = hand(t)
            x, h, z = ((1 - s) * a + s * b + w for a, b, w in zip(here, there, shake))
            out.write("%.2f,%.4f,%.4f,%.4f\n" % (t, x, TOP + RADIUS + h, z))
            row += 1
        start += seconds
        here = tuple(there)
