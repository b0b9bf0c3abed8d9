"""Recordings: experiment CSVs, and what is made ready for a fit."""
import ctypes
import json
from ctypes import POINTER, byref, c_double

import numpy as np

from . import c
from ._base import Error, own, view
from ._objects import Handle, free


class Experiment(Handle):
    """An experiment CSV: columns by name, which may be written to, and header values by key."""
    __slots__ = ()

    def __init__(self, columns, header={}):
        """From arrays: time_s, depth_mm, force_N and others; header: numbers and texts."""
        pointer = POINTER(c.palp_experiment)()
        c.palp_experiment_create(len(columns['time_s']), byref(pointer))
        super().__init__(pointer, c.palp_experiment_free)
        for name, values in columns.items():
            self[name] = values
        for key, value in header.items():
            self.set(key, value)

    @classmethod
    def read(cls, path):
        experiment, pointer = cls.__new__(cls), POINTER(c.palp_experiment)()
        c.palp_experiment_read(path, byref(pointer), c.palp_error())
        Handle.__init__(experiment, pointer, c.palp_experiment_free)
        return experiment

    def write(self, path):
        c.palp_experiment_write(self, path, c.palp_error())

    def __len__(self):
        return c.palp_experiment_rows(self)

    @property
    def columns(self):
        return [c.palp_experiment_column_name(self, i) for i in range(c.palp_experiment_column_count(self))]

    def __getitem__(self, name):
        pointer = c.palp_experiment_column(self, name)
        if not pointer:
            raise KeyError(name)
        return view(pointer, (len(self),), self._owner)

    def __setitem__(self, name, values):
        if not c.palp_experiment_column(self, name):
            c.palp_experiment_add_column(self, name)
        self[name][:] = values

    def get(self, key, default=None):
        """A header value, a number or a text."""
        number, text = c_double(), ctypes.c_char_p()
        try:
            c.palp_experiment_get_number(self, key, byref(number))
            return number.value
        except Error:
            pass
        try:
            c.palp_experiment_get_string(self, key, byref(text))
            return text.value.decode()
        except Error:
            return default

    def set(self, key, value):
        (c.palp_experiment_set_string if isinstance(value, str) else c.palp_experiment_set_number)(self, key, value)


    @property
    def header(self):
        """All header values by key, in the order of the file; texts, numbers and other JSON."""
        keys = iter(lambda: c.palp_experiment_key(self, len(found)), None)
        found = {}
        for key in keys:
            found[key] = json.loads(self._json(key))
        return found

    def _json(self, key):
        text = ctypes.c_void_p()
        c.palp_experiment_get_json(self, key, ctypes.cast(byref(text), POINTER(ctypes.c_char_p)))
        try:
            return ctypes.string_at(text.value).decode()
        finally:
            free(text)

    @classmethod
    def read_parquet(cls, path):
        """From a Parquet file: columns of numbers, and the header in the file's metadata. Needs pyarrow."""
        from pyarrow import parquet
        table = parquet.read_table(path)
        experiment = cls({name: table[name].to_numpy() for name in table.column_names})
        for key, value in (table.schema.metadata or {}).items():
            if key.startswith(b'palpate:'):
                c.palp_experiment_set_json(experiment, key[8:].decode(), value.decode())
        return experiment

    def write_parquet(self, path):
        """As Parquet; the header becomes metadata of the file, JSON texts by "palpate:" and their key. Needs pyarrow."""
        import pyarrow
        from pyarrow import parquet
        metadata = {'palpate:' + key: self._json(key) for key in self.header}
        columns = {name: np.array(self[name]) for name in self.columns}
        parquet.write_table(pyarrow.table(columns, metadata=metadata), path)


class Recording(c.palp_recording):
    """A recording made ready for a fit: contact, zero force and noise are found; members of c.palp_recording."""
    __slots__ = ()

    @classmethod
    def read(cls, path, **settings):
        """From an experiment CSV. settings: c.palp_recording_settings."""
        return cls.prepare(Experiment.read(path), str(path), **settings)

    @classmethod
    def prepare(cls, experiment, name='recording', **settings):
        recording = cls()
        c.palp_recording_prepare(experiment, name, c.palp_recording_settings_default().update(**settings), recording,
                                 c.palp_error())
        return own(recording, c.palp_recording_free)

    @classmethod
    def from_arrays(cls, time_s, depth_m, force_N, height_m, radius_m=0.0, name='recording', **settings):
        """From arrays of any tester; depth and force are positive in compression."""
        header = {'specimen.height_mm': 1e3 * height_m, **({'specimen.radius_mm': 1e3 * radius_m} if radius_m else {})}
        columns = {'time_s': time_s, 'depth_mm': 1e3 * np.asarray(depth_m), 'force_N': force_N}
        return cls.prepare(Experiment(columns, header), name, **settings)
