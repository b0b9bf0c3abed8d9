"""test_palpate.py: the installed package against the command, the compiler and its own promises.

tests/install/python.sh runs it. PALPATE: the command; DATA: the repository's data; INCLUDE: the headers' folder; CC."""
import csv
import gc
import itertools
import json
import os
import subprocess
import tempfile
import unittest
import weakref

import numpy as np
import palpate
from palpate import c
from palpate._base import Enum, _Members

COMMAND, DATA = os.environ['PALPATE'], os.environ['DATA']
SAME = {'rtol': 1e-12, 'atol': 0}


def command(*words):
    """The command's standard output; an exit code of 3 tells of a fit that did not converge."""
    return subprocess.run([COMMAND, *map(str, words)], check=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True).stdout


def text(path):
    with open(path) as file:
        return file.read()


def columns(path):
    rows = [line for line in text(path).splitlines() if not line.startswith('#')]
    return {name: np.array(values, float) for name, values in zip(rows[0].split(','), zip(*csv.reader(rows[1:])))}


def network():
    return palpate.Network.from_model(palpate.Model.load(DATA + '/sedef2008/network_27.json'))


def touched():
    """A network under a sphere that is 1 mm deep in it."""
    made = palpate.Network.from_model(palpate.Model.load(DATA + '/models/phantom_11.json'),
                                      supports=[c.palp_support(set='bottom', axis=['fixed'] * 3)])
    made.enable_tools(2)
    low, high = made.mesh.bounds
    middle = 0.5 * (low + high)
    for depth in np.linspace(0, 1e-3, 5):
        made.set_tools(palpate.sphere(4e-3, [middle[0], high[1] + 4e-3 - depth, middle[2]]))
        made.step(0, 0.01)
    return made


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)


class Declarations(Folder):
    def types(self, kind):
        return [t for name, t in vars(c).items() if isinstance(t, type) and issubclass(t, kind) and name.startswith('palp_')]

    def test_layout_and_constants_are_the_compilers(self):
        expected, lines = [], []
        for struct in self.types(_Members):
            if struct.__name__.endswith('_as'):  # a union without a name
                continue
            lines.append(f'printf("%zu\\n", sizeof({struct.__name__}));')
            expected.append(c.sizeof(struct))
            for (field, *_), name in zip(struct._fields_, struct._names):
                name = name.rstrip('_')
                lines.append(f'printf("%zu\\n", 10000 * offsetof({struct.__name__}, {name}) + sizeof((({struct.__name__} *)0)->{name}));')
                expected.append(10000 * getattr(struct, field).offset + getattr(struct, field).size)
        for enum in self.types(Enum):
            for member in enum:
                lines.append(f'printf("%d\\n", (int){member.name});')
                expected.append(int(member))
        with open(self.path('layout.c'), 'w') as file:
            file.write('#include <palpate/palpate.h>\n#include <stdio.h>\nint main(void) {\n%s\nreturn 0;\n}\n' % '\n'.join(lines))
        subprocess.run([os.environ.get('CC', 'gcc'), '-std=c99', '-I', os.environ['INCLUDE'], self.path('layout.c'), '-o',
                        self.path('layout')], check=True)
        found = subprocess.run([self.path('layout')], check=True, stdout=subprocess.PIPE, text=True).stdout.split()
        for line, value, want in zip(lines, found, expected):
            self.assertEqual(int(value), want, line)
        self.assertEqual(len(found), len(expected))
        self.assertGreater(len(expected), 600)

    def test_every_function_is_there_and_documented(self):
        functions = [f for name, f in vars(c).items() if name.startswith('palp_') and hasattr(f, 'argtypes') and hasattr(f, '__doc__')
                     and not isinstance(f, type)]
        folder = os.path.join(os.environ['INCLUDE'], 'palpate')
        headers = ''.join(text(os.path.join(folder, name)) for name in os.listdir(folder))
        declared = headers.count('PALP_API ') - headers.count('define PALP_API ')
        self.assertEqual(len(functions), declared)
        self.assertIn('ERR_COLLAPSED: an element lost its length', c.palp_network_step.__doc__)
        self.assertIn('pores are accurate', c.palp_specimen_settings.__doc__)

    def test_words_stand_for_constants(self):
        self.assertEqual(c.palp_branch('stable'), c.PALP_BRANCH_STABLE)
        self.assertEqual(c.PALP_ERR_INPUT.word, 'err_input')
        with self.assertRaises(ValueError):
            c.palp_branch('fluffy')
        with self.assertRaisesRegex(TypeError, 'has no braanch; it has tolerance'):
            c.palp_network_settings(braanch='stable')
        with self.assertRaises(AttributeError):
            c.palp_network_settings().braanch = 0


class Command(Folder):
    """What the command finds is what the package finds."""

    def test_lumped_model(self):
        file = DATA + '/sedef2008/lumped_n2.json'
        command('simulate', file, '--protocol', 'ramp_hold', '--depth-mm', 6, '--hold-s', 5, '--dt-ms', 10, '--out', self.path('run.csv'))
        run = columns(self.path('run.csv'))
        path = palpate.Path.ramp_hold(1e-3 * 6, 1, 5)
        depth = np.array([path.at(t) for t in run['time_s']])
        np.testing.assert_allclose(palpate.Model.load(file).force(run['time_s'], depth), run['force_N'], **SAME)

    def test_parquet(self):
        try:
            import pyarrow.parquet
        except ImportError:
            self.skipTest('pyarrow is not installed')
        file, packed, back = map(self.path, ('run.csv', 'run.parquet', 'back.csv'))
        command('simulate', DATA + '/sedef2008/network_27.json', '--protocol', 'ramp_hold', '--depth-mm', 4, '--out', file)
        palpate.Experiment.read(file).write_parquet(packed)
        table = pyarrow.parquet.read_table(packed)
        for name, values in columns(file).items():
            np.testing.assert_array_equal(table[name].to_numpy(), values)
        self.assertEqual(json.loads(table.schema.metadata[b'palpate:specimen.height_mm']), 24)
        palpate.Experiment.read_parquet(packed).write(back)
        self.assertEqual(text(back), text(file))

    def test_header(self):
        run = palpate.Experiment({'time_s': [0, 1], 'depth_mm': [0, 1], 'force_N': [0, 1]}, {'a.b': 0.1, 'c': 'd'})
        self.assertEqual(run.header, {'palpate.experiment': 1, 'a.b': 0.1, 'c': 'd'})

    def test_network(self):
        file = DATA + '/sedef2008/network_27.json'
        command('simulate', file, '--protocol', 'ramp_hold', '--depth-mm', 6, '--hold-s', 5, '--dt-ms', 50, '--out', self.path('run.csv'))
        run = columns(self.path('run.csv'))
        time, depth, force, info = network().run(palpate.Path.ramp_hold(1e-3 * 6, 1, 5), dt_s=0.05)
        np.testing.assert_allclose(force, run['force_N'], **SAME)
        np.testing.assert_allclose(1e3 * depth, run['depth_mm'], **SAME)
        self.assertEqual(info.steps + 1, len(time))

    def compare(self, fit, told):
        self.assertEqual([e.name for e in fit.estimate], [e['name'] for e in told])
        for key in ('value', 'sd', 'low', 'high'):
            np.testing.assert_allclose([getattr(e, key) for e in fit.estimate], [e[key] for e in told], **SAME)

    def test_characterize(self):
        command('import', DATA + '/measured/ecoflex/EF10_0T_A2.csv', '--out', self.folder)
        file = self.path('EF10_0T_A2.csv')
        told = json.loads(command('characterize', file, '--arms', 0, '--degree', 4, '--contact', 'known', '--json'))
        recording = palpate.Recording.read(file)
        laws = [palpate.guess_law([recording], 4)]
        found = palpate.characterize_recordings([recording], most_arms=0, laws=laws, no_spline=True, contact='known').mean
        self.compare(found, told['estimates'])
        np.testing.assert_allclose(found.correlation, told['correlation'], **SAME)
        self.assertAlmostEqual(found.rms_N[0], told['runs'][0]['rms_N'], 12)
        fit = palpate.characterize([recording], law=laws[0], n_arms=0)
        np.testing.assert_allclose(fit.rms_N[0], found.rms_N[0], rtol=0.1)
        left = (fit.force(recording) - recording.force_N)[(recording.use != 0) & (recording.depth_m > 0)]
        self.assertAlmostEqual(np.sqrt(np.mean(left**2)), fit.rms_N[0], 9)
        # The model keeps the covariance, also in its file.
        model = fit.model(0.03, 0.025)
        expected = fit.covariance.copy()
        del fit
        gc.collect()
        model.save(self.path('model.json'))
        covariance = palpate.covariance(self.path('model.json'))
        np.testing.assert_allclose(covariance, expected, rtol=1e-12)
        force, sd = palpate.Model.load(self.path('model.json')).band([0, 1], [0, 0.006], covariance)
        self.assertTrue(0 < sd[1] < force[1])
        self.assertEqual(json.loads(model.json)['kind'], 'lumped')
        # The same columns by NumPy give the same recording.
        read = palpate.Experiment.read(file)
        again = palpate.Recording.from_arrays(read['time_s'], 1e-3 * read['depth_mm'], read['force_N'], 0.03, 0.025)
        np.testing.assert_allclose(again.force_N, recording.force_N, **SAME)

    def test_characterize_arms(self):
        command('import', DATA + '/measured/mach1/hayes_01_FindContact.csv', DATA + '/measured/mach1/hayes_02_StressRelaxation.csv',
                '--specimen-height-mm', 2, '--out', self.folder)
        file = self.path('hayes_02_StressRelaxation.csv')
        told = json.loads(command('characterize', file, '--arms', 2, '--shared-arms', '--contact', 'known', '--json'))
        fit = palpate.characterize([palpate.Recording.read(file)], n_arms=2, dwell_only=True)
        self.compare(fit, told['shared']['estimates'])
        self.assertTrue(fit.converged)

    def test_choice_of_arms_and_law(self):
        model, runs = palpate.Model.load(DATA + '/sedef2008/lumped_n2.json'), []
        for depth in (2, 4, 6):
            file = self.path(f'{depth}.csv')
            command('simulate', DATA + '/sedef2008/lumped_n2.json', '--protocol', 'ramp_hold', '--depth-mm', depth, '--hold-s', 100,
                    '--sample-Hz', 20, '--noise-N', 0.002, '--seed', depth, '--out', file)
            runs.append(palpate.Experiment.read(file))
        recordings = [palpate.Recording.prepare(run) for run in runs]
        laws = [palpate.guess_law(recordings, n) for n in (1, 3)]
        self.assertEqual(palpate.characterize_recordings(recordings, laws=laws, no_spline=True).mean.material.law.n, 3)
        for specimens in (palpate.characterize_likelihood(model, runs, most_arms=3),
                          palpate.characterize_recordings(recordings, [0, 0, 1], most_arms=3)):
            tau = [a.viscosity_Ns / a.stiffness_N for a in specimens.mean.material.arms]
            wanted = [a.viscosity_Ns / a.stiffness_N for a in model.material.arms]
            np.testing.assert_allclose(sorted(tau), sorted(wanted), rtol=0.1)

    def test_effects(self):
        model = palpate.Model.load(DATA + '/sedef2008/lumped_n1.json')
        t, depth = np.linspace(0, 1, 50), np.linspace(0, 0.004, 50)
        plain = model.force(t, depth)
        model.effects, model.n_effects = [palpate.effect('thermal_expansion', **{self.key('thermal_expansion'): 0.01})], 1
        np.testing.assert_array_equal(model.force(t, depth, columns={'temperature_C': np.full(50, 20.0)}), plain)
        warm = model.force(t, depth, columns={'temperature_C': 20 + t})
        self.assertGreater(np.abs(warm - plain).max(), 1e-6)
        with self.assertRaisesRegex(TypeError, 'has no lag; it has time_s'):
            palpate.effect('sensor_lag', lag=1)

    @staticmethod
    def key(id):
        return c.palp_effect_look_up(c.palp_effect_id(id)).contents.parameter[0].key

    def test_explain(self):
        truth = palpate.Model.load(DATA + '/sedef2008/lumped_n1.json')
        truth.effects, truth.n_effects = [palpate.effect('sensor_lag', time_s=0.05)], 1
        truth.save(self.path('truth.json'))
        files = [self.path(f'{depth}.csv') for depth in (4, 6)]
        for depth, file in zip((4, 6), files):
            command('simulate', self.path('truth.json'), '--protocol', 'ramp_hold', '--depth-mm', depth, '--ramp-s', 0.5, '--hold-s', 4,
                    '--sample-Hz', 40, '--noise-N', 0.002, '--seed', depth, '--out', file)
        told = json.loads(command('explain', '--model', DATA + '/sedef2008/lumped_n1.json', *files, '--candidates',
                                  'sensor_lag,relaxation_arm', '--max-effects', 1, '--json'))
        model, shares = palpate.Model.load(DATA + '/sedef2008/lumped_n1.json'), []
        found = palpate.explain(model, [palpate.Experiment.read(f) for f in files], files, progress=shares.append,
                                candidates=['sensor_lag', 'relaxation_arm'], max_effects=1)
        self.assertEqual(found.verdict.word, told['verdict'])
        self.assertEqual([e.effect.id.word for e in found.effect], [e['id'] for e in told['effects']])
        self.assertEqual(found.effect[0].effect.id, c.PALP_EFFECT_SENSOR_LAG)
        for key in ('noise_level_N', 'before_N', 'after_N'):
            np.testing.assert_allclose(getattr(found.gap, key), told['gap'][key], **SAME)
        self.assertAlmostEqual(sum(shares), 1, 6)
        with_effects = palpate.Model.of(found.model)
        del found, model
        gc.collect()
        with_effects.save(self.path('explained.json'))
        self.assertEqual(palpate.Model.load(self.path('explained.json')).effects[0].id.word, 'sensor_lag')


class Memory(Folder):
    def test_columns_are_not_copied(self):
        experiment = palpate.Experiment({'time_s': [0, 1, 2.5], 'depth_mm': [0, 1, 2], 'force_N': [0, 1, 4]}, {'specimen.name': 'b'})
        force = experiment['force_N']
        self.assertTrue(np.shares_memory(force, experiment['force_N']))
        force[1] = 7
        experiment['temperature_C'] = [20, 21, 22]
        experiment.write(self.path('run.csv'))
        again = palpate.Experiment.read(self.path('run.csv'))
        np.testing.assert_array_equal(again['force_N'], [0, 7, 4])
        self.assertEqual(again.columns, ['time_s', 'depth_mm', 'force_N', 'temperature_C'])
        self.assertEqual((again.get('specimen.name'), again.get('none', 5)), ('b', 5))
        with self.assertRaises(KeyError):
            again['none']

    def test_arrays_keep_what_they_view(self):
        t = np.linspace(0, 10, 200)
        recording = palpate.Recording.from_arrays(t, 1e-4 * t, 0.1 * t + 0.001 * np.sin(1e3 * t), 0.03)
        force, copy = recording.force_N, recording.force_N.copy()
        self.assertTrue(np.shares_memory(force, recording.force_N))
        owner = weakref.ref(recording._owner)
        recording.close()
        self.assertEqual((recording.n, recording.force_N), (0, None))
        np.testing.assert_array_equal(force, copy)
        self.assertIsNotNone(owner())
        del force
        gc.collect()
        self.assertIsNone(owner())

    def test_positions_follow_the_network(self):
        made = network()
        rest = made.positions.copy()
        made.step(0.001, 0.1)
        now = made.positions
        self.assertTrue(np.shares_memory(now, made.positions))
        self.assertFalse(now.flags.writeable)
        self.assertAlmostEqual(np.abs(now - rest).max(), 0.001, 12)
        with self.assertRaisesRegex(BufferError, 'still view'):
            made.set_material(palpate.material(palpate.law('polynomial', [1.0])))
        del now
        made.set_material(palpate.material(palpate.law('polynomial', [1.0])))
        np.testing.assert_array_equal(made.positions, rest)

    def test_any_order(self):
        for order in itertools.permutations(range(5)):
            for close in (False, True):
                mesh = palpate.Mesh.lattice([3, 3, 3], [0.02] * 3)
                made = palpate.Network(mesh, palpate.material(palpate.law('polynomial', [1.0]), [(1.0, 0.1)]))
                ticks = made.realtime()
                ticks.step(1e-4, 1e-3)
                objects = [mesh, made, ticks, made.positions, mesh.positions]
                del mesh, made, ticks
                for i in order:
                    if close and hasattr(objects[i], 'close'):
                        objects[i].close()
                    objects[i] = None
                    gc.collect(0)

    def test_closed_objects_are_refused(self):
        with network() as made:
            made.step(0.001)
        with self.assertRaises((palpate.Error, TypeError, c.ArgumentError)):
            made.step(0.002)

    def test_a_thousand_rounds(self):
        def resident():
            return int(text('/proc/self/statm').split()[1]) * os.sysconf('SC_PAGE_SIZE')

        def rounds(n):
            for _ in range(n):
                made = network()
                made.realtime().step(1e-4, 1e-3)
                made.positions
                t = np.linspace(0, 10, 500)
                recording = palpate.Recording.from_arrays(t, 1e-4 * t, 0.1 * t + 1e-3 * np.sin(1e3 * t), 0.03)
                palpate.characterize([recording], law=palpate.law('polynomial', [1.0])).estimate
                palpate.Path.ramp_hold(0.001, 1, 1).depth_m
                try:
                    palpate.Model.load('/none')
                except palpate.Error:
                    pass
        rounds(200)
        before = resident()
        rounds(1000)
        self.assertLess(resident() - before, 4e6)


class Errors(Folder):
    def test_status_and_text(self):
        with self.assertRaisesRegex(palpate.Error, 'none.json: cannot open') as caught:
            palpate.Model.load('/none.json')
        self.assertEqual(caught.exception.status, c.PALP_ERR_FILE)
        with open(self.path('bad.json'), 'w') as file:
            file.write('{"palpate": {"model": 1},\n "kind": "lumpy"}')
        with self.assertRaisesRegex(palpate.Error, r'bad.json:2: .*lumpy') as caught:
            palpate.Model.load(self.path('bad.json'))
        self.assertEqual(caught.exception.status.word, 'err_input')
        with self.assertRaisesRegex(palpate.Error, 'an argument is out of range'):
            palpate.law('polynomial', [np.nan])
        with self.assertRaisesRegex(palpate.Error, 'run: has 2 samples'):
            palpate.Recording.from_arrays([0.0, 1.0], [0.0, 0.001], [0.0, 1.0], 0.03, name='run')
        with self.assertRaises(ValueError):
            palpate.Path.corners([0, 1], [0])
        with self.assertRaisesRegex(c.ArgumentError, 'writable array of float64'):
            c.palp_law_force(palpate.law('polynomial', [1.0]), 1, [0.1], np.zeros(1, np.float32), None, None)

    def test_callbacks(self):
        made, path, steps = network(), palpate.Path.ramp_hold(0.006, 1, 1), []

        def fail(*row):
            raise KeyError('mine')
        with self.assertRaisesRegex(KeyError, 'mine'):
            made.run(path, fail, dt_s=0.1)
        made.reset()
        with self.assertRaises(palpate.Error) as caught:
            made.run(path, lambda *row: steps.append(row) or len(steps) == 3, dt_s=0.1)
        self.assertEqual((caught.exception.status, len(steps)), (c.PALP_ERR_STOPPED, 3))


class Networks(Folder):
    def test_tools(self):
        made = touched()
        force, contacts = made.tool_forces, made.contacts
        self.assertGreater(force[0].force_N[1], 0.01)
        self.assertEqual((len(contacts), force[1].contacts), (force[0].contacts, 0))
        pushed = sum(k.normal_N * k.normal + k.friction_N for k in contacts)
        np.testing.assert_allclose(-pushed, force[0].force_N, atol=1e-9)
        low, high = made.mesh.bounds
        for tool in (palpate.capsule(3e-3, [low[0], high[1] + 2e-3, 0.5 * (low + high)[2]], [1, 0, 0], high[0] - low[0]),
                     palpate.plane([0, high[1] - 1e-3, 0], [0, -1, 0]),
                     palpate.hull(palpate.Hull.box([4e-3, 1e-3, 4e-3]), 1e-3, 0.5 * (low + high) * [1, 0, 1] + [0, high[1] + 1e-3, 0])):
            made.reset()
            made.set_tools(tool)
            made.step(0, 0.1)
            self.assertGreater(made.tool_forces[0].force_N[1], 0.01)

    def test_parts_and_ties(self):
        lower, upper = (palpate.Mesh.lattice([4] * 3, [0.02] * 3) for _ in range(2))
        upper.transform(np.eye(3), [0, 0.021, 0])
        both = lower.join(upper, 'upper')
        self.assertEqual(len(both.positions), 128)
        np.testing.assert_array_equal(both.set('upper.top'), upper.set('top') + 64)
        made = palpate.Network(both, palpate.material(palpate.law('polynomial', [5.0])),
                               [c.palp_support(set='bottom', axis=['fixed'] * 3),
                                c.palp_support(set='upper.top', axis=['fixed', 'driven', 'fixed'], motion=[0, -1, 0])])
        made.enable_tools(0, tissue=True)
        made.enable_ties(1)
        points = [made.tie_point([0.01, y, 0.01]) for y in (0.015, 0.026)]
        made.set_ties(c.palp_tie(n_points=2, point=points, length_m=0.01, stiffness_N_m=50.0, strength_N=np.inf))
        made.step(0, 0.1)
        (tie,) = made.ties
        self.assertAlmostEqual(tie.force_N, 50 * (tie.length_m - 0.01), places=12)
        self.assertGreater(tie.force_N, 1e-3)
        made.step(2e-3, 0.1)
        self.assertTrue(made.contacts and all(k.tool == c.PALP_CONTACT_TISSUE for k in made.contacts))

    def test_saved_states(self):
        made = touched()
        made.reset()
        ticks = made.realtime()
        for i in range(5):
            ticks.step(0, 1e-3, corrections=1)
        state, whole = made.save(), ticks.save()
        forces = [[ticks.step(0, 1e-3, corrections=1).residual for _ in range(5)] for _ in range(2) if ticks.restore(whole) is None]
        self.assertEqual(forces[0], forces[1])
        made.restore(state)
        with self.assertRaisesRegex(palpate.Error, 'checksum|malformed'):
            made.restore(state[:-1] + bytes([state[-1] ^ 1]))

    def test_grasp_cut_and_forces(self):
        made = network()
        top = made.mesh.set('top')
        made.set_forces(top[4:5], [[0, 0, 0.01]])
        made.enable_tools(1, 2)
        made.enable_cutting()
        made.grasp(made.mesh.set('bottom')[:0], [])
        self.assertEqual(made.cut([[-1, 0.012, -1], [1, 0.012, -1], [0, 0.012, 2]]) > 0, True)
        made.step(0.001)
        self.assertAlmostEqual(made.force, 0, 3)
        self.assertEqual(made.surface.shape[1], 3)

    def test_mesh_from_arrays(self):
        lattice = palpate.Mesh.lattice([2, 3, 2], [0.01] * 3)
        made = palpate.Mesh.create(lattice.positions, lattice.pairs)
        np.testing.assert_array_equal(made.positions, lattice.positions)
        with self.assertRaisesRegex(ValueError, 'stays as it is'):
            network().mesh.add_set('more', [0])
        lattice.add_region('half', lambda x: float(x[0] < 0.005))
        with self.assertRaises(ZeroDivisionError):
            lattice.add_region('broken', lambda x: 1 / 0)

    def test_calibrate(self):
        lumped = palpate.Model.load(DATA + '/sedef2008/lumped_n1.json')
        model = palpate.Model.lattice(lumped.material, [3, 3, 3], [0.024] * 3, source={'scaling': 'continuum'})
        made, depth = palpate.Network.from_model(model), np.linspace(0, 0.006, 13)[1:]
        force = palpate.law_force(lumped.material.law, depth / lumped.height_m)
        told = []
        static = palpate.calibrate_static(made, lumped.material, depth, force, progress=lambda share, last: told.append(last.residual_N))
        self.assertLess(np.abs(static.force_N - force).max(), 0.01 * force.max())
        self.assertEqual(told, [i.residual_N for i in static.iterations])
        time = np.geomspace(0.1, 20, 30)
        path = palpate.Path.ramp_hold(0.004, 1, 20)
        wanted = lumped.force(time, [path.at(t) for t in time])
        start = static.material
        best = palpate.calibrate_relaxation(made, start, [(path, time, wanted)])
        self.assertLess(best.iterations[-1].relative_rms, 0.03)
        with self.assertRaises(palpate.Error) as caught:
            palpate.calibrate_static(made, lumped.material, depth, force, progress=lambda *_: True)
        self.assertEqual(caught.exception.status.word, 'err_stopped')

    def test_calibrate_presses(self):
        stiffness = palpate.law('polynomial', [2.0, 1.0])
        truth = palpate.Model.lattice(palpate.material(stiffness), [4, 4, 4], [0.024] * 3, source={'scaling': 'continuum'})
        tool, depth, force = palpate.sphere(6e-3, [0.012, 0.030, 0.012]), np.linspace(2e-4, 2e-3, 8), []
        made = palpate.Network.from_model(truth, supports=[c.palp_support(set='bottom', axis=['fixed'] * 3)])
        made.enable_tools(1)
        for deep in depth:
            tool.position_m = [0.012, 0.030 - deep, 0.012]
            made.set_tools(tool)
            made.step(0)
            force.append(made.tool_forces[0].force_N[1])
        tool.position_m = [0.012, 0.030, 0.012]
        found = palpate.Model.of(truth)
        c.palp_law_scale(truth.material.law, 3.0, found.material.law)
        result = palpate.calibrate_presses(found, [palpate.press(np.arange(8.0), depth, force, tool, relaxed=True)])
        np.testing.assert_allclose(result.force_N, force, rtol=1e-3)
        np.testing.assert_allclose(palpate.law_force(found.material.law, [0.05]), palpate.law_force(stiffness, [0.05]), rtol=0.05)


if __name__ == '__main__':
    unittest.main()
