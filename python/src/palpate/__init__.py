"""Soft tissue: recordings, lumped models, networks and their simulation, by the C library palpate.

Lengths are in metres, forces in newtons, times in seconds. Every failed call raises palpate.Error. Arrays are NumPy
arrays; those that are attributes of an object view the library's memory and keep it alive. Settings are keyword
arguments, named as the members of the C structure that the docstring names. palpate.c has every function, structure
and constant of the library by its C name; help(palpate.c.palp_network_settings) shows the members of one."""
import ctypes
import math
from contextlib import contextmanager
from ctypes import POINTER, byref, c_double, c_int32, c_size_t

import numpy as np

from . import c
from ._base import Error, Owner, own, owner_of, view

__version__ = c.VERSION
__all__ = ['Error', 'Experiment', 'Recording', 'Model', 'Path', 'Mesh', 'Network', 'Realtime', 'LumpedFit', 'SpecimensFit',
           'Explanation', 'Calibration', 'law', 'law_force', 'material', 'effect', 'guess_law', 'characterize',
           'characterize_specimens', 'characterize_likelihood', 'select_arms', 'select_degree', 'select_law', 'explain',
           'calibrate_static', 'calibrate_relaxation', 'calibrate_presses', 'press',
           'sphere', 'capsule', 'plane', 'covariance', 'c']

_free = ctypes.CDLL(None).free
_free.argtypes = [ctypes.c_void_p]


def _numbers(*arrays):
    """Contiguous doubles, all of one length."""
    arrays = [np.ascontiguousarray(a, float) for a in arrays]
    if any(a.ndim != 1 or len(a) != len(arrays[0]) for a in arrays):
        raise ValueError('arrays must have one dimension and the same length')
    return arrays


def _array(kind, items):
    return (kind * len(items))(*items)


@contextmanager
def _raising(raised):
    """Raises what a callback raised, in place of the library's ERR_STOPPED."""
    try:
        yield
    except Error:
        if not raised:
            raise
    if raised:
        raise raised[0]


def _callback(kind, function, raised, stop=1):
    """A callback of the library that stops where function returns something true or raises."""
    def call(*arguments):
        try:
            return stop if not raised and function(*arguments[1:]) else 0
        except BaseException as error:  # raised again by _raising
            raised.append(error)
            return stop
    return kind(call) if function else kind()


class _Handle:
    """An object of the library. It is freed when neither it nor what was made of it is used any more."""
    __slots__ = ('_as_parameter_', '_owner', '__weakref__')

    def __init__(self, pointer, free, *keep):
        self._as_parameter_ = pointer
        self._owner = Owner(free, pointer, *keep)

    def close(self):
        """Gives the object up. Arrays and objects that depend on it stay valid."""
        self._owner = None
        self._as_parameter_ = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def _view(self, pointer, *shape):
        return view(pointer, shape, self._owner, writable=False)

    def _refuse_views(self):
        """For calls that move the arrays of an object."""
        if self._owner and len(self._owner.views):
            raise BufferError('arrays still view this object; delete or copy them first')


# ---- laws, materials, models ----

def law(kind, coefficients, strain=None, area_m2=0.0, strain_max=0.0):
    """A stiffness law (c.palp_law): 'polynomial', 'spline' with its knots at strain, or hyperelastic with area_m2."""
    made, kind = c.palp_law(), c.palp_law_kind(kind)
    values, = _numbers(coefficients)
    if kind == c.PALP_LAW_POLYNOMIAL:
        c.palp_law_polynomial(len(values), values, made)
    elif kind == c.PALP_LAW_SPLINE:
        c.palp_law_spline(len(values), *_numbers(strain, values), made)
    else:
        c.palp_law_hyperelastic(kind, len(values), values, area_m2, made)
    c.palp_law_limit(made, strain_max)
    return made


def law_force(law, strain):
    """Force K(|e|) e of a law at an array of strains."""
    strain, = _numbers(np.atleast_1d(strain))
    force = np.empty_like(strain)
    c.palp_law_force(law, len(strain), strain, force, None, None)
    return force


def material(law, arms=(), **members):
    """A law beside Maxwell arms (c.palp_material); an arm is (stiffness_N, viscosity_Ns) or a c.palp_arm."""
    arms = [a if isinstance(a, c.palp_arm) else c.palp_arm(stiffness_N=a[0], viscosity_Ns=a[1]) for a in arms]
    if len(arms) > c.PALP_ARMS_MAX:
        raise ValueError(f'at most {c.PALP_ARMS_MAX} arms')
    made = c.palp_material(law=law, n_arms=len(arms), arms=arms, **members)
    c.palp_material_check(made, c.palp_error())
    return made


def effect(id, **values):
    """An effect of the catalogue (c.palp_effect), its parameters by their keys and in the units of a model file."""
    made, info = c.palp_effect(), c.palp_effect_look_up(c.palp_effect_id(id)).contents
    c.palp_effect_default(id, made)
    keys = [p.key for p in info.parameter]
    for key, value in values.items():
        if key not in keys:
            raise TypeError(f'{info.id} has no {key}; it has {", ".join(keys)}')
        made.value[keys.index(key)] = value * info.parameter[keys.index(key)].unit
    c.palp_effect_check(made, c.palp_error())
    return made


def covariance(path):
    """The covariance of the parameters in a model file, or None."""
    model, pointer = Model.load(path), POINTER(c_double)()
    n = model.material.law.n + 2 * model.material.n_arms
    c.palp_model_read_covariance(path, byref(pointer), c.palp_error())
    return view(pointer, (n, n), Owner(_free, pointer)) if pointer else None


class Model(c.palp_model):
    """A lumped or network model; members are those of c.palp_model."""
    __slots__ = ()

    @classmethod
    def load(cls, path):
        model, source = cls(), c.palp_mesh_source()
        c.palp_model_read(path, model, source, c.palp_error())
        model._keep = {'mesh': source}
        return model

    @classmethod
    def of(cls, struct):
        """A copy of a c.palp_model, such as that of an Explanation."""
        model = cls()
        ctypes.memmove(byref(model), byref(struct), ctypes.sizeof(struct))
        model._owner, model._keep = owner_of(struct), {'of': struct, **getattr(struct, '_keep', {})}
        return model

    @classmethod
    def lumped(cls, material, height_m, radius_m=0.0, effects=(), **members):
        return cls(kind='lumped', material=material, height_m=height_m, radius_m=radius_m, n_effects=len(effects),
                   effects=effects, **members)

    @classmethod
    def lattice(cls, material, nodes, size_m, radius_m=0.0, source={}, **members):
        """A network on a box of nodes[3] particles; source: members of c.palp_mesh_source, such as scaling."""
        given = {'kind': 'lattice', 'nodes': nodes, 'size_m': size_m, 'neighbourhood': 26, **source}
        mesh = c.palp_mesh_source(**given)
        model = cls(kind='network', material=material, height_m=size_m[1], radius_m=radius_m,
                    mesh=ctypes.pointer(mesh), **members)
        model._keep = {'mesh': mesh}
        return model

    def save(self, path):
        c.palp_model_write(self, path, c.palp_error())

    @property
    def json(self):
        """The model as one line of JSON."""
        text = ctypes.c_char_p()
        c.palp_model_format(self, byref(text))
        try:
            return text.value.decode()
        finally:
            _free(text)

    def make_mesh(self):
        """The mesh of a network model."""
        pointer = POINTER(c.palp_mesh)()
        c.palp_model_mesh(self, byref(pointer), c.palp_error())
        return Mesh(pointer, c.palp_mesh_free)

    def _run(self, time_s, depth_m, members, columns={}):
        time_s, depth_m, *values = _numbers(time_s, depth_m, *columns.values())
        listed = [c.palp_forward_column(name=name, value=value) for name, value in zip(columns, values)]
        run = c.palp_forward_run(n=len(time_s), time_s=time_s, depth_m=depth_m, n_columns=len(listed),
                                 column=_array(c.palp_forward_column, listed), **members)
        run._keep['columns'] = listed
        return run, np.empty(run.n)

    def force(self, time_s, depth_m, gradient=False, settings=None, columns={}, **run):
        """Force along a path of the encoder, with all effects; columns: arrays that effects read, by name; run:
        members of c.palp_forward_run. With gradient, of a lumped model, also the derivatives [parameter, sample].
        settings: c.palp_network_settings of a network."""
        run, force = self._run(time_s, depth_m, run, columns)
        if self.kind == c.PALP_MODEL_NETWORK:
            c.palp_forward_network(self, settings, run, force, c.palp_error())
            return force
        slopes = np.empty((c.palp_forward_parameter_count(self), run.n)) if gradient else None
        c.palp_forward_force(self, run, force, slopes, c.palp_error())
        return (force, slopes) if gradient else force

    def band(self, time_s, depth_m, covariance, **run):
        """Force and its standard deviation from the covariance of the parameters (palpate.covariance)."""
        run, force = self._run(time_s, depth_m, run)
        n, sd = self.material.law.n + 2 * self.material.n_arms, np.empty(run.n)
        if np.shape(covariance) != (n, n):
            raise ValueError(f'covariance must be {n} x {n}')
        c.palp_forward_band(self, run, covariance, force, sd, c.palp_error())
        return force, sd

    def tool_error(self, radius_m, depth_m):
        """What the force of a sphere is off by at this depth, by the model's own check."""
        error = c_double()
        c.palp_model_tool_error(self, radius_m, depth_m, byref(error))
        return error.value


# ---- recordings ----

class Experiment(_Handle):
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
        _Handle.__init__(experiment, pointer, c.palp_experiment_free)
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


class Path(c.palp_path):
    """The depth of a plate, or in creep its force, against time; linear between corners."""
    __slots__ = ()

    @classmethod
    def _make(cls, maker, *arguments):
        path = cls()
        maker(*arguments, path)
        return own(path, c.palp_path_free)

    @classmethod
    def corners(cls, time_s, depth_m):
        time_s, depth_m = _numbers(time_s, depth_m)
        return cls._make(c.palp_path_create, len(time_s), time_s, depth_m)

    @classmethod
    def static(cls, depth_m, rate_m_s):
        return cls._make(c.palp_path_static, depth_m, rate_m_s)

    @classmethod
    def ramp_hold(cls, depth_m, ramp_s, hold_s):
        return cls._make(c.palp_path_ramp_hold, depth_m, ramp_s, hold_s)

    @classmethod
    def cyclic(cls, depth_m, rate_m_s, cycles):
        return cls._make(c.palp_path_cyclic, depth_m, rate_m_s, cycles)

    @classmethod
    def creep(cls, force_N, ramp_s, hold_s):
        return cls._make(c.palp_path_creep, force_N, ramp_s, hold_s)

    def at(self, t):
        """Depth, or force of a creep path, at a time."""
        return c.palp_path_at(self, t)


# ---- fits ----

class LumpedFit(c.palp_lumped_fit):
    """A fitted lumped solid with intervals; members of c.palp_lumped_fit."""
    __slots__ = ()

    def force(self, recording, run=0):
        """The fit's force at the samples of a recording, which is its run of that number."""
        force = np.empty(recording.n)
        c.palp_lumped_fit_force(self, run, recording, force)
        return force

    def stiffness(self, strain):
        """K(e) and its standard deviation at an array of strains."""
        strain, = _numbers(np.atleast_1d(strain))
        stiffness, sd = np.empty_like(strain), np.empty_like(strain)
        c.palp_lumped_fit_stiffness(self, len(strain), strain, stiffness, sd)
        return stiffness, sd

    def model(self, height_m, radius_m=0.0, **members):
        """The lumped model, with the covariance of its parameters unless each run has a spring of its own."""
        model = Model.lumped(self.material, height_m, radius_m, **members)
        if self.n_parameters == self.material.law.n + 2 * self.material.n_arms and self.covariance is not None:
            model.covariance = self.covariance
        return model


class SpecimensFit(c.palp_specimens_fit):
    """A fit of several specimens: mean, own, between; members of c.palp_specimens_fit."""
    __slots__ = ()


def guess_law(recordings, n):
    """A first guess of a polynomial law of n coefficients, from a recording without a dwell if there is one."""
    for recording in recordings:
        if recording.kind == c.PALP_RECORDING_STATIC:
            guess, norm = c.palp_law(), c_double()
            c.palp_thesis_polynomial(recording, n, guess, byref(norm))
            return guess
    first = recordings[0]
    stiffness = first.force_N[first.use != 0].max() / (first.deepest_m / first.height_m)
    return law('polynomial', [stiffness] + [0.0] * (n - 1))


def _fit_settings(law, settings):
    if law is not None:
        settings = {'spring': 'law', 'law': law, **settings}
    return c.palp_characterize_settings_default().update(**settings)


def characterize(recordings, law=None, **settings):
    """Fits a lumped solid. law: its form and first guess, as from guess_law; None: a constant spring for each
    recording. settings: c.palp_characterize_settings, such as n_arms and contact. Returns a LumpedFit."""
    fit = LumpedFit()
    c.palp_characterize_fit(len(recordings), _array(c.palp_recording, recordings), _fit_settings(law, settings), fit,
                            c.palp_error())
    return own(fit, c.palp_lumped_fit_free)


def characterize_specimens(recordings, specimen, law, **settings):
    """Fits several specimens; recording r is of specimen[r], numbered from 0. Returns a SpecimensFit."""
    fit, (numbers,) = SpecimensFit(), _numbers(specimen)
    if len(numbers) != len(recordings):
        raise ValueError('one number of a specimen for each recording')
    c.palp_characterize_specimens(len(recordings), _array(c.palp_recording, recordings), numbers.astype(np.uintp),
                                  _fit_settings(law, settings), fit, c.palp_error())
    return own(fit, c.palp_specimens_fit_free)


def _select(function, recordings, law, settings, n, *choice):
    score, sd, best = np.empty(n), np.empty(n), c_size_t()
    function(len(recordings), _array(c.palp_recording, recordings), _fit_settings(law, settings), *choice, score, sd,
             byref(best), c.palp_error())
    return best.value, score, sd


def select_arms(recordings, max_arms, law=None, **settings):
    """The number of arms by cross-validation: it, the scores of 0 to max_arms, and their standard errors."""
    return _select(c.palp_characterize_select_arms, recordings, law, settings, max_arms + 1, max_arms)


def select_degree(recordings, max_degree, law, **settings):
    """The degree of the polynomial K(e), likewise."""
    return _select(c.palp_characterize_select_degree, recordings, law, settings, max_degree + 1, max_degree)


def select_law(recordings, laws, **settings):
    """The index of the law by the same evidence, likewise; the simple ones first."""
    return _select(c.palp_characterize_select_law, recordings, laws[0], settings, len(laws), len(laws),
                   _array(c.palp_law, laws))


def _inputs(experiments, names):
    names = names or [f'run {i + 1}' for i in range(len(experiments))]
    if len(names) != len(experiments):
        raise ValueError('one name for each experiment')
    return _array(c.palp_explain_input,
                  [c.palp_explain_input(experiment=e._as_parameter_, name=n) for e, n in zip(experiments, names)])


def _explain_settings(settings, progress, candidates, held_out, raised):
    made = c.palp_explain_settings_default().update(**settings)
    if candidates is not None:
        made.candidate = [c.palp_effect_id(i) in [c.palp_effect_id(e) for e in candidates]
                          for i in range(c.PALP_EFFECT_COUNT)]
    if held_out:
        made.n_held_out, made.held_out = len(held_out), np.array(held_out, np.uintp)
    wants_stop = []
    told = {name: kind for name, kind in c.palp_explain_settings._fields_}

    def tell(share):
        wants_stop[:] = [1] * bool(progress(share))
    if progress:
        made.progress = _callback(told['progress'], tell, raised, None)
        made.stop = told['stop'](lambda _: bool(raised or wants_stop))
    return made


class Explanation(c.palp_explanation):
    """What the runs say that a model misses; members of c.palp_explanation. Model.of(explanation.model) is a Model."""
    __slots__ = ()


def explain(model, experiments, names=None, progress=None, candidates=None, held_out=None, **settings):
    """Finds what a model misses in experiments. candidates: ids of effects; held_out: indices of runs. settings:
    c.palp_explain_settings. progress(share) may return True to end the search. Returns an Explanation."""
    explanation, raised = Explanation(), []
    with _raising(raised):
        c.palp_explain(model, len(experiments), _inputs(experiments, names),
                       _explain_settings(settings, progress, candidates, held_out, raised), explanation, c.palp_error())
        own(explanation, c.palp_explanation_free, model)
    return explanation


def characterize_likelihood(specimen, experiments, names=None, least_arms=0, most_arms=c.PALP_ARMS_MAX, laws=(),
                            no_spline=False, **settings):
    """Law, arms and the spread of specimens by the likelihood of explain. specimen: a lumped Model with height and
    radius. The fit's mean, a c.palp_lumped_fit, has the material. Returns a SpecimensFit."""
    fit = SpecimensFit()
    choice = c.palp_explain_choice(least_arms=least_arms, most_arms=most_arms, n_laws=len(laws), no_spline=no_spline,
                                   law=_array(c.palp_law, laws) if laws else None)
    c.palp_explain_material(specimen, len(experiments), _inputs(experiments, names),
                            _explain_settings(settings, None, None, None, []), choice, fit, c.palp_error())
    return own(fit, c.palp_specimens_fit_free)


# ---- calibration ----

class Calibration(c.palp_calibration):
    """The material of a network that meets a force; members of c.palp_calibration."""
    __slots__ = ()


def _calibrate(function, settings, members, progress, *arguments):
    result, raised = Calibration(), []
    settings = settings.update(**members)
    settings.progress = _callback(c.palp_calibrate_progress, progress and (lambda share, last: progress(share, last[0])), raised)
    with _raising(raised):
        function(*arguments, settings, result)
        own(result, c.palp_calibration_free)
    return result


def calibrate_static(network, start, depth_m, force_N, coarse=None, progress=None, **settings):
    """Fits the relaxed network's law to a static force; start: a c.palp_material, the first guess. coarse: a smaller
    network of the same body, for a large one. settings: c.palp_static_settings. progress(share, iteration) may return
    True to stop. The network has the result's material then."""
    depth_m, force_N = _numbers(depth_m, force_N)
    network._refuse_views()
    if coarse:
        coarse._refuse_views()
    function, networks = (c.palp_calibrate_two_level, (network, coarse)) if coarse else (c.palp_calibrate_static, (network,))
    return _calibrate(function, c.palp_static_settings_default(), settings, progress, *networks, start, len(depth_m),
                      depth_m, force_N)


def calibrate_relaxation(network, start, targets, progress=None, **settings):
    """Fits the network's arms to targets, each (path, time_s, force_N) with a Path from depth 0. settings:
    c.palp_relaxation_settings."""
    made = []
    network._refuse_views()
    for path, time_s, force_N in targets:
        time_s, force_N = _numbers(time_s, force_N)
        made.append(c.palp_target(path=path, n=len(time_s), time_s=time_s, force_N=force_N))
    array = _array(c.palp_target, made)
    return _calibrate(c.palp_calibrate_relaxation, c.palp_relaxation_settings_default(), settings, progress, network,
                      start, len(made), array)


def press(time_s, depth_m, force_N, tool=None, relaxed=False):
    """A press to meet (c.palp_press_target): by the plate, or by a tool from where it just touches, along -y."""
    time_s, depth_m, force_N = _numbers(time_s, depth_m, force_N)
    return c.palp_press_target(plate=tool is None, tool=tool or c.palp_tool(), relaxed=relaxed, n=len(time_s), time_s=time_s,
                               depth_m=depth_m, force_N=force_N)


def calibrate_presses(model, presses, mesh=None, progress=None, **settings):
    """Fits a network model to presses by plates and tools; the model has the result then. settings: c.palp_presses_settings."""
    return _calibrate(c.palp_calibrate_presses, c.palp_presses_settings_default(), settings, progress, model,
                      mesh or model.make_mesh(), len(presses), _array(c.palp_press_target, presses))


# ---- meshes and networks ----

class Mesh(_Handle):
    """Particles and elements; arrays are views."""
    __slots__ = ('_changeable',)

    def __init__(self, pointer, free, *keep):
        super().__init__(pointer, free, *keep)
        self._changeable = not keep

    def _change(self):
        if not self._changeable:
            raise ValueError('the mesh of a network stays as it is')

    @classmethod
    def _make(cls, maker, *arguments):
        pointer = POINTER(c.palp_mesh)()
        maker(*arguments[:-1], byref(pointer), *arguments[-1])
        return cls(pointer, c.palp_mesh_free)

    @classmethod
    def lattice(cls, nodes, size_m, neighbours=26):
        """A box of nodes[3] particles; y is the direction of compression."""
        nodes, (size_m,) = np.array(nodes, np.uintp), _numbers(size_m)
        if nodes.shape != (3,) or size_m.shape != (3,):
            raise ValueError('nodes and size_m have three numbers')
        return cls._make(c.palp_mesh_lattice, nodes, size_m, neighbours, ())

    @classmethod
    def create(cls, x_m, pairs):
        """From positions [n, 3] and pairs of nodes [m, 2]."""
        x_m, pairs = np.reshape(x_m, (-1, 3)), np.reshape(pairs, (-1, 2))
        return cls._make(c.palp_mesh_create, len(x_m), x_m, len(pairs), pairs, (c.palp_error(),))

    @classmethod
    def read_gmsh(cls, path, scale_m=1e-3, hex_diagonals=False):
        return cls._make(c.palp_mesh_read_gmsh, path, scale_m, hex_diagonals, (c.palp_error(),))

    def scale(self, scaling='continuum', area_m2=0.0):
        """Divides a solid's stiffness among the elements, once."""
        self._change()
        self._refuse_views()
        c.palp_mesh_scale(self, scaling, area_m2, c.palp_error())

    def transform(self, rotation, translation_m):
        self._change()
        rotation, translation_m = np.reshape(rotation, 9), np.reshape(translation_m, 3)
        c.palp_mesh_transform(self, rotation, translation_m)

    def add_set(self, name, nodes):
        self._change()
        c.palp_mesh_add_set(self, name, len(nodes), np.array(nodes))

    def set(self, name):
        """The nodes of a set, a copy."""
        n, nodes = c_size_t(), POINTER(c_int32)()
        c.palp_mesh_set(self, name, byref(n), byref(nodes))
        return np.array(nodes[:n.value], np.int32)

    def add_region(self, name, place):
        """place(x_m) is the part, 0 to 1, of the tissue at a place that belongs to the region."""
        self._change()
        raised = []

        def call(_, x_m):
            try:
                return 0.0 if raised else float(place(x_m[:3]))
            except BaseException as error:
                raised.append(error)
                return 0.0
        with _raising(raised):
            c.palp_mesh_add_region(self, name, c.palp_mesh_place(call), None)

    @property
    def bounds(self):
        low, high = np.empty(3), np.empty(3)
        c.palp_mesh_bounds(self, low, high)
        return low, high

    positions = property(lambda self: self._view(c.palp_mesh_positions(self), c.palp_mesh_node_count(self), 3))
    pairs = property(lambda self: self._view(c.palp_mesh_pairs(self), c.palp_mesh_element_count(self), 2))
    tetrahedra = property(lambda self: self._view(c.palp_mesh_tetrahedra(self), c.palp_mesh_tetrahedron_count(self), 4))
    triangles = property(lambda self: self._view(c.palp_mesh_triangles(self), c.palp_mesh_triangle_count(self), 3))


def sphere(radius_m, position_m, friction=0.0):
    """A tool (c.palp_tool); position_m is its centre."""
    return c.palp_tool(shape=c.PALP_TOOL_SPHERE, radius_m=radius_m, position_m=position_m, friction=friction)


def capsule(radius_m, position_m, axis, length_m, friction=0.0):
    """A cylinder with round ends from position_m along axis, a unit vector."""
    return c.palp_tool(shape=c.PALP_TOOL_CAPSULE, radius_m=radius_m, position_m=position_m, axis=axis, length_m=length_m,
                       friction=friction)


def plane(position_m, normal, friction=0.0):
    """The half space behind a plane; normal, a unit vector, points to the tissue."""
    return c.palp_tool(shape=c.PALP_TOOL_PLANE, position_m=position_m, axis=normal, friction=friction)


class Network(_Handle):
    """Particles joined by springs and dashpots. Arrays view the last committed state until the next step."""
    __slots__ = ('max_tools',)

    def __init__(self, mesh, material, supports=None, **settings):
        """supports: a list of c.palp_support; None: bottom fixed, top driven. settings: c.palp_network_settings."""
        pointer = POINTER(c.palp_network)()
        c.palp_network_create(mesh, material, *self._supports(supports, (c.palp_support * 2)()),
                              c.palp_network_settings_default().update(**settings), byref(pointer), c.palp_error())
        self._start(pointer)

    @classmethod
    def from_model(cls, model, mesh=None, supports=None, **settings):
        """The network of a network model; mesh: its own, or that one transformed."""
        network, pointer = cls.__new__(cls), POINTER(c.palp_network)()
        c.palp_network_from_model(model, mesh, *cls._supports(supports, None),
                                  c.palp_network_settings_default().update(**settings), byref(pointer), c.palp_error())
        network._start(pointer)
        return network

    def _start(self, pointer):
        self.max_tools = 0
        _Handle.__init__(self, pointer, c.palp_network_free)

    @staticmethod
    def _supports(supports, default):
        if supports is not None:
            return len(supports), _array(c.palp_support, supports)
        if default:
            c.palp_supports_default(default)
        return 2 if default else 0, default

    # ---- steps ----

    def step(self, depth_m, dt_s=math.inf):
        """To a depth of the plate within dt_s; inf: fully relaxed. Returns a c.palp_step_info."""
        info = c.palp_step_info()
        c.palp_network_step(self, depth_m, dt_s, info)
        return info

    def step_force(self, force_N, dt_s=math.inf):
        """The same with the force on the driven nodes given."""
        info = c.palp_step_info()
        c.palp_network_step_force(self, force_N, dt_s, info)
        return info

    def run(self, path, observer=None, **settings):
        """Follows a Path by settings of c.palp_run_settings: dt_s, tolerance or relaxed. Returns time, depth and
        force of each step, and a c.palp_run_info. observer(time_s, depth_m, force_N) may return True to stop."""
        rows, raised, info = [], [], c.palp_run_info()

        def observe(*row):
            rows.append(row)
            return observer and observer(*row)
        with _raising(raised):
            c.palp_network_run(self, path, c.palp_run_settings(observer=_callback(c.palp_network_observer, observe, raised),
                                                               **settings), info)
        return (*np.array(rows).reshape(-1, 3).T, info)

    def reset(self):
        c.palp_network_reset(self)

    def set_material(self, material):
        """Another material; resets. BufferError where arrays still view the network."""
        self._refuse_views()
        c.palp_network_set_material(self, material)

    def set_forces(self, nodes, force_N):
        """Forces [n, 3] on nodes from the next step on."""
        force_N = np.reshape(force_N, (len(nodes), 3))
        c.palp_network_set_forces(self, len(nodes), np.array(nodes), force_N)

    def save(self):
        """The whole state as bytes."""
        buffer = ctypes.create_string_buffer(c.palp_network_state_size(self))
        c.palp_network_save(self, buffer, len(buffer))
        return buffer.raw

    def restore(self, state):
        c.palp_network_restore(self, state, len(state))

    # ---- state ----

    depth = property(lambda self: c.palp_network_depth(self))
    time = property(lambda self: c.palp_network_time(self))
    force = property(lambda self: c.palp_network_force(self))
    strain_max = property(lambda self: c.palp_network_strain_max(self))
    positions = property(lambda self: self._view(c.palp_network_positions(self), self._nodes, 3),
                         doc='Positions [n, 3] of the last committed state.')
    velocities = property(lambda self: self._view(c.palp_network_velocities(self), self._nodes, 3))
    element_strain = property(lambda self: self._view(c.palp_network_element_strain(self), self._elements))
    _nodes = property(lambda self: c.palp_mesh_node_count(c.palp_network_mesh(self)))
    _elements = property(lambda self: c.palp_mesh_element_count(c.palp_network_mesh(self)))

    @property
    def element_force(self):
        """Forces of the elements, tension positive, a copy."""
        force = np.empty(self._elements)
        c.palp_network_element_force(self, force)
        return force

    @property
    def mesh(self):
        """The mesh at rest."""
        return Mesh(c.palp_network_mesh(self), lambda _: None, self._owner)

    @property
    def surface(self):
        """Triangles [n, 3] of the present surface, outward, a copy."""
        n, triangles = c_size_t(), POINTER(c_int32)()
        c.palp_network_surface(self, byref(n), byref(triangles))
        return np.array(triangles[:3 * n.value], np.int32).reshape(-1, 3)

    def reaction(self, name):
        """Force of the elements on the support of a node set."""
        force = np.empty(3)
        c.palp_network_reaction(self, name, force)
        return force

    # ---- tools and cuts ----

    def enable_tools(self, max_tools, max_grasped=0, **settings):
        """Prepares for tools and grasped nodes, once; resets. settings: c.palp_contact_settings."""
        c.palp_network_enable_tools(self, max_tools, max_grasped, c.palp_contact_settings_default().update(**settings))
        self.max_tools = max_tools

    def set_tools(self, *tools):
        """The tools of the next steps: sphere, capsule, plane."""
        c.palp_network_set_tools(self, len(tools), _array(c.palp_tool, tools))

    @property
    def tool_forces(self):
        """A c.palp_tool_force for each of max_tools; zeros for those that are not set."""
        forces = (c.palp_tool_force * self.max_tools)()
        c.palp_network_tool_force(self, forces)
        return list(forces)

    @property
    def contacts(self):
        """The points in contact, each a c.palp_contact."""
        n = c_size_t()
        c.palp_network_contacts(self, 0, None, byref(n))
        contacts = (c.palp_contact * n.value)()
        c.palp_network_contacts(self, n.value, contacts, byref(n))
        return list(contacts)

    def grasp(self, nodes, target_m):
        """Ties nodes to targets [n, 3] by stiff springs from the next step on."""
        target_m = np.reshape(target_m, (len(nodes), 3))
        c.palp_network_grasp(self, len(nodes), np.array(nodes), target_m)

    def release(self, nodes):
        c.palp_network_release(self, len(nodes), np.array(nodes))

    def grasp_force(self, nodes):
        """Sum of the forces of grasped nodes on the hand."""
        force = np.empty(3)
        c.palp_network_grasp_force(self, len(nodes), np.array(nodes), force)
        return force

    def enable_cutting(self):
        self._refuse_views()
        c.palp_network_enable_cutting(self)

    def cut(self, corners_m):
        """Cuts what the triangle corners_m [3, 3] crosses; returns the number of elements."""
        corners_m, n = np.reshape(corners_m, 9), c_size_t()
        c.palp_network_cut(self, corners_m, byref(n))
        return n.value

    def realtime(self, **settings):
        return Realtime(self, **settings)


class Realtime(_Handle):
    """Steps a network within a haptic tick."""
    __slots__ = ('network', '_budget')

    def __init__(self, network, **settings):
        """settings: c.palp_realtime_settings. It keeps the network."""
        pointer = POINTER(c.palp_realtime)()
        c.palp_realtime_create(network, c.palp_realtime_settings_default().update(**settings), byref(pointer))
        super().__init__(pointer, c.palp_realtime_free, network._owner)
        self.network, self._budget = network, c.palp_budget()

    def step(self, depth_m, dt_s, seconds=0.0, corrections=0, force_error=0.0):
        """One tick by a budget; all 0: to the network's tolerance. Returns a c.palp_tick_info."""
        info, budget = c.palp_tick_info(), self._budget
        budget.seconds, budget.corrections, budget.force_error = seconds, corrections, force_error
        c.palp_realtime_step(self, depth_m, dt_s, budget, info)
        return info

    energy = property(lambda self: c.palp_realtime_energy(self))

    def reset(self):
        c.palp_realtime_reset(self)

    def save(self):
        """The state of network and solver as bytes."""
        buffer = ctypes.create_string_buffer(c.palp_realtime_state_size(self))
        c.palp_realtime_save(self, buffer, len(buffer))
        return buffer.raw

    def restore(self, state):
        c.palp_realtime_restore(self, state, len(state))
