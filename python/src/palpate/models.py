"""Laws, materials, models and the paths that press them."""
import ctypes
from ctypes import POINTER, byref, c_double

import numpy as np

from . import c
from ._base import Owner, own, owner_of, view
from ._objects import array, free, numbers


def law(kind, coefficients, strain=None, area_m2=0.0, strain_max=0.0):
    """A stiffness law (c.palp_law): 'polynomial', 'spline' with its knots at strain, or hyperelastic with area_m2."""
    made, kind = c.palp_law(), c.palp_law_kind(kind)
    values, = numbers(coefficients)
    if kind == c.PALP_LAW_POLYNOMIAL:
        c.palp_law_polynomial(len(values), values, made)
    elif kind == c.PALP_LAW_SPLINE:
        c.palp_law_spline(len(values), *numbers(strain, values), made)
    else:
        c.palp_law_hyperelastic(kind, len(values), values, area_m2, made)
    c.palp_law_limit(made, strain_max)
    return made


def law_force(law, strain):
    """Force K(|e|) e of a law at an array of strains."""
    strain, = numbers(np.atleast_1d(strain))
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
    return view(pointer, (n, n), Owner(free, pointer)) if pointer else None


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
            free(text)

    def _run(self, time_s, depth_m, members, columns={}):
        time_s, depth_m, *values = numbers(time_s, depth_m, *columns.values())
        listed = [c.palp_forward_column(name=name, value=value) for name, value in zip(columns, values)]
        run = c.palp_forward_run(n=len(time_s), time_s=time_s, depth_m=depth_m, n_columns=len(listed),
                                 column=array(c.palp_forward_column, listed), **members)
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
        time_s, depth_m = numbers(time_s, depth_m)
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
