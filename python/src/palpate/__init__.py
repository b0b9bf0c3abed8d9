"""Soft tissue: recordings, lumped models, networks and their simulation, by the C library palpate.

Lengths are in metres, forces in newtons, times in seconds. Every failed call raises palpate.Error. Arrays are NumPy
arrays; those that are attributes of an object view the library's memory and keep it alive. Settings are keyword
arguments, named as the members of the C structure that the docstring names. palpate.c has every function, structure
and constant of the library by its C name; help(palpate.c.palp_network_settings) shows the members of one."""
from . import c
from ._base import Error
from .fits import (Calibration, Explanation, LumpedFit, SpecimensFit, calibrate_presses, calibrate_relaxation, calibrate_static,
                   characterize, characterize_likelihood, characterize_recordings, explain, guess_law, press)
from .models import Model, Path, covariance, effect, law, law_force, material
from .networks import Hull, Mesh, Network, Realtime, capsule, hull, plane, sphere
from .recordings import Experiment, Recording

__version__ = c.VERSION
__all__ = ['c', 'Error', 'Calibration', 'Explanation', 'LumpedFit', 'SpecimensFit', 'calibrate_presses',
           'calibrate_relaxation', 'calibrate_static', 'characterize', 'characterize_likelihood', 'characterize_recordings',
           'explain', 'guess_law', 'press', 'Model', 'Path', 'covariance', 'effect', 'law', 'law_force', 'material', 'Hull',
           'Mesh', 'Network', 'Realtime', 'capsule', 'hull', 'plane', 'sphere', 'Experiment', 'Recording']
