"""fmu.py: FMPy validates and runs lumped.fmu, network.fmu and box.fmu; their forces against recordings of palpate simulate."""
import ctypes
import shutil

import fmpy
import numpy as np
from fmpy.fmi3 import FMU3Slave, fmi3LogMessageCallback
from fmpy.validation import validate_fmu

MODELS = 'lumped', 'network', 'box'


def run(path):
    with open(path) as file:
        rows = [line.split(',') for line in file if not line.startswith('#')]
    t, depth_mm, force = np.array(rows[1:], float).T[:3]
    return t, 1e-3 * depth_mm, force


class Instance:
    """An instance that is stepped by hand; messages are kept."""

    def __init__(self, fmu, token=None):
        self.description = fmpy.read_model_description(fmu + '.fmu')
        self.folder = fmpy.extract(fmu + '.fmu')
        self.vr = {v.name: v.valueReference for v in self.description.modelVariables}
        self.messages = []
        self.slave = FMU3Slave(guid=token or self.description.guid, unzipDirectory=self.folder,
                               modelIdentifier=self.description.coSimulation.modelIdentifier, instanceName='one')
        self.log = fmi3LogMessageCallback(lambda environment, status, category, message: self.messages.append(message.decode()))
        self.slave.instantiate(loggingOn=True, logMessage=self.log)

    def start(self, **values):
        self.set(**values)
        self.slave.enterInitializationMode(startTime=0)
        self.slave.exitInitializationMode()

    def set(self, **values):
        self.slave.setFloat64([self.vr[name] for name in values], list(values.values()))

    def get(self, name):
        return self.slave.getFloat64([self.vr[name]])[0]

    def follow(self, t, place, inputs):
        """Forces at t; place[i] of the inputs at t[i], with straight lines between."""
        forces = [self.get('force')]
        for i in range(len(t) - 1):
            rate = (place[i + 1] - place[i]) / (t[i + 1] - t[i])
            self.set(**{inputs[0]: place[i], inputs[1]: rate})
            self.slave.doStep(t[i], t[i + 1] - t[i])
            forces.append(self.get('force'))
        return np.array(forces)

    def close(self):
        self.slave.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


def validated():
    for name in MODELS:
        problems = validate_fmu(name + '.fmu')
        assert not problems, (name, problems)


def forces(name, recording, tolerance):
    t, depth, force = run(recording + '.csv')
    fmu = Instance(name)
    fmu.start(depth=depth[0])
    found = fmu.follow(t, depth, ('depth', 'depth_rate'))
    worst = np.abs(found - force).max() / np.abs(force).max()
    assert worst <= tolerance, (recording, worst)
    print(f'{recording}: largest difference {worst:.2g} of the largest force, {force.max():.4g} N')
    fmu.close()


def sphere(tolerance):
    t, depth, force = run('sphere.csv')
    fmu = Instance('box')
    top, radius = fmu.get('tool_y'), 8e-3
    fmu.start(tip_radius=radius, tool_y=top + radius)
    found = fmu.follow(t, top + radius - depth, ('tool_y', 'tool_rate_y'))
    worst = np.abs(found - force).max() / force.max()
    assert worst <= tolerance, worst
    sideways = np.hypot(fmu.get('tool_force_x'), fmu.get('tool_force_z'))
    assert sideways < 0.05 * force.max() and fmu.get('tool_force_y') == found[-1] > 0
    print(f'sphere: largest difference {worst:.2g} of the largest force, {force.max():.4g} N')
    fmu.close()


def by_importer():
    """FMPy's own loop, with the inputs as a table, and steps that are divided."""
    t, depth, force = run('network.csv')
    rate = np.append(np.diff(depth) / np.diff(t), 0)
    table = np.array(list(zip(t, depth, rate)), [('time', float), ('depth', float), ('depth_rate', float)])
    result = fmpy.simulate_fmu('network.fmu', start_time=0, stop_time=t[-1], output_interval=t[1] - t[0], input=table,
                               output=['force'], start_values={'max_step': 0.4 * (t[1] - t[0])})
    worst = np.abs(np.interp(t, result['time'], result['force']) - force).max() / force.max()
    assert worst < 1e-4, worst


def states(name):
    t, depth, _ = run(name + '.csv')
    half = len(t) // 2
    fmu, inputs = Instance(name), ('depth', 'depth_rate')
    fmu.start(depth=depth[0])
    fmu.follow(t[:half], depth[:half], inputs)
    state = fmu.slave.getFMUState()
    packed = fmu.slave.serializeFMUState(state)
    wanted = fmu.follow(t[half - 1:], depth[half - 1:], inputs)
    again = []
    fmu.slave.setFMUState(state)
    again.append(fmu.follow(t[half - 1:], depth[half - 1:], inputs))
    other = Instance(name) # a new instance goes on from the bytes
    other.start(depth=0.0)
    unpacked = other.slave.deserializeFMUState(packed)
    other.slave.setFMUState(unpacked)
    again.append(other.follow(t[half - 1:], depth[half - 1:], inputs))
    fmu.slave.reset()
    fmu.start(depth=depth[0])
    fmu.follow(t[:half], depth[:half], inputs)
    again.append(fmu.follow(t[half - 1:], depth[half - 1:], inputs))
    for found in again:
        assert np.abs(found - wanted).max() <= 1e-9 * np.abs(wanted).max(), (name, np.abs(found - wanted).max())
    fails(lambda: other.slave.deserializeFMUState(packed[:-1] + bytes([packed[-1] ^ 1])), other, 'no saved state')
    fmu.slave.freeFMUState(state)
    other.slave.freeFMUState(unpacked)
    fmu.close()
    other.close()


def fails(call, fmu, words):
    before = len(fmu.messages)
    try:
        call()
    except Exception:
        assert len(fmu.messages) == before + 1 and words in fmu.messages[-1], fmu.messages
    else:
        raise AssertionError('no error: ' + words)


def errors():
    fmu = Instance('network')
    fails(lambda: fmu.set(force=1.0), fmu, 'is no input')
    fails(lambda: fmu.set(depth=float('nan')), fmu, 'finite')
    fails(lambda: fmu.set(tip_radius=-1.0), fmu, '0 or more')
    fails(lambda: fmu.slave.getFloat64([99]), fmu, 'no variable 99')
    fails(lambda: fmu.slave.doStep(0, 0.1), fmu, 'not allowed in this state')
    fmu.start()
    fails(lambda: fmu.set(max_step=0.1), fmu, 'after the initialization')
    fmu.set(depth=30e-3) # through the ground of 24 mm
    fails(lambda: fmu.slave.doStep(0, 0.1), fmu, 'does not end below the height of 0.024 m')
    fmu.set(depth=1e-3)
    fmu.slave.doStep(0, 0.1) # it goes on from where it was
    assert fmu.get('force') > 0
    fmu.close()
    try:
        Instance('network', 'another')
    except Exception:
        pass
    else:
        raise AssertionError('another token is taken')


validated()
forces('lumped', 'lumped', 1e-12)
forces('lumped', 'cycles', 1e-5) # the moment at which the plate leaves the specimen is that of a step
forces('network', 'network', 1e-8)
forces('box', 'box', 1e-8)
sphere(1e-8)
by_importer()
states('lumped')
states('network')
errors()
