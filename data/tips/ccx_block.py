#!/usr/bin/env python3
"""ccx_block.py: a cube that is pressed, by CalculiX, with the functions press and face for other scripts.

    ccx_block.py sphere RADIUS NU DEPTH [STEPS] [--fine N | --nodes N]
                                a rigid smooth sphere pressed into the middle of its top; a quarter of it, neo-Hookean
    ccx_block.py sphere RADIUS NU DEPTH [STEPS] --at X[,Z] [--side] [--length L] [--fine N]
                                the same X from an edge of the top, in the middle of the other way (half of the cube) or Z from that edge
                                (all of it); --side: the face X = 0 is bonded in place of the floor, so the tip presses a side, X above
                                the bonded face; --length: a capsule that lies along z, between the centres of its ends
    ccx_block.py face NU [--fine N]
                                between bonded plates, small strain

Lengths are in sides of the cube and G = 1; its floor is bonded. --fine: quadratic elements under the contact's radius, or along a side.
--nodes: instead linear elements that are all alike, so many nodes a side. The first prints "depth force" lines; the second the forces pressed and sheared and the bulge at mid-face, over the plate's motion."""
import math
import os
import resource
import subprocess
import sys
import tempfile

from ccx_tip import gap, graded, join, nset

CORNERS = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
EDGES = [(1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2), (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]


def doubled(points):
    """With the middles of the steps."""
    return [0.5 * (points[k // 2] + points[(k + 1) // 2]) for k in range(2 * len(points) - 1)]


def bricks(f, xs, ys, zs, linear=False):
    """Twenty-noded (eight-noded) bricks on a grid, ys upwards; returns nodes by place in the doubled grid, elements by cell."""
    grid = doubled(xs), doubled(ys), doubled(zs)
    number, cell = {}, {}
    f.write("*NODE,NSET=NALL\n")
    for i, x in enumerate(grid[0]):
        for j, y in enumerate(grid[1]):
            for k, z in enumerate(grid[2]):
                if i % 2 + j % 2 + k % 2 < (1 if linear else 2):
                    number[i, j, k] = len(number) + 1
                    f.write("%d,%.12g,%.12g,%.12g\n" % (number[i, j, k], x, y, z))
    f.write("*ELEMENT,TYPE=%s,ELSET=BLOCK\n" % ("C3D8" if linear else "C3D20R"))
    for i in range(len(xs) - 1):
        for j in range(len(ys) - 1):
            for k in range(len(zs) - 1):
                cell[i, j, k] = len(cell) + 1
                # the first face of CalculiX is the floor, the second the top
                nodes = [number[2 * i + b, 2 * j + c, 2 * k + a] for a, b, c in CORNERS + ([] if linear else EDGES)]
                f.write("%d,%s\n" % (cell[i, j, k], ",\n".join(",".join(map(str, nodes[m:m + 10])) for m in range(0, len(nodes), 10))))
    return number, cell


def part(low, high, limits):
    """Share of low to high between the two limits."""
    return max(0.0, min(high, limits[1]) - max(low, limits[0])) / (high - low)


def snapped(points, regions, axis):
    """Grid lines, the nearest moved onto each face of a region."""
    points = list(points)
    for box, _ in regions:
        for face in box[axis]:
            if points[0] < face < points[-1]:
                points[min(range(1, len(points) - 1), key=lambda i: abs(points[i] - face))] = face
    return points


def sections(f, xs, ys, zs, cell, regions, law):
    """A material for each box ((x, x), (y, y), (z, z)), factor of the regions, the last that holds an element counting, and for the rest."""
    sets = [[] for _ in range(len(regions) + 1)]
    for (i, j, k), e in cell.items():
        inside = [n for n, (box, _) in enumerate(regions) if all(part(p[c], p[c + 1], b) > 0.5 for p, c, b in zip((xs, ys, zs), (i, j, k), box))]
        sets[inside[-1] + 1 if inside else 0].append(e)
    for n, elements in enumerate(sets):
        if elements:
            f.write("*ELSET,ELSET=PART%d\n%s\n" % (n, ",\n".join(map(str, elements))))
            f.write("*MATERIAL,NAME=SOLID%d\n%s\n" % (n, law(regions[n - 1][1] if n else 1)))
            f.write("*SOLID SECTION,ELSET=PART%d,MATERIAL=SOLID%d\n" % (n, n))


def solve(name, folder, limit):
    done = subprocess.run(["ccx", "-i", name], capture_output=True, text=True, env=dict(os.environ, OMP_NUM_THREADS="1"), cwd=folder,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit)))
    blocks, t = [], None  # (time, numbers of each line)
    for line in open(name + ".dat"):
        words = line.split()
        if "time" in line:
            t = float(words[-1])
        elif words and t is not None:
            blocks.append((t, [float(w) for w in words]))
    return blocks, done.stdout[-300:]


def tip_mesh(f, radius, edge, node0, element0, m, half, low):
    """A disc of thin stiff bricks behind the tip's surface, all its nodes moved: 2 m strips a way, m where low is 0 (a symmetric half).
    half: of a capsule's length between the centres of its ends, along z."""
    us, vs = ([k / m for k in range(n * m, m + 1)] for n in low)
    rows = [(v, half) for v in vs]
    if half:  # symmetric
        straight = math.ceil(half / edge * m)
        rows = [(0, half * k / straight) for k in range(straight)] + rows
    f.write("*NODE,NSET=TIP\n")
    n = lambda i, j, k: node0 + 1 + 2 * (i * len(rows) + j) + k
    for i, u in enumerate(us):
        for j, (v, shift) in enumerate(rows):
            x, z = edge * u * math.sqrt(1 - v * v / 2), edge * v * math.sqrt(1 - u * u / 2)  # a square onto a disc
            up = gap("sphere", radius, math.hypot(x, z))
            for k in range(2):
                f.write("%d,%.12g,%.12g,%.12g\n" % (n(i, j, k), x, 1 + up + 0.1 * k, z + shift))
    f.write("*ELEMENT,TYPE=C3D8,ELSET=RIGID\n")
    for i in range(len(us) - 1):
        for j in range(len(rows) - 1):
            lower = [n(i, j, 0), n(i, j + 1, 0), n(i + 1, j + 1, 0), n(i + 1, j, 0)]
            f.write("%d,%s\n" % (element0 + 1 + i * (len(rows) - 1) + j, ",".join(map(str, lower + [x + 1 for x in lower]))))
    f.write("*MATERIAL,NAME=STIFF\n*ELASTIC\n1000,0.3\n*SOLID SECTION,ELSET=RIGID,MATERIAL=STIFF\n*SURFACE,NAME=STIP,TYPE=ELEMENT\nRIGID,S1\n")


def around(low, high, half, near, size):
    """Grid lines from low to high, fine to half + near on either side of the tip at 0."""
    def way(end):
        points = graded(0, half, 1.5 * size, 1.5 * size) if half else [0]
        to = min(half + near, end)
        points = join(points, graded(half, to, size, size))
        return join(points, graded(to, end, size, 0.125)) if end - to > 0.3 * size else points[:-1] + [end]
    return [-x for x in reversed(way(-low))][:-1] + way(high) if low else way(high)


def press(radius, nu, depth, steps=4, fine=6, nodes=None, keep=None, limit=1800, regions=(), at=(), side=False, length=0, surface=None):
    """[(depth, force)], or raises RuntimeError. nodes: of linear elements, alike, so many nodes a side; an odd number. regions: boxes with
    x and z from the tip's axis, y from the floor, and the factor of their stiffness. at, side, length: as above. surface: a list that
    gets (depth, place, displacement along x, y, z) of the nodes of the top along x through the tip's axis."""
    a = min(math.sqrt(radius * depth) * (1.25 if depth > 0.3 * radius else 1.1), 0.9 * radius)  # the contact, or a little more
    size, near = a / fine, min(1.2 * a, 0.4)
    low = [-at[k] if k < len(at) else 0 for k in range(2)]  # of the mesh from the tip's axis; 0: symmetric
    xs, zs = (around(p, 1 + p if p else 0.5, half, near, size) for p, half in zip(low, (0, 0.5 * length)))
    ys = [1 - y for y in reversed(graded(0, 1, 0.8 * size, 0.16))]
    xs, ys, zs = snapped(xs, regions, 0), snapped(ys, regions, 1), snapped(zs, regions, 2)
    if nodes:
        xs, ys = [[i / (nodes - 1) for i in range(m)] for m in ((nodes + 1) // 2, nodes)]
        zs, size, fine = xs, xs[1], 12
    nearest = lambda points, i, half: max(0, min(abs(points[i]), abs(points[i + 1])) - half)
    with tempfile.TemporaryDirectory() as folder:
        folder = keep or folder
        name = os.path.join(folder, "block")
        with open(name + ".inp", "w") as f:
            number, cell = bricks(f, xs, ys, zs, bool(nodes))
            nset(f, "FLOOR", [q for p, q in number.items() if p[0 if side else 1] == 0])
            fixed = "*BOUNDARY\nFLOOR,1,3\nTIP,1,1\nTIP,3,3\n"
            for axis, (letter, p) in enumerate(zip("XZ", low)):
                if not p:
                    nset(f, letter + "ZERO", [q for place, q in number.items() if place[2 * axis] == 0])
                    fixed += "%sZERO,%d,%d\n" % (letter, 2 * axis + 1, 2 * axis + 1)
            sections(f, xs, ys, zs, cell, regions,
                     lambda factor: "*HYPERELASTIC,NEO HOOKE\n%.12g,%.12g" % (0.5 * factor, 3 * (1 - 2 * nu) / (1 + nu) / factor))
            tip_mesh(f, radius, min(1.3 * a, 0.98 * radius), len(number), len(cell), int(5 * fine), 0.5 * length, [-1 if p else 0 for p in low])
            f.write("*SURFACE,NAME=STOP,TYPE=ELEMENT\n")
            for (i, j, k), e in cell.items():
                if j == len(ys) - 2 and math.hypot(nearest(xs, i, 0), nearest(zs, k, 0.5 * length)) < 1.3 * a:
                    f.write("%d,S2\n" % e)
            f.write("*SURFACE INTERACTION,NAME=TOUCH\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n%g,1e-4\n" % (100.0 / size))
            f.write("*CONTACT PAIR,INTERACTION=TOUCH,TYPE=SURFACE TO SURFACE\nSTOP,STIP\n")
            line = {q: doubled(xs)[i] for (i, j, k), q in number.items() if j == 2 * len(ys) - 2 and k == 0}
            nset(f, "LINE", list(line))
            f.write(fixed)
            f.write("*STEP,NLGEOM,INC=200\n*STATIC\n%g,1,1e-4,%g\n*BOUNDARY\nTIP,2,2,%.12g\n" % (1 / steps, 1 / steps, -depth))
            f.write("*NODE PRINT,NSET=FLOOR,TOTALS=ONLY\nRF\n")
            f.write("*END STEP\n" if surface is None else "*NODE PRINT,NSET=LINE\nU\n*END STEP\n")
        found, told = solve(name, folder, limit)
        share = 2 ** low.count(0)
        curve = [(t * depth, share * v[1]) for t, v in found if len(v) == 3]
        if surface is not None:
            surface += [(t * depth, line[int(v[0])], *v[1:]) for t, v in found if len(v) == 4]
        if not curve or curve[-1][0] < 0.999 * depth:
            raise RuntimeError("ccx stopped at %s of %g: %s" % (curve[-1:] and curve[-1][0], depth, told))
        return curve


def face(nu, fine=8, limit=600, regions=(), skin=0):
    """(force pressed, force sheared, bulge at mid-face), each over the motion of the plate. regions: boxes from the cube's corner.
    skin: thickness of a layer of elements at the sides, for regions there."""
    fine = 2 * (int(fine) // 2)  # a node at mid-face
    points = [i / fine for i in range(fine + 1)]
    sides = [0, skin] + points[1:-1] + [1 - skin, 1] if skin else points
    with tempfile.TemporaryDirectory() as folder:
        name = os.path.join(folder, "face")
        with open(name + ".inp", "w") as f:
            number, cell = bricks(f, sides, points, sides)
            nset(f, "FLOOR", [q for p, q in number.items() if p[1] == 0])
            nset(f, "TOP", [q for p, q in number.items() if p[1] == 2 * fine])
            middle = len(sides) - 1
            nset(f, "MIDDLE", [number[2 * middle, fine, middle]])
            sections(f, sides, points, sides, cell, regions, lambda factor: "*ELASTIC\n%.12g,%.12g" % (2 * (1 + nu) * factor, nu))
            for pressed, sheared in ((-1, 0), (0, 1)):
                f.write("*STEP\n*STATIC\n*BOUNDARY,OP=NEW\nFLOOR,1,3\nTOP,1,1,%d\nTOP,2,2,%d\nTOP,3,3\n" % (sheared, pressed))
                f.write("*NODE PRINT,NSET=TOP,TOTALS=ONLY\nRF\n*NODE PRINT,NSET=MIDDLE\nU\n*END STEP\n")
        found, told = solve(name, folder, limit)
        if len(found) != 4:
            raise RuntimeError("ccx: " + told)
        return -found[0][1][1], found[2][1][0], found[1][1][1]


if __name__ == "__main__":
    words, options = [], {}
    arguments = iter(sys.argv[1:])
    for w in arguments:
        if w in ("--fine", "--nodes"):
            options[w[2:]] = int(next(arguments))
        elif w == "--at":
            options["at"] = [float(x) for x in next(arguments).split(",")]
        elif w == "--side":
            options["side"] = True
        elif w == "--length":
            options["length"] = float(next(arguments))
        elif w == "--keep":
            options["keep"] = next(arguments)
        else:
            words.append(w)
    if words[0] == "face":
        print("%.6g %.6g %.6g" % face(float(words[1]), **options))
    else:
        for d, force in press(*map(float, words[1:4]), int(words[4]) if len(words) > 4 else 4, **options):
            print("%.6g %.8g" % (d, force))
