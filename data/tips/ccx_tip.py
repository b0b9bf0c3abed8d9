#!/usr/bin/env python3
"""ccx_tip.py: the force of a rigid tip pressed into a cylinder of a neo-Hookean solid, by CalculiX (axisymmetric, large strain).

    ccx_tip.py TIP RATIO NU DEPTH [STEPS] [--stick] [--wide R] [--fine N] [--scale S]

TIP is flat, sphere, cone or plate; lengths are in heights of the layer and G = 1. RATIO: radius of the tip (cone: half angle in
degrees). Prints "depth force" lines. The floor is bonded; --wide: radius of the specimen, default so wide that it does not matter.
Other scripts import run(). Python's standard library and ccx only."""
import math
import os
import resource
import subprocess
import sys
import tempfile


def graded(start, end, first, last):
    """Points from start to end whose steps grow by a constant factor from about first to about last."""
    length = end - start
    if length <= max(first, last):
        return [start, end]
    n = max(2, round(length / (0.5 * (first + last)) if abs(first - last) < 1e-9 * last else
                     1 + math.log(last / first) / math.log((length - first) / (length - last)) if length > last else 2))
    factor = (last / first) ** (1 / (n - 1)) if n > 1 else 1
    steps = [factor ** i for i in range(n)]
    total, x, points = sum(steps), 0.0, [start]
    for s in steps:
        x += s
        points.append(start + length * x / total)
    return points


def join(*parts):
    points = list(parts[0])
    for p in parts[1:]:
        points += p[1:]
    return points


def quads(f, xs, ys, node0, element0):
    """Eight-noded quadrilaterals on a grid; returns node numbers by (column, row) of the doubled grid."""
    def middle(p):
        out = []
        for a, b in zip(p, p[1:]):
            out += [a, 0.5 * (a + b)]
        return out + [p[-1]]
    X, Y, number, n = middle(xs), middle(ys), {}, node0
    lines = []
    for i, x in enumerate(X):
        for j, y in enumerate(Y):
            if i % 2 and j % 2:
                continue
            n += 1
            number[i, j] = n
            lines.append("%d,%.12g,%.12g,0" % (n, x, y))
    f.write("*NODE,NSET=NALL\n" + "\n".join(lines) + "\n")
    f.write("*ELEMENT,TYPE=CAX8R,ELSET=LAYER\n")
    e = element0
    cell = {}
    for i in range(0, len(X) - 2, 2):
        for j in range(0, len(Y) - 2, 2):
            e += 1
            cell[i // 2, j // 2] = e
            c = [number[i, j], number[i + 2, j], number[i + 2, j + 2], number[i, j + 2],
                 number[i + 1, j], number[i + 2, j + 1], number[i + 1, j + 2], number[i, j + 1]]
            f.write(",".join(map(str, [e] + c)) + "\n")
    return number, cell, len(X), len(Y), n, e


def nset(f, name, nodes):
    f.write("*NSET,NSET=%s\n" % name)
    for k in range(0, len(nodes), 12):
        f.write(",".join(map(str, nodes[k:k + 12])) + ",\n")


def gap(tip, ratio, r, scale=1.0):
    """Height of the tip's surface over its lowest point, times a scale."""
    if tip == "sphere":
        return scale * (ratio - math.sqrt(max(ratio * ratio - r * r, 0)))
    return scale * r / math.tan(math.radians(ratio))


def deck(path, tip, ratio, nu, depth, steps, stick, wide, fine, scale):
    curved = tip in ("sphere", "cone")
    if curved:
        # half-space estimate of the contact, and half as much again for the layer
        a = math.sqrt(ratio * depth) if tip == "sphere" else depth * math.tan(math.radians(ratio)) * 0.64
        a = min((1.5 + 0.3 * min(a, 1.5)) * a, 0.95 * ratio) if tip == "sphere" else 1.6 * a
    else:
        a = ratio
    wide = a if tip == "plate" else wide or a + 4.0
    size = min(a, 1.0) / fine
    if curved:
        xs = join(graded(0, a, size, size), graded(a, wide, size, 0.25))
    elif tip == "plate" or wide <= a * 1.0001:
        xs = graded(0, wide, 0.12 / fine * 8, 0.02 / fine * 8)
    else:
        xs = join(graded(0, a, min(0.15, a / 3), size), graded(a, wide, size, min(0.3, (wide - a) / 3)))
    low = 0.08 * 8 / fine
    ys = [1 - y for y in reversed(graded(0, 1, size / 2 if curved else size, low))]
    with open(path + ".inp", "w") as f:
        number, cell, nx, ny, last, laste = quads(f, xs, ys, 0, 0)
        nset(f, "FLOOR", [number[i, 0] for i in range(nx)])
        nset(f, "AXIS", [number[0, j] for j in range(ny)])
        top = [number[i, ny - 1] for i in range(nx)]
        X = []
        for p, q in zip(xs, xs[1:]):
            X += [p, 0.5 * (p + q)]
        X.append(xs[-1])
        if not curved:
            nset(f, "TIP", [n for n, x in zip(top, X) if x <= a * (1 + 1e-9)])
        f.write("*MATERIAL,NAME=SOLID\n*HYPERELASTIC,NEO HOOKE\n")
        bulk = 2 * (1 + nu) / (3 * (1 - 2 * nu))
        f.write("0.5,%.12g\n*SOLID SECTION,ELSET=LAYER,MATERIAL=SOLID\n" % (2 / bulk))
        if curved:
            # the tip: a thin strip of stiff elements behind its surface, all its nodes moved
            m = int(max(24, 3 * fine))
            edge = 1.02 * a if tip == "cone" else min(1.02 * a, 0.999 * ratio)
            f.write("*NODE,NSET=TIP\n")
            base = last
            for i in range(m + 1):
                r = edge * i / m
                f.write("%d,%.12g,%.12g,0\n" % (base + 2 * i + 1, r, 1 + gap(tip, ratio, r, scale)))
                f.write("%d,%.12g,%.12g,0\n" % (base + 2 * i + 2, r, 1 + gap(tip, ratio, r, scale) + 0.3))
            f.write("*ELEMENT,TYPE=CAX4,ELSET=RIGID\n")
            for i in range(m):
                k = base + 2 * i
                f.write("%d,%d,%d,%d,%d\n" % (laste + 1 + i, k + 1, k + 3, k + 4, k + 2))
            f.write("*MATERIAL,NAME=STIFF\n*ELASTIC\n1000,0.3\n*SOLID SECTION,ELSET=RIGID,MATERIAL=STIFF\n")
            f.write("*SURFACE,NAME=STIP,TYPE=ELEMENT\nRIGID,S1\n*SURFACE,NAME=STOP,TYPE=ELEMENT\n")
            for i in range(len(xs) - 1):
                if xs[i] < 1.05 * a:
                    f.write("%d,S3\n" % cell[i, len(ys) - 2])
            f.write("*SURFACE INTERACTION,NAME=TOUCH\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n%g,1e-4\n" % (200.0 / size * 0.5))
            if stick:
                f.write("*FRICTION\n%g,%g\n" % (5.0, 50 / size))
            f.write("*CONTACT PAIR,INTERACTION=TOUCH,TYPE=SURFACE TO SURFACE\nSTOP,STIP\n")
        f.write("*BOUNDARY\nFLOOR,1,2\nAXIS,1,1\n")
        if curved:
            f.write("TIP,1,1\n")
        elif stick:
            f.write("TIP,1,1\n")
        f.write("*STEP,NLGEOM,INC=200\n*STATIC\n%g,1,1e-4,%g\n*BOUNDARY\nTIP,2,2,%.12g\n" % (1 / steps, 1 / steps, -depth * scale))
        f.write("*NODE PRINT,NSET=FLOOR,TOTALS=ONLY\nRF\n*END STEP\n")


def at(curve, d):
    """Force at a depth: force over depth through the three nearest points of a curve of (depth, force)."""
    near = []
    for p in sorted(reversed(curve), key=lambda p: abs(p[0] - d)):  # of increments that ended almost together, the last
        if len(near) < 3 and all(abs(p[0] - q[0]) > 1e-3 * d for q in near):
            near.append(p)
    total = 0.0
    for i, (x, y) in enumerate(near):
        weight = y / x
        for j, (other, _) in enumerate(near):
            if j != i:
                weight *= (d - other) / (x - other)
        total += weight
    return total * d


def run(tip, ratio, nu, depth, steps=8, stick=False, wide=None, fine=8, keep=None, scale=1.0, limit=600):
    """[(depth, force)], or raises RuntimeError. A curved tip whose profile and depth are scaled down touches the same nodes at small
    strain: depth and force are given over the scale. A run is given up after limit seconds of processor."""
    nu = min(nu, 0.4999)
    with tempfile.TemporaryDirectory() as folder:
        name = os.path.join(keep or folder, "tip")
        deck(name, tip, ratio, nu, depth, steps, stick, wide, fine, scale)
        done = subprocess.run(["ccx", "-i", name], capture_output=True, text=True, env=dict(os.environ, OMP_NUM_THREADS="1"), cwd=keep or folder,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit)))
        curve, t = [], None
        for line in open(name + ".dat"):
            words = line.split()
            if "time" in line:
                t = float(words[-1])
            elif len(words) == 3 and t is not None:
                curve.append((t * depth, 180 * float(words[1]) / scale))  # of a wedge of 2 degrees
        if not curve or curve[-1][0] < 0.999 * depth:
            raise RuntimeError("ccx stopped at %s of %g: %s" % (curve[-1:] and curve[-1][0], depth, done.stdout[-300:]))
        return curve


if __name__ == "__main__":
    words, options = [], {}
    arguments = iter(sys.argv[1:])
    for w in arguments:
        if w == "--stick":
            options["stick"] = True
        elif w in ("--wide", "--fine", "--scale"):
            options[w[2:]] = float(next(arguments))
        elif w == "--keep":
            options["keep"] = next(arguments)
        else:
            words.append(w)
    for d, force in run(words[0], float(words[1]), float(words[2]), float(words[3]), int(words[4]) if len(words) > 4 else 8, **options):
        print("%.6g %.8g" % (d, force))
