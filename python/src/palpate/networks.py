"""Meshes, networks, their tools and their ticks."""
import ctypes
import math
from ctypes import POINTER, byref, c_int32, c_size_t

import numpy as np

from . import c
from ._objects import Handle, array, callback, numbers, raising


class Mesh(Handle):
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
    def of_model(cls, model):
        """The mesh of a network model, with its regions."""
        return cls._make(c.palp_model_mesh, model, (c.palp_error(),))

    @classmethod
    def lattice(cls, nodes, size_m, neighbours=26):
        """A box of nodes[3] particles; y is the direction of compression."""
        nodes, (size_m,) = np.array(nodes, np.uintp), numbers(size_m)
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

    def join(self, other, name):
        """Both as separate parts of a new mesh; all of the other is the set and the region name, its sets name.set."""
        return Mesh._make(c.palp_mesh_join, self, other, name, ())

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
        with raising(raised):
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


class Hull(Handle):
    """The convex hull of points [n, 3] in a frame of its own, for tools."""
    __slots__ = ()

    def __init__(self, points_m):
        points_m, pointer = np.reshape(points_m, (-1, 3)), POINTER(c.palp_hull)()
        c.palp_hull_create(len(points_m), points_m, byref(pointer), c.palp_error())
        super().__init__(pointer, c.palp_hull_free)

    @classmethod
    def box(cls, half_m):
        """A box of these half sides."""
        return cls(np.array(np.meshgrid(*[(-h, h) for h in half_m])).reshape(3, -1).T)


def hull(shape, radius_m, position_m, orientation=(0, 0, 0, 0), friction=0.0):
    """A Hull with edges rounded by radius_m, turned by a unit quaternion w, x, y, z."""
    tool = c.palp_tool(shape=c.PALP_TOOL_HULL, radius_m=radius_m, position_m=position_m, orientation=orientation,
                       hull=shape._as_parameter_, friction=friction)
    tool._keep = {'hull': shape}
    return tool


class Network(Handle):
    """Particles joined by springs and dashpots. Arrays view the last committed state until the next step."""
    __slots__ = ('max_tools', 'max_ties', '_tools')

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
        self.max_tools = self.max_ties = 0
        Handle.__init__(self, pointer, c.palp_network_free)

    @staticmethod
    def _supports(supports, default):
        if supports is not None:
            return len(supports), array(c.palp_support, supports)
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
        with raising(raised):
            c.palp_network_run(self, path, c.palp_run_settings(observer=callback(c.palp_network_observer, observe, raised),
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
        """The tools of the next steps: sphere, capsule, plane, hull."""
        c.palp_network_set_tools(self, len(tools), array(c.palp_tool, tools))
        self._tools = tools  # with their hulls

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

    def enable_ties(self, max_ties):
        """Prepares for threads and rods, once; resets."""
        c.palp_network_enable_ties(self, max_ties)
        self.max_ties = max_ties

    def set_ties(self, *ties):
        """The ties of the next steps, each a c.palp_tie; their points as from tie_point."""
        c.palp_network_set_ties(self, len(ties), array(c.palp_tie, ties))

    @property
    def ties(self):
        """A c.palp_tie_state for each of max_ties: force, length, and whether it is torn."""
        states = (c.palp_tie_state * self.max_ties)()
        c.palp_network_ties(self, states)
        return list(states)

    def tie_point(self, place_m):
        """The c.palp_tie_point of the tissue nearest to a place at rest."""
        point = c.palp_tie_point()
        c.palp_tie_point_at(c.palp_network_mesh(self), np.reshape(place_m, 3), point)
        return point

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


class Realtime(Handle):
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
