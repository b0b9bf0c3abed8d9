"""rheos.py relax CA A KB KG >FILE: stress, strain and time of a ramp and hold, laid out as RHEOS.jl writes them, of its fractional
standard linear solid (a springpot CA, A in series with a spring KB, beside a spring KG), by Talbot's inversion of its transform.
rheos.py compare CA A KB KG <FILE: rows of frequency (rad/s), G', G'': the largest miss against the solid's closed form, over |G|."""
import cmath
import math
import random
import sys

ca, a, kb, kg = map(float, sys.argv[2:6])
RAMP, STRAIN, M = 0.1, 0.1, 18


def held(s):
    """Transform of the integral of the relaxation modulus."""
    return (ca * s ** a * kb / (ca * s ** a + kb) + kg) / s ** 2


def inverse(t):
    """Abate and Valko 2004."""
    if t <= 0:
        return 0.0
    r = 2 * M / (5 * t)
    total = 0.5 * math.exp(r * t) * held(r)
    for k in range(1, M):
        theta = k * math.pi / M
        cot = 1 / math.tan(theta)
        s = r * theta * (cot + 1j)
        total += (cmath.exp(t * s) * held(s) * (1 + 1j * (theta + (theta * cot - 1) * cot))).real
    return r / M * total


if sys.argv[1] == "relax":
    random.seed(5)
    times = [0.02 * i for i in range(2500)]
    rows = [((inverse(t) - inverse(t - RAMP)) * STRAIN / RAMP, STRAIN * min(max(t / RAMP, 0), 1), t + 1) for t in times]
    peak = max(r[0] for r in rows)
    rows = [(0.0, 0.0, 0.02 * i) for i in range(1, 50)] + rows
    print("NaN,NaN,0\nNaN,0,0.01")
    for stress, strain, t in rows:
        print("%.9g,%.9g,%.9g" % (stress + 1e-4 * peak * random.gauss(0, 1), strain, t))
else:
    worst = 0.0
    for line in sys.stdin:
        w, storage, loss = map(float, line.split(","))
        pot = ca * (1j * w) ** a
        wanted = pot * kb / (pot + kb) + kg
        worst = max(worst, abs(storage + 1j * loss - wanted) / abs(wanted))
    print("%.5f" % worst)
