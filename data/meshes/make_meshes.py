#!/usr/bin/env python3
"""make_meshes.py: writes cylinder_tetra.msh, box_hexa.msh and box_tetra.msh, Gmsh MSH 4.1 ASCII, lengths in mm.

Standard library only:  python3 data/meshes/make_meshes.py [FOLDER]
"""
import math
import os
import sys


def write(path, points, bottom, top, face_type, faces, cell_type, cells):
    """points: [(x, y, z)]; bottom, top: sets of point numbers; faces: (bottom, top) lists; numbers from 0.
    Surface 1 is the bottom, surface 2 the top, volume 1 the rest: so are the blocks and the groups."""
    low = [min(p[axis] for p in points) for axis in range(3)]
    high = [max(p[axis] for p in points) for axis in range(3)]
    inner = [i for i in range(len(points)) if i not in bottom and i not in top]
    blocks = [(2, 1, sorted(bottom)), (2, 2, sorted(top)), (3, 1, inner)]
    groups = [(2, 1, "bottom"), (2, 2, "top"), (3, 3, "specimen")]
    out = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(groups))]
    out += ['%d %d "%s"' % group for group in groups]
    out += ["$EndPhysicalNames", "$Entities", "0 0 2 1"]
    for surface, y in ((1, low[1]), (2, high[1])):
        out.append("%d %g %g %g %g %g %g 1 %d 0" % (surface, low[0], y, low[2], high[0], y, high[2], surface))
    out.append("1 %g %g %g %g %g %g 1 3 2 1 2" % (*low, *high))
    out += ["$EndEntities", "$Nodes", "%d %d 1 %d" % (len(blocks), len(points), len(points))]
    for dim, entity, nodes in blocks:
        out.append("%d %d 0 %d" % (dim, entity, len(nodes)))
        out += [str(i + 1) for i in nodes]
        out += [" ".join("%.12g" % (round(x, 9) + 0.0) for x in points[i]) for i in nodes]
    n = len(faces[0]) + len(faces[1]) + len(cells)
    out += ["$EndNodes", "$Elements", "3 %d 1 %d" % (n, n)]
    tag = 0
    for dim, entity, kind, elements in ((2, 1, face_type, faces[0]), (2, 2, face_type, faces[1]),
                                        (3, 1, cell_type, cells)):
        out.append("%d %d %d %d" % (dim, entity, kind, len(elements)))
        for element in elements:
            tag += 1
            out.append(" ".join(str(i) for i in [tag] + [i + 1 for i in element]))
    out.append("$EndElements")
    with open(path, "w", encoding="ascii", newline="\n") as file:
        file.write("\n".join(out) + "\n")
    print("%s: %d nodes, %d cells" % (path, len(points), len(cells)))


def disc(rings):
    """Points of a disc of radius 1, ring k of 6 k points, and its triangles (counter-clockwise)."""
    points, first = [(0.0, 0.0)], [0]
    for k in range(1, rings + 1):
        first.append(len(points))
        for j in range(6 * k):
            angle = 2 * math.pi * j / (6 * k)
            points.append((k / rings * math.cos(angle), k / rings * math.sin(angle)))
    triangles = []
    for k in range(1, rings + 1):
        def ring(r, j):
            return first[r] + (j % (6 * r) if r else 0)
        for sector in range(6):
            for j in range(k):
                outer = sector * k + j
                inner = sector * (k - 1) + j
                triangles.append((ring(k - 1, inner), ring(k, outer), ring(k, outer + 1)))
                if j < k - 1:
                    triangles.append((ring(k - 1, inner), ring(k, outer + 1), ring(k - 1, inner + 1)))
    return points, triangles


def cylinder(radius, height, rings, layers):
    """Prisms, each cut into three tetrahedra; the diagonal of a side starts at the lower of its
    numbers in the disc, so that neighbours cut their common side alike."""
    flat, triangles = disc(rings)
    n = len(flat)
    points = [(radius * x, height * layer / layers, -radius * z)
              for layer in range(layers + 1) for x, z in flat]
    cells = []
    for layer in range(layers):
        for triangle in triangles:
            a, b, c = sorted(triangle)
            low, high = layer * n, (layer + 1) * n
            cells += [(low + a, low + b, low + c, high + c), (low + a, low + b, high + b, high + c),
                      (low + a, high + a, high + b, high + c)]
    cells = [positive(points, cell) for cell in cells]
    bottom, top = set(range(n)), set(range(layers * n, (layers + 1) * n))
    faces = ([(a, c, b) for a, b, c in triangles], [tuple(layers * n + i for i in t) for t in triangles])
    return points, bottom, top, 2, faces, 4, cells


def positive(points, cell):
    """The tetrahedron with its corners in the order that gives it a positive volume."""
    a, b, c, d = (points[i] for i in cell)
    u, v, w = ([q - p for p, q in zip(a, other)] for other in (b, c, d))
    volume = sum(u[i] * (v[(i + 1) % 3] * w[(i + 2) % 3] - v[(i + 2) % 3] * w[(i + 1) % 3]) for i in range(3))
    return cell if volume > 0 else (cell[0], cell[2], cell[1], cell[3])


def box(size, n):
    """n x n x n hexahedra in a cube."""
    def at(i, j, k):
        return (i * (n + 1) + j) * (n + 1) + k
    points = [(size * i / n, size * j / n, size * k / n)
              for i in range(n + 1) for j in range(n + 1) for k in range(n + 1)]
    cells = [tuple(at(i + di, j + dj, k + dk) for dk in (0, 1) for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)))
             for i in range(n) for j in range(n) for k in range(n)]
    bottom = {at(i, 0, k) for i in range(n + 1) for k in range(n + 1)}
    top = {at(i, n, k) for i in range(n + 1) for k in range(n + 1)}
    squares = [(i, k) for i in range(n) for k in range(n)]
    faces = ([(at(i, 0, k), at(i + 1, 0, k), at(i + 1, 0, k + 1), at(i, 0, k + 1)) for i, k in squares],
             [(at(i, n, k), at(i, n, k + 1), at(i + 1, n, k + 1), at(i + 1, n, k)) for i, k in squares])
    return points, bottom, top, 3, faces, 5, cells


def split(points, bottom, top, face_type, faces, cell_type, cells):
    """Each hexahedron cut into six tetrahedra around the diagonal from its lowest to its highest corner
    (Kuhn), each square into two triangles along the diagonal that they leave in it."""
    tetrahedra, triangles = [], ([], [])
    for a, b, c, d, e, f, g, h in cells: # a b c d: one side, e f g h: opposite; a lowest, g highest
        tetrahedra += [positive(points, (a, g, *pair))
                       for pair in ((b, c), (c, d), (d, h), (h, e), (e, f), (f, b))]
    for squares, out in zip(faces, triangles):
        for square in squares:
            at = square.index(min(square))
            turn = square[at:] + square[:at]
            out += [(turn[0], turn[1], turn[2]), (turn[0], turn[2], turn[3])]
    return points, bottom, top, 2, triangles, 4, tetrahedra


if __name__ == "__main__":
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(os.path.abspath(__file__))
    write(os.path.join(folder, "cylinder_tetra.msh"), *cylinder(12.0, 24.0, 3, 6))
    write(os.path.join(folder, "box_hexa.msh"), *box(24.0, 4))
    write(os.path.join(folder, "box_tetra.msh"), *split(*box(24.0, 4)))
