"""Lumped models from recordings, what they miss, and networks that have their force."""
from ctypes import byref, c_double, c_size_t

import numpy as np

from . import c
from ._base import own
from ._objects import array, callback, numbers, raising
from .models import Model, law
from .networks import Mesh


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
        strain, = numbers(np.atleast_1d(strain))
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
    c.palp_characterize_fit(len(recordings), array(c.palp_recording, recordings), _fit_settings(law, settings), fit,
                            c.palp_error())
    return own(fit, c.palp_lumped_fit_free)


def _inputs(experiments, names):
    names = names or [f'run {i + 1}' for i in range(len(experiments))]
    if len(names) != len(experiments):
        raise ValueError('one name for each experiment')
    return array(c.palp_explain_input,
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
        made.progress = callback(told['progress'], tell, raised, None)
        made.stop = told['stop'](lambda _: bool(raised or wants_stop))
    return made


class Explanation(c.palp_explanation):
    """What the runs say that a model misses; members of c.palp_explanation. Model.of(explanation.model) is a Model."""
    __slots__ = ()


def explain(model, experiments, names=None, progress=None, candidates=None, held_out=None, **settings):
    """Finds what a model misses in experiments. candidates: ids of effects; held_out: indices of runs. settings:
    c.palp_explain_settings. progress(share) may return True to end the search. Returns an Explanation."""
    explanation, raised = Explanation(), []
    with raising(raised):
        c.palp_explain(model, len(experiments), _inputs(experiments, names),
                       _explain_settings(settings, progress, candidates, held_out, raised), explanation, c.palp_error())
        own(explanation, c.palp_explanation_free, model)
    return explanation


def _choice(least_arms, most_arms, laws, no_spline):
    return c.palp_explain_choice(least_arms=least_arms, most_arms=most_arms, n_laws=len(laws), no_spline=no_spline,
                                 law=array(c.palp_law, laws) if laws else None)


def characterize_recordings(recordings, specimen=None, least_arms=0, most_arms=c.PALP_ARMS_MAX, laws=(), no_spline=False,
                            **settings):
    """Law, arms and the spread of specimens by the likelihood of explain, as palpate characterize has them. specimen: the
    number of each recording's, from 0; None: one. The fit's mean, a c.palp_lumped_fit, has the material. Returns a
    SpecimensFit."""
    fit = SpecimensFit()
    if specimen is not None:
        specimen = np.asarray(specimen).astype(np.uintp)
        if specimen.shape != (len(recordings),):
            raise ValueError('one number of a specimen for each recording')
    c.palp_explain_recordings(len(recordings), array(c.palp_recording, recordings), specimen,
                              _explain_settings(settings, None, None, None, []),
                              _choice(least_arms, most_arms, laws, no_spline), fit, c.palp_error())
    return own(fit, c.palp_specimens_fit_free)


def characterize_likelihood(specimen, experiments, names=None, least_arms=0, most_arms=c.PALP_ARMS_MAX, laws=(),
                            no_spline=False, **settings):
    """The same of experiments. specimen: a lumped Model with height and radius."""
    fit = SpecimensFit()
    c.palp_explain_material(specimen, len(experiments), _inputs(experiments, names),
                            _explain_settings(settings, None, None, None, []),
                            _choice(least_arms, most_arms, laws, no_spline), fit, c.palp_error())
    return own(fit, c.palp_specimens_fit_free)


class Calibration(c.palp_calibration):
    """The material of a network that meets a force; members of c.palp_calibration."""
    __slots__ = ()


def _calibrate(function, settings, members, progress, *arguments):
    result, raised = Calibration(), []
    settings = settings.update(**members)
    settings.progress = callback(c.palp_calibrate_progress, progress and (lambda share, last: progress(share, last[0])), raised)
    with raising(raised):
        function(*arguments, settings, result)
        own(result, c.palp_calibration_free)
    return result


def calibrate_static(network, start, depth_m, force_N, coarse=None, progress=None, **settings):
    """Fits the relaxed network's law to a static force; start: a c.palp_material, the first guess. coarse: a smaller
    network of the same body, for a large one. settings: c.palp_static_settings. progress(share, iteration) may return
    True to stop. The network has the result's material then."""
    depth_m, force_N = numbers(depth_m, force_N)
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
        time_s, force_N = numbers(time_s, force_N)
        made.append(c.palp_target(path=path, n=len(time_s), time_s=time_s, force_N=force_N))
    return _calibrate(c.palp_calibrate_relaxation, c.palp_relaxation_settings_default(), settings, progress, network,
                      start, len(made), array(c.palp_target, made))


def press(time_s, depth_m, force_N, tool=None, relaxed=False):
    """A press to meet (c.palp_press_target): by the plate, or by a tool from where it just touches, along -y."""
    time_s, depth_m, force_N = numbers(time_s, depth_m, force_N)
    return c.palp_press_target(plate=tool is None, tool=tool or c.palp_tool(), relaxed=relaxed, n=len(time_s), time_s=time_s,
                               depth_m=depth_m, force_N=force_N)


def calibrate_presses(model, presses, mesh=None, progress=None, **settings):
    """Fits a network model to presses by plates and tools; the model has the result then. settings: c.palp_presses_settings."""
    return _calibrate(c.palp_calibrate_presses, c.palp_presses_settings_default(), settings, progress, model,
                      mesh or Mesh.of_model(model), len(presses), array(c.palp_press_target, presses))
