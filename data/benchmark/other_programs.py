#!/usr/bin/env python3
"""other_programs.py: forces of pyvisco and rheojax for the splits of this folder, into predictions/.

    pip install pyvisco rheojax
    data/benchmark/other_programs.py [pyvisco] [rheojax]

Both fit a relaxation modulus E(t). It is taken from the dwell of the fastest run to fit (several of one speed: their mean): force
over depth, counted from the middle of the ramp. The force of a run is the integral of E over its recorded path (Boltzmann). A split
without a dwell is left out: neither program has a law for a force that is no line over the depth.
rheojax 0.7.1 needs Python 3.12 or later, only for its type aliases: "type X = Y" may be rewritten as "X = Y".
"""
import importlib
import json
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
POINTS = 200  # of the relaxation, even over the logarithm of time


def read(path):
    rows = [line for line in path.read_text().splitlines() if line and not line.startswith('#')]
    return np.array([[float(x) for x in row.split(',')] for row in rows[1:]]).T


def dwell(run):
    """Times from the middle of the ramp, force over depth, and how long the ramp took; None without a dwell."""
    time, depth, force = run
    reached = int(np.argmax(depth >= 0.999 * depth.max()))
    began = int(np.argmax(depth > depth.min() + 0.01 * np.ptp(depth)))
    if time[-1] - time[reached] < 2 * (time[reached] - time[began]) or reached + 20 > len(time):
        return None
    middle = 0.5 * (time[began] + time[reached])
    return time[reached:] - middle, force[reached:] / depth[reached:], time[reached] - time[began]


def relaxation(runs):
    """One curve E(t) of the fastest dwells, at even logarithms of time."""
    found = [d for d in map(dwell, runs) if d]
    if not found:
        return None
    fastest = min(d[2] for d in found)
    found = [d for d in found if d[2] < 1.5 * fastest]
    at = np.geomspace(max(d[0][0] for d in found), min(d[0][-1] for d in found), POINTS)
    return at, np.mean([np.interp(at, d[0], d[1]) for d in found], axis=0)


def convolve(modulus, run):
    """Force on the recorded path, which is linear between the samples; modulus(t) for t > 0."""
    time, depth, _ = run
    rise = np.diff(np.maximum(depth, 0), prepend=0)
    middle = np.append(time[0], 0.5 * (time[1:] + time[:-1]))
    grid = np.geomspace(1e-4 * np.diff(time).min(), np.ptp(time), 2000)  # E is asked for once: it is smooth in log t
    known, force = modulus(grid), np.zeros(len(time))
    for k in np.nonzero(rise)[0]:
        force[k:] += rise[k] * np.interp(np.log(np.maximum(time[k:] - middle[k], grid[0])), np.log(grid), known)
    return force


def pyvisco(at, modulus):
    """One Prony term a decade, as pyvisco chooses them."""
    from pyvisco import load, prony
    text = 't,E_relax\ns,MPa\n' + '\n'.join(f'{t:.9g},{e:.9g}' for t, e in zip(at, modulus))
    master, _ = load.user_master(text.encode(), 'time', 20, 'E')
    master['E_relax_filt'] = master['E_relax']
    fit, _ = prony.fit(prony.discretize(master), master)
    tau, alpha = fit['df_terms']['tau_i'].values, fit['df_terms']['alpha_i'].values
    return lambda t: fit['E_0'] * prony.E_relax_norm(t, alpha, tau)


def rheojax(at, modulus):
    """At most one mode a decade; in units in which the modulus is about 1000, as the bounds of its parameters want.

    Its fractional Zener solid fits as well, but version 0.7.1 gives -4e27 for it at 75 s of mach1_later.
    """
    from rheojax.models import GeneralizedMaxwell
    model, unit = GeneralizedMaxwell(n_modes=1 + int(np.log10(at[-1] / at[0]))), 1e-3 * modulus.mean()
    model.fit(at, modulus / unit, test_mode='relaxation')
    return lambda t: unit * np.asarray(model.predict(t, test_mode='relaxation'))


def main():
    fits = {'pyvisco': pyvisco, 'rheojax': rheojax}
    for name in sys.argv[1:] or fits:
        try:
            importlib.import_module(name)
        except ImportError as error:
            print(f'{name} is not installed ({error}): left out', file=sys.stderr)
            continue
        for split in json.loads((HERE / 'benchmark.json').read_text())['splits']:
            curve = relaxation([read(HERE / path) for path in split['fit']])
            if curve is None:
                print(f'{name}: {split["name"]} has no dwell to fit: left out', file=sys.stderr)
                continue
            modulus = fits[name](*curve)
            for path in split['predict']:
                run = read(HERE / path)
                out = HERE / 'predictions' / name / split['name'] / pathlib.Path(path).name
                out.parent.mkdir(parents=True, exist_ok=True)
                rows = zip(run[0], run[1], convolve(modulus, run))
                out.write_text('# palpate.experiment: 1\ntime_s,depth_mm,force_N\n' +
                               ''.join(f'{t:.9g},{d:.6g},{f:.6g}\n' for t, d, f in rows))


if __name__ == '__main__':
    main()
