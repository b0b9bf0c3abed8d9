"""From the recordings of a tester to a soft body under a sphere. Run it as a whole, or cell by cell.

    make python && python3 python/example.py [FOLDER]      from the repository; writes to FOLDER (default: .)"""
# %% The package: installed by pip, or what `make python` has put into build/python.
import os
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.append(os.path.join(ROOT, 'build', 'python'))
OUT = sys.argv[1] if len(sys.argv) > 1 else '.'

import numpy as np
import palpate
from palpate import c

# %% Recordings: two silicone cylinders of EcoFlex 00-10, 50 mm across and 30 mm high (data/measured/README.md).
# Any file that NumPy reads will do. Here are the columns time, compression and load after eight lines of header.
HEIGHT, RADIUS, DEEPEST = 0.030, 0.025, 0.009


def read(name):
    text = open(os.path.join(ROOT, 'data/measured/ecoflex', name), encoding='latin-1').read().replace('"', '')
    rows = [line.split(',')[:3] for line in text.split('\n')]
    t, depth_mm, force = np.array([row for row in rows if is_number(row)], float).T
    part = 1e-3 * depth_mm <= DEEPEST
    return palpate.Recording.from_arrays(t[part], 1e-3 * depth_mm[part], force[part], HEIGHT, RADIUS, name)


def is_number(row):
    try:
        return len([float(cell) for cell in row]) == 3
    except ValueError:
        return False


recordings = [read('EF10_0T_A2.csv'), read('EF10_0T_B2.csv')]
for recording in recordings:
    print(f'{recording.name}: {recording.n} samples to {1e3 * recording.deepest_m:.1f} mm, {recording.kind}, '
          f'contact at {1e3 * recording.contact_m:.2f} mm, noise {1e3 * recording.noise_N:.1f} mN')

# %% Characterize: one stiffness law K(e) for both, a spline of five knots; the force is K(e) e.
rough = palpate.guess_law(recordings, 1).coefficients[0]
knots = np.linspace(0, DEEPEST / HEIGHT, 5)
fit = palpate.characterize(recordings, law=palpate.law('spline', np.full(5, rough), knots), n_arms=0)
for estimate in fit.estimate:
    print(f'{estimate.name}: {estimate.value:.1f} {estimate.unit} ({estimate.low:.1f} to {estimate.high:.1f})')
lumped = fit.model(HEIGHT, RADIUS)

# %% Calibrate: a box of 7 x 7 x 7 particles with the specimen's height and area gets the same force under a plate.
side = np.sqrt(np.pi) * RADIUS
model = palpate.Model.lattice(lumped.material, [7, 7, 7], [side, HEIGHT, side], source={'scaling': 'continuum'})
depth = np.linspace(0, DEEPEST, 19)[1:]
force = lumped.force(np.arange(1.0, 19.0), depth)
calibration = palpate.calibrate_static(palpate.Network.from_model(model), lumped.material, depth, force)
print(f'network under the plate: off by {np.abs(calibration.force_N - force).max() / force.max():.2%} of the peak force')
model.material = calibration.material
model.save(os.path.join(OUT, 'example_network.json'))

# %% Simulate: a sphere of 8 mm goes 4 mm into the middle of the top in 0.4 s, in ticks of 1 ms.
soft = palpate.Network.from_model(model, supports=[c.palp_support(set='bottom', axis=['fixed'] * 3)])
soft.enable_tools(1)
ticks = soft.realtime()
felt = []
for i in range(401):
    pressed = 0.004 * i / 400
    soft.set_tools(palpate.sphere(0.008, [side / 2, HEIGHT + 0.008 - pressed, side / 2], friction=0.3))
    info = ticks.step(0.0, 1e-3, corrections=2)
    felt.append((1e3 * pressed, soft.tool_forces[0].force_N[1], 1e3 * info.seconds))
felt = np.array(felt)
print(f'at {felt[-1, 0]:.1f} mm the sphere feels {felt[-1, 1]:.3f} N in {len(soft.contacts)} contacts; '
      f'a tick takes {np.median(felt[:, 2]):.2f} ms')

# %% Draw, or write the numbers where there is no matplotlib.
try:
    import matplotlib
    matplotlib.use('Agg' if 'ipykernel' not in sys.modules else matplotlib.get_backend())
    import matplotlib.pyplot as plt
except ImportError:
    np.savetxt(os.path.join(OUT, 'example.csv'), felt, fmt='%.6g', delimiter=',', header='depth_mm,force_N,tick_ms', comments='')
    print('example.csv written; with matplotlib it is a picture')
else:
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4))
    for recording in recordings:
        left.plot(1e3 * recording.depth_m, recording.force_N, '.', ms=2, label=recording.name)
    left.plot(1e3 * depth, force, label='lumped model')
    left.plot(1e3 * depth, calibration.force_N, '--', label='network')
    left.set(xlabel='depth of the plate, mm', ylabel='force, N')
    left.legend()
    right.plot(felt[:, 0], felt[:, 1])
    right.set(xlabel='depth of the sphere, mm', ylabel='force, N')
    figure.tight_layout()
    figure.savefig(os.path.join(OUT, 'example.png'))
    print('example.png written')
