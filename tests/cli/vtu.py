"""vtu.py FOLDER RUN.csv [MESH.msh]: the frames of a pressed lattice of 5 x 4 x 3 nodes, or of a mesh, as meshio reads them."""
import glob
import itertools
import sys

import meshio
import numpy as np


def lattice():
    steps = [24e-3 / (n - 1) for n in (5, 4, 3)]
    places = list(itertools.product(range(5), range(4), range(3)))
    pairs = {frozenset((i, j)) for i, a in enumerate(places) for j, b in enumerate(places)
             if i != j and all(abs(p - q) <= 1 for p, q in zip(a, b))}
    return np.array(places) * steps, pairs


def tetrahedra(path):
    mesh = meshio.read(path)
    pairs = {frozenset(pair) for cell in mesh.cells_dict['tetra'] for pair in itertools.combinations(map(int, cell), 2)}
    return mesh.points, pairs


def check(mesh, rest, pairs):
    ends = mesh.cells_dict['line']
    assert {frozenset(map(int, pair)) for pair in ends} == pairs and len(ends) == len(pairs), 'another set of elements'
    moved = mesh.point_data['displacement']
    scale = np.ptp(rest, 0).max()
    assert np.allclose(mesh.points - moved, rest, rtol=0, atol=1e-8 * scale), 'other nodes'
    length = lambda x: np.linalg.norm(x[ends[:, 1]] - x[ends[:, 0]], axis=1)
    strain = length(mesh.points) / length(rest) - 1
    assert np.allclose(mesh.cell_data['strain'][0].ravel(), strain, rtol=0, atol=1e-6), 'other strains'
    return -moved[:, 1].min(), mesh.cell_data['force_N'][0]


def main(folder, run, *mesh_file):
    rest, pairs = tetrahedra(*mesh_file) if mesh_file else lattice()
    with open(run) as file:
        rows = [line.split(',') for line in file if not line.startswith('#')]
    depth_mm = np.array([row[rows[0].index('depth_mm')] for row in rows[1:]], float)
    frames = sorted(glob.glob(folder + '/*.vtu'))
    assert len(frames) > 5, frames
    if mesh_file: # in mm, and with nodes in another order
        first = meshio.read(frames[0])
        places = first.points - first.point_data['displacement']
        order = np.array([np.linalg.norm(places - 1e-3 * point, axis=1).argmin() for point in rest])
        pairs = {frozenset(int(order[node]) for node in pair) for pair in pairs}
        rest = 1e-3 * rest[np.argsort(order)]
    depths = [check(meshio.read(frame), rest, pairs) for frame in frames]
    deepest = max(depth for depth, _ in depths)
    assert abs(1e3 * deepest - depth_mm.max()) < 1e-6, deepest
    assert all(np.isfinite(force).all() for _, force in depths) and np.abs(depths[-1][1]).max() > 0


main(*sys.argv[1:])
