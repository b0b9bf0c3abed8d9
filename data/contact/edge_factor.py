#!/usr/bin/env python3
"""edge_factor.py: the factor on the stiffness of cells at an edge between a bonded face and a free one (lib/network/network_edges.c).
A strip between bonded plates, in plane strain, is pressed as a lattice of springs and cells scaled as a solid (doc/numerics.md), and as a
solid of quadratic elements, small towards the edges. The factor makes both forces equal. usage: edge_factor.py: by Poisson's ratio,
number of cells, and length of a cell along the plate over that across; edge_factor.py cube: the force of a bonded cube over that of a bar
of its modulus, of the solid and of lattices. Needs numpy and scipy; 20 s, or two minutes with cube."""
import itertools
import sys

import numpy as np
import scipy.optimize
import scipy.sparse as sparse
import scipy.sparse.linalg as linalg

CORNER = np.array([[c >> k & 1 for k in range(3)] for c in range(8)])


def factors(h):
    """Of a box's pairs by the axes along which they go, as in lib/mesh/mesh_scale_cells.c; springs of modulus 1."""
    square, at0, slope = h ** 2, np.zeros(8), np.zeros(8)
    body = square.sum() ** 1.5
    for k in range(3):
        a, b, c = square[k], square[(k + 1) % 3], square[(k + 2) % 3]
        at0[1 << k] = 0.4 * h.prod() * (3 - a / b - a / c) / np.sqrt(a)
        slope[1 << k] = 4 * a ** 1.5 / body
        at0[7 ^ 1 << k] = 0.4 * h.prod() * (b + c) ** 1.5 / (2 * b * c)
        slope[7 ^ 1 << k] = -2 * (b + c) ** 1.5 / body
    slope[7] = 1
    meet = [(at0[7 ^ f] - at0[e]) / (slope[e] - slope[7 ^ f]) for e in (1, 2, 4) for f in (1, 2, 4)]
    return (at0 + slope * max(meet, key=lambda x: (at0 + slope * x)[1:7].min())) / np.array([1, 4, 4, 2, 4, 2, 2, 1])


def cell(h, poisson):
    """Stiffness of a cell, 24 x 24, over that of the solid's modulus."""
    matrix, share = np.zeros((8, 3, 8, 3)), factors(h)
    for a, b in itertools.combinations(range(8), 2):
        d = (CORNER[b] - CORNER[a]) * h
        spring = share[a ^ b] * np.outer(d, d) / np.linalg.norm(d) ** 3
        for i, j in ((a, b), (b, a)):
            matrix[i, :, i] += spring
            matrix[i, :, j] -= spring
    grow = ((CORNER - 0.5) * h.prod() / (2 * h)).ravel()
    modulus = 0.4 * (4 * poisson - 1) / (1 - 2 * poisson)
    return (matrix.reshape(24, 24) + modulus / h.prod() * np.outer(grow, grow)) / (0.8 * (1 + poisson))


def press(parts, index, held, driven):
    """Force of the axes driven by 1 against it. parts: matrix of each element, index: its axes."""
    n, m = index.max() + 1, index.shape[1]
    matrix = sparse.csc_matrix((np.ravel(parts), (np.repeat(index, m, axis=1).ravel(), np.tile(index, (1, m)).ravel())), shape=(n, n))
    move, free = np.zeros(n), np.ones(n, bool)
    free[held] = free[driven] = False
    move[driven] = 1
    pull = matrix @ move
    move[free] = -linalg.spsolve(matrix[free][:, free], pull[free])
    return (matrix @ move)[driven].sum()


def grid(shape):
    """Nodes of a grid, and the axes of each element's corners (x lowest), for elements of the given order and nodes a side."""
    return np.arange(np.prod(shape)).reshape(shape)


def axes(id, order, dims):
    out = []
    for at in itertools.product(*(range(0, s - 1, order) for s in id.shape)):
        block = id[tuple(slice(a, a + order + 1) for a in at)].ravel()
        out.append((dims * block[:, None] + np.arange(dims)).ravel())
    return np.array(out)


def lattice(cells, poisson, factor, dims):
    """Force over height 1 and section 1 of a bonded block of so many cells along each axis (z: a strip of one cell)."""
    h = 1 / np.array(list(cells) + [cells[0]] * (3 - len(cells)), float)
    whole = cell(h, poisson)
    if dims == 2:  # both corners along z move alike
        fold = np.array([[[float(c & 3 == p and k == q) for q in range(2)] for p in range(4)] for c in range(8) for k in range(3)]).reshape(24, 8)
        whole = fold.T @ whole @ fold / h[2]
    id = grid(tuple(n + 1 for n in cells[::-1]))  # z, y, x
    index = axes(id, 1, dims)
    at = np.array(list(itertools.product(*(range(n) for n in cells[::-1]))))  # of each cell
    y, edge = at[:, dims - 2], np.zeros(len(at), bool)
    for axis in range(dims):
        if axis != dims - 2:
            edge |= (at[:, axis] == 0) | (at[:, axis] == cells[::-1][axis] - 1)
    edge &= (y == 0) | (y == cells[1] - 1)
    parts = np.where(edge, factor, 1.0)[:, None, None] * whole
    low, high = (np.take(id, i, axis=dims - 2).ravel() for i in (0, -1))
    held = np.concatenate([dims * n + k for n in (low, high) for k in range(dims) if not (n is high and k == 1)])
    return press(parts, index, held, dims * high + 1)


def solid(poisson, n, dims):
    """The same of the solid: an eighth (a quarter) of it by n quadratic elements a side, the last smallest."""
    lame, shear = poisson / ((1 + poisson) * (1 - 2 * poisson)), 0.5 / (1 + poisson)
    edge = 0.5 * (1 - (1 - np.linspace(0, 1, n + 1)) ** 3)
    at, weight = np.array([-np.sqrt(0.6), 0, np.sqrt(0.6)]), np.array([5, 8, 5]) / 9
    value = np.array([at * (at - 1) / 2, 1 - at ** 2, at * (at + 1) / 2])
    slope = np.array([at - 0.5, -2 * at, at + 0.5])
    one = {(i, j): (slope if i else value) * weight @ (slope if j else value).T for i in (0, 1) for j in (0, 1)}
    names = "abc"[:dims], "def"[:dims]
    parts = []
    for place in itertools.product(range(n), repeat=dims):  # z, y, x
        half = [(edge[p + 1] - edge[p]) / 2 for p in place]
        matrix = np.zeros((3 ** dims, dims, 3 ** dims, dims))
        grad = {}
        for j, l in itertools.product(range(dims), repeat=2):
            line = []
            for axis in range(dims):
                of = dims - 1 - axis
                line.append(one[int(of == j), int(of == l)] * half[axis] ** (1 - (of == j) - (of == l)))
            rule = ",".join(a + b for a, b in zip(*names)) + "->" + "".join(names)
            grad[j, l] = np.einsum(rule, *line).reshape(3 ** dims, 3 ** dims)
        for i, k in itertools.product(range(dims), repeat=2):
            matrix[:, i, :, k] += lame * grad[i, k] + shear * grad[k, i]
            if i == k:
                matrix[:, i, :, k] += shear * sum(grad[j, j] for j in range(dims))
        parts.append(matrix.reshape(dims * 3 ** dims, -1))
    id = grid((2 * n + 1,) * dims)
    index = axes(id, 2, dims)
    high = np.take(id, -1, axis=dims - 2).ravel()
    held = [dims * np.take(id, 0, axis=dims - 1 - k).ravel() + k for k in range(dims)]
    held += [dims * high + k for k in range(dims) if k != 1]
    return press(np.array(parts), index, np.concatenate(held), dims * high + 1) * 2 ** (dims - 2)


def by_formula(poisson, ratio=1.0):
    return 1 - (0.4 - 0.478 * np.sqrt(1 - 2 * poisson)) * ratio ** (-2 / 3)


def main():
    if sys.argv[1:] == ["cube"]:
        for poisson in (0.25001, 0.3, 0.45, 0.49):
            whole = solid(poisson, 8, 3)
            line = " ".join("%.3f %.3f " % tuple(lattice((n,) * 3, poisson, f, 3) / whole for f in (1.0, by_formula(poisson))) for n in (4, 6, 10))
            print("ratio %.2f: solid %.4f; over it without and with the factor, 5, 7 and 11 nodes: %s" % (poisson, whole, line))
        return
    shapes = [(6, 6), (10, 10), (16, 16), (24, 24), (24, 16), (16, 24)]
    print("ratio  cells along, across: factor, formula")
    for poisson in (0.25001, 0.3, 0.35, 0.4, 0.45, 0.48, 0.49, 0.495):
        whole = solid(poisson, 30, 2)
        for n in shapes:
            factor = scipy.optimize.brentq(lambda f: lattice(n, poisson, f, 2) - whole, 0.0, 1.5, xtol=1e-4)
            print("%.3f  %d, %d: %.3f, %.3f" % (poisson, *n, factor, by_formula(poisson, n[1] / n[0])))


if __name__ == "__main__":
    main()
