"""hdf5.py: read FILE.h5 FILE.csv: h5py finds what the CSV says; write: HDF5 files as other programs write them; same
FILE.csv: whether an imported recording has their numbers."""
import csv
import json
import sys

import h5py
import numpy as np

t = np.arange(0, 10, 0.01)
z = np.clip(t - 1, 0, 3)
f = 0.4 * z ** 1.5
NAMES = 'time_s', 'depth_mm', 'force_N'


def experiment(path):
    with open(path, encoding='utf-8') as file:
        lines = file.read().splitlines()
    header = dict(line[2:].split(': ', 1) for line in lines if line.startswith('#'))
    rows = list(csv.reader(line for line in lines if not line.startswith('#')))
    return header, dict(zip(rows[0], np.array(rows[1:], float).T))


def with_units(dataset, units):
    dataset.attrs['units'] = units


def read(path, text):
    header, columns = experiment(text)
    with h5py.File(path, 'r') as file:
        assert set(file) == set(columns), list(file)
        for name, values in columns.items():
            assert np.array_equal(file[name][:], values), name
        assert file['depth_mm'].attrs['units'] == 'mm' and file['temperature_C'].attrs['units'] == 'C'
        assert set(file.attrs) == set(header), list(file.attrs)
        for key, value in header.items():
            found, wanted = file.attrs[key], json.loads(value)
            assert (json.loads(found) if isinstance(wanted, (list, bool)) else found) == wanted, key


def write_others():
    with h5py.File('group.h5', 'w') as h: # units as attributes, packed, of several types, settings around it
        h.attrs['operator'] = 'N. N.'
        g = h.create_group('press/raw')
        with_units(g.create_dataset('Time', data=t * 1000, chunks=(100,), compression='gzip'), 'ms')
        with_units(g.create_dataset('Position', data=z * 1000), 'um')
        with_units(g.create_dataset('Load', data=(f * 1000).astype('>f8')), 'mN')
        g['calibration'] = [1.0, 2.0, 3.0]
        g['gain'] = 2.5
    with h5py.File('record.h5', 'w') as h: # a table of records
        h.create_dataset('log', data=np.rec.fromarrays([t, z, f], names='time,depth,force')).attrs['units'] = ['s', 'mm', 'N']
    with h5py.File('matrix.h5', 'w') as h:
        h.create_dataset('data', data=np.stack([t, z, f], 1)).attrs['columns'] = ['time (s)', 'depth (mm)', 'force (N)']
    with h5py.File('matlab.h5', 'w', userblock_size=512) as h: # transposed, after a block of MATLAB's own
        for name, values in zip(NAMES, (t, z, f)):
            h[name] = values[None, :]
        h.create_dataset('title', data=np.array([[97, 98]], 'u2')).attrs['MATLAB_class'] = np.bytes_('char')
    with h5py.File('apart.h5', 'w') as h:
        for name, values, units in ('time', t, 's'), ('stage', z, 'mm'), ('cell', f, 'N'):
            with_units(h.create_dataset(name + '/data', data=values), units)
    with h5py.File('two.h5', 'w') as h:
        for k in 1, 2:
            for name, values in zip(NAMES, (t, z, f * k / 2)):
                h[f'run{k}/{name}'] = values
    with h5py.File('text.h5', 'w') as h:
        h['words'] = 'no numbers'


def write_own():
    def own(path, columns, version=1):
        with h5py.File(path, 'w') as h:
            h.attrs.update({'palpate.experiment': version, 'specimen.height_mm': 24.0, 'specimen.kind': 'cylinder'})
            for name, values in columns.items():
                h[name] = values
    own('own.h5', dict(zip(NAMES, (t, z, f))))
    own('nan.h5', dict(zip(NAMES, (t, z, np.where(t < 5, f, np.nan)))))
    own('missing.h5', {'time_s': t, 'depth_mm': z})
    own('version.h5', dict(zip(NAMES, (t, z, f))), 2)


def same(path):
    header, columns = experiment(path)
    assert float(header['specimen.height_mm']) == 24
    for name, values in zip(NAMES, (t, z, f)):
        assert np.allclose(columns[name], values, rtol=0, atol=1e-12), (name, np.abs(columns[name] - values).max())


if sys.argv[1] == 'read':
    read(*sys.argv[2:])
elif sys.argv[1] == 'write':
    write_others()
    write_own()
else:
    same(sys.argv[2])
