"""tips_calculix.py PALPATE FOLDER [KIND ...]: seeded random presses by CalculiX on two meshes, extrapolated, through palpate characterize: the shear
modulus that it finds over the one that CalculiX had. Prints "case modulus-ratio depth". h = 10 mm, G = 1000 Pa."""
import json
import math
import os
import random
import subprocess
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../data/tips"))
from ccx_tip import at, run

palpate, folder = sys.argv[1], sys.argv[2]
random.seed(20)
noise = random.Random(21)  # apart, so that each kind has the same cases alone


def curve(tip, ratio, nu, depth, steps, fine, **options):
    """Forces at steps of depth; the error of a mesh goes with its size."""
    if tip in ("sphere", "cone"):  # its contact settles from below, and no power of the mesh's size: the finer mesh as it is
        return [(0.0, 0.0)] + run(tip, ratio, nu, depth, steps, fine=fine, **options)
    coarse, fine = (run(tip, ratio, nu, depth, steps, fine=n, **options) for n in (fine, 2 * fine))
    return [(0.0, 0.0)] + [(depth * k / steps, 2 * at(fine, depth * k / steps) - at(coarse, depth * k / steps)) for k in range(1, steps + 1)]


def force(points, d, power):
    """Between the points, F / d^power is straight."""
    if d <= points[1][0]:
        return points[1][1] * (max(d, 0) / points[1][0]) ** power
    for (x, y), (u, v) in zip(points[1:], points[2:]):
        if d <= u * (1 + 1e-9):
            p, q = y / x ** power, v / u ** power
            return d ** power * (p + (q - p) * (d - x) / (u - x))


def modulus(name, points, power, nu, wide, options):
    path = os.path.join(folder, name + ".csv")
    deepest = points[-1][0]
    with open(path, "w") as f:
        f.write("# palpate.experiment: 1\n# specimen.height_mm: 10\n" + ("# specimen.radius_mm: %.9g\n" % (10 * wide) if wide else "") + "# protocol.kind: \"static\"\ntime_s,depth_mm,force_N\n")
        for i in range(-40, 201):
            d = deepest * i / 200
            f.write("%g,%.9g,%.9g\n" % (i / 10, 10 * d, 0.1 * force(points, d, power) if i > 0 else 0.0) if i else "0,0,0\n")
    text = open(path).read().split("\n")
    peak = 0.1 * points[-1][1]
    with open(path, "w") as f:  # noise of a ten-thousandth of the peak
        for line in text:
            w = line.split(",")
            f.write(line + "\n" if len(w) < 3 or w[0] == "time_s" else "%s,%s,%.9g\n" % (w[0], w[1], float(w[2]) + noise.gauss(0, 1e-4 * peak)) if line else "")
    out = subprocess.run([palpate, "characterize", path, "--arms", "0", "--contact", "known", "--poisson", "%.4f" % nu, "--json"] + options,
                         capture_output=True, text=True)
    if out.returncode:
        sys.exit("%s: %s" % (name, out.stderr))
    return json.loads(out.stdout)["moduli"]["shear_inf_Pa"]["value"] / 1000


def case(name, tip, ratio, nu, depth, steps, fine, power, flags, **options):
    points = curve(tip, ratio, nu, depth, steps, fine, **options)
    size = ["--tip-angle-deg", str(ratio)] if tip == "cone" else ["--tip-radius-mm", "%.6f" % (10 * ratio)]
    print("%s ratio %.3f nu %.4f depth %.3f modulus %.4f" % (name, ratio, nu, depth, modulus(name.replace(" ", "_"), points, power, nu, options.get("wide"), ["--tip", tip] + size + flags)), flush=True)


def draw(low, high):
    return math.exp(random.uniform(math.log(low), math.log(high)))


wanted = sys.argv[3:]
for k in range(4):
    ratio, nu = draw(0.2, 2), random.uniform(0.3, 0.4999)
    if not wanted or "small" in wanted:
        case("small %d" % k, "flat", ratio, nu, 0.002, 1, 6, 1.0, ["--small-strain"])
for k in range(4):
    ratio, nu, part = draw(0.2, 2), 0.3 + 0.19 * (k + random.random()) / 4, random.uniform(0.5, 1)
    if not wanted or "large" in wanted:
        case("large %d" % k, "flat", ratio, nu, part * min(0.2, 0.25 * ratio), 4, 5, 1.0, [])
for k in range(3):
    ratio, nu, around = draw(0.2, 2), random.uniform(0.3, 0.4999), random.uniform(1.1, 2.5)
    if not wanted or "narrow" in wanted:
        case("narrow %d" % k, "flat", ratio, nu, 0.002, 1, 6, 1.0, ["--small-strain"], wide=around * ratio)
for k in range(2):
    ratio, nu = draw(0.2, 2), random.uniform(0.3, 0.4999)
    if not wanted or "stick" in wanted:
        case("stick %d" % k, "flat", ratio, nu, 0.002, 1, 6, 1.0, ["--small-strain", "--tip-sticks"], stick=True)
for k in range(3):
    ratio, nu = draw(0.5, 4), 0.3 + 0.19 * (k + random.random()) / 3
    if not wanted or "sphere" in wanted:
        case("sphere %d" % k, "sphere", ratio, nu, 0.02, 2, 9, 1.5, [])
for k in range(1):
    ratio, nu = random.uniform(75, 85), random.uniform(0.3, 0.49)
    if not wanted or "cone" in wanted:
        case("cone %d" % k, "cone", ratio, nu, 0.05, 2, 9, 2.0, [])
for k in range(4):
    ratio, nu = draw(0.3, 4), 0.3 + 0.19 * ((k * 3 % 4) + random.random()) / 4
    depth = random.uniform(0.6, 1) * 0.16 * ratio / (ratio + 0.1)
    if not wanted or "deep_sphere" in wanted:
        case("deep sphere %d" % k, "sphere", ratio, nu, depth, 4, 9, 1.5, [])
for k in range(1):
    ratio, nu, depth = random.uniform(70, 80), 0.3 + 0.19 * (k + random.random()) / 2, random.uniform(0.08, 0.15)
    if not wanted or "deep_cone" in wanted:
        case("deep cone %d" % k, "cone", ratio, nu, depth, 2, 18, 2.0, [])
