"""bench_python.py: what Python adds to a tick of 1 ms. A cube of 24 mm with BENCH_NODES (11) particles a side, a quartic law
and two arms, one correction a tick, a ramp to 0.2 of the height in 200 ticks. The library tells how long each of its calls
took; the rest of what passes is Python's. A tick with a tool also makes it, sets it and reads its force.
Medians of 5 ramps.

    make python && python3 bench/bench_python.py"""
import os
import sys
import time

os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')
sys.path.append(os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), 'build', 'python'))
import numpy as np
import palpate

NODES, TICKS, RAMPS, SIZE = int(os.environ.get('BENCH_NODES', 11)), 200, 5, 0.024


def network():
    law = palpate.law('polynomial', [0.54, -2.34, 33.25, -124.03, 177.63])
    mesh = palpate.Mesh.lattice([NODES] * 3, [SIZE] * 3)
    return palpate.Network(mesh, palpate.material(law, [(0.4, 0.2), (0.2, 2.0)]))


def plate(ticks, i):
    return ticks.step(0.2 * SIZE * (i + 1) / TICKS, 1e-3, corrections=1)


def tool(ticks, i):
    depth = 0.1 * SIZE * (i + 1) / TICKS
    ticks.network.set_tools(palpate.sphere(0.2 * SIZE, [SIZE / 2, SIZE * 1.2 - depth, SIZE / 2]))
    info = ticks.step(0.0, 1e-3, corrections=1)
    ticks.network.tool_forces[0].force_N
    return info


def measure(name, tick, prepare):
    inside, outside = [], []
    for _ in range(RAMPS):
        made = network()
        prepare(made)
        ticks = made.realtime()
        for i in range(TICKS):
            start = time.perf_counter()
            info = tick(ticks, i)
            passed = time.perf_counter() - start
            inside.append(info.seconds)
            outside.append(passed - info.seconds)
    inside, outside = np.median(inside), np.median(outside)
    print(f'  {name:8} {1e3 * inside:8.4f} ms in the library, {1e6 * outside:6.1f} us around it: {outside / inside:.2%}')


print(f'{NODES} nodes a side')
measure('plate', plate, lambda made: None)
measure('tool', tool, lambda made: made.enable_tools(1))
