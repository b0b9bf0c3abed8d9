"""What c.py is made of: finding the library, and types that ctypes lacks.

A member that is an enumeration, text or an array with a known length reads as an IntEnum, a str or a NumPy array.
The array has the memory of the C library, and keeps it alive."""
import ctypes
import ctypes.util
import enum
import functools
import os
import weakref
from ctypes import POINTER, c_char, c_char_p, c_int, c_void_p

import numpy as np


def load(soname, version):
    """Loads PALPATE_LIBRARY, or the library in the package's folder, or the one that the system's loader finds."""
    global _library
    folder = os.path.dirname(os.path.abspath(__file__))
    beside = [os.path.join(folder, name) for name in (soname, 'libpalpate.so', 'libpalpate.dylib')]
    given = os.environ.get('PALPATE_LIBRARY')
    tried = [given] if given else [f for f in beside if os.path.exists(f)] + [soname, ctypes.util.find_library('palpate')]
    reasons = []
    for name in filter(None, tried):
        try:
            library = ctypes.CDLL(name)
            library.palp_version.restype = c_char_p
            found = library.palp_version().decode()
        except (OSError, AttributeError) as error:
            reasons.append(str(error))
            continue
        if found != version:
            raise ImportError(f'{name} is palpate {found}, but this package was made for {version}')
        library.palp_status_text.restype = c_char_p
        _library = library
        return
    raise ImportError('libpalpate was not found; set PALPATE_LIBRARY to its file (%s)' % '; '.join(reasons))


class Error(Exception):
    """A call of the library that failed. status: a c.palp_status; the text says where and why."""

    def __init__(self, status, text=''):
        super().__init__(text)
        self.status = status


@functools.lru_cache(None)
def _prefix(members):
    return os.path.commonprefix([name[:name.rfind('_') + 1] for name in members.__members__])


class Enum(enum.IntEnum):
    """An enumeration of the library. Wherever one is wanted, the end of a member's name will do: 'stable'."""

    @property
    def word(self):
        return self.name[len(_prefix(type(self))):].lower()

    @classmethod
    def _missing_(cls, value):
        return next((m for m in cls if isinstance(value, str) and m.word == value.lower()), None)

    @classmethod
    def from_param(cls, value):
        return c_int(cls(value))

    def __str__(self):
        return self.word


class Text:
    """A parameter const char *: a str, bytes or path."""

    @staticmethod
    def from_param(value):
        return c_char_p.from_param(None if value is None else os.fsencode(value))


class Array:
    """A parameter that points to numbers. It takes NumPy arrays; const ones may be of any numbers."""

    def __init__(self, kind, constant):
        self.kind, self.constant = kind, constant
        self.pointer = c_void_p if kind is c_void_p else POINTER(kind)
        self.dtype = None if kind is c_void_p else np.dtype(kind)

    def from_param(self, value):
        if self.constant and isinstance(value, (list, tuple)):
            value = np.array(value, self.dtype)
        if not isinstance(value, np.ndarray):
            return self.pointer.from_param(value)
        if self.constant:
            value = np.ascontiguousarray(value, self.dtype)
        elif value.dtype != (self.dtype or value.dtype) or not (value.flags.c_contiguous and value.flags.writeable):
            raise TypeError(f'needs a contiguous, writable array of {self.dtype}')
        address = Address(value.__array_interface__['data'][0])
        address.array = value
        return address


class Address(c_void_p):
    """Keeps the array that it points into."""


class Owner:
    """Holds what the library allocated, and frees it when nothing uses it any more. keep: what must live longer."""
    __slots__ = ('views', '__weakref__')

    def __init__(self, free, pointer, *keep):
        self.views = weakref.WeakSet()
        weakref.finalize(self, _free, free, pointer, keep)


def _free(free, pointer, keep):
    free(pointer)


class View:
    """Memory of the library as NumPy wants it, with its owner."""
    __slots__ = ('__array_interface__', 'owner', '__weakref__')


def view(pointer, shape, owner, writable=True):
    """A NumPy array of what a ctypes pointer points to, without a copy; None for NULL."""
    if not pointer:
        return None
    if 0 in shape:
        return np.empty(shape, pointer._type_)
    seen = View()
    seen.owner = owner
    seen.__array_interface__ = {'data': (ctypes.addressof(pointer.contents), not writable), 'shape': tuple(shape),
                                'typestr': np.dtype(pointer._type_).str, 'version': 3}
    if isinstance(owner, Owner):
        owner.views.add(seen)
    return np.asarray(seen)


class _Members:
    __slots__ = ()
    _names = ()

    def __init__(self, **members):
        super().__init__()
        self.update(**members)

    def update(self, **members):
        """Sets members by name."""
        for name, value in members.items():
            if name not in self._names:
                raise TypeError(f'{type(self).__name__} has no {name}; it has {", ".join(self._names)}')
            setattr(self, name, value)
        return self

    def copy(self):
        """A copy that shares what this points to, and keeps it."""
        other = type(self)()
        ctypes.pointer(other)[0] = self
        other._owner = owner_of(self)
        return other

    def asdict(self):
        """Members as Python objects, without copies of arrays."""
        return {name: _python(getattr(self, name)) for name in self._names}

    def __repr__(self):
        return f'{type(self).__name__}({", ".join(f"{n}={getattr(self, n)!r}" for n in self._names)})'


def _python(value):
    if isinstance(value, (list, ctypes.Array)):
        return [_python(v) for v in value]
    return value.asdict() if isinstance(value, _Members) else value


class Record(_Members, ctypes.Structure):
    """A structure of the library; its members can be given by name. It frees what the library allocated for it."""
    __slots__ = ('_owner', '_keep', '__weakref__')

    def close(self):
        """Gives up what it owns and becomes empty. Arrays that view it keep their memory."""
        self._owner = None
        ctypes.memset(ctypes.byref(self), 0, ctypes.sizeof(self))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


class Choice(_Members, ctypes.Union):
    """A union of the library."""
    __slots__ = ('_owner', '_keep', '__weakref__')


class Opaque(ctypes.Structure):
    """What only the library looks into."""
    __slots__ = ()


def owner_of(struct):
    """What holds the memory that the pointers of a structure point to: itself if nobody else does."""
    at = struct
    while at is not None:
        owner = getattr(at, '_owner', None)
        if owner is not None:
            return owner
        at = at._b_base_
    return struct


def own(struct, free, *keep):
    """Makes a structure the owner of what it points to; free is the library's function for it."""
    held = type(struct).from_buffer_copy(struct)
    struct._owner = Owner(free, held, *keep)
    return struct


def complete(cls, members):
    """Gives a structure its members: (name, type, shape, text)."""
    cls._fields_ = [_field(name, kind, shape)[:2] for name, kind, shape, _ in members]
    cls._names = tuple(name for name, *_ in members)
    for name, kind, shape, text in members:
        field, _, get, put = _field(name, kind, shape)
        if field != name:
            setattr(cls, name, property(get, put, doc=text))
    told = ''.join(f'\n    {name}: {text}' for name, _, _, text in members if text)
    cls.__doc__ = (cls.__doc__ or '') + told


def _field(name, kind, shape):
    """The field's name, its ctype, and how it is read and set."""
    inner = '_' + name
    if isinstance(kind, tuple):  # an array of an enumeration
        members, n = kind

        def get(self):
            return [_member(members, v) for v in getattr(self, inner)[:_sizes(self, shape, (n,))[0]]]

        def put(self, value):
            getattr(self, inner)[:len(value)] = [members(v) for v in value]
        return inner, c_int * n, get, put
    if issubclass(kind, Enum):
        return inner, c_int, lambda self: _member(kind, getattr(self, inner)), lambda self, v: setattr(self, inner, kind(v))
    if kind is c_char_p:
        return inner, kind, lambda self: _text(getattr(self, inner)), lambda self, v: setattr(self, inner, v and os.fsencode(v))
    if issubclass(kind, ctypes.Array):
        return _array_field(name, kind, shape)
    if issubclass(kind, ctypes._Pointer) and (shape or issubclass(kind._type_, ctypes._SimpleCData)):
        return _pointer_field(name, kind, shape)
    return name, kind, None, None


def _array_field(name, kind, shape):
    inner, element = '_' + name, kind._type_
    if element is c_char:
        return inner, kind, lambda self: _text(getattr(self, inner)), lambda self, v: setattr(self, inner, os.fsencode(v))
    full = (kind._length_,)
    if issubclass(element, ctypes.Structure):
        if not shape:
            return name, kind, None, None

        def put(self, value):
            for i, v in enumerate(value):
                getattr(self, inner)[i] = v
        return inner, kind, lambda self: getattr(self, inner)[:_sizes(self, shape, full)[0]], put
    dtype = np.dtype(element)

    def put_numbers(self, value):
        getattr(self, inner)[:len(value)] = list(value)
    return inner, kind, lambda self: np.frombuffer(getattr(self, inner), dtype, _sizes(self, shape, full)[0]), put_numbers


def _pointer_field(name, kind, shape):
    inner, element = '_' + name, kind._type_
    if issubclass(element, (ctypes.Structure, ctypes._Pointer, c_char_p)):
        def get(self):
            pointer, owner = getattr(self, inner), owner_of(self)
            items = [pointer[i] for i in range(_sizes(self, shape, None)[0])] if pointer else []
            for item in items:
                if isinstance(item, _Members):
                    item._owner = owner
            return items
        return inner, kind, get, lambda self, v: setattr(self, inner, v)

    def get_array(self):  # a pointer where the length is not known
        pointer = getattr(self, inner)
        return view(pointer, _sizes(self, shape, None), owner_of(self)) if shape else pointer

    def put(self, value):  # None, an array, or a pointer
        if value is not None and not isinstance(value, kind):
            array = np.ascontiguousarray(value, element)
            value = array.ctypes.data_as(kind)
            self._keep = {**getattr(self, '_keep', {}), name: array}
        setattr(self, inner, value)
    return inner, kind, get_array, put


def _sizes(struct, shape, full):
    sizes = []
    for factor in shape or ():
        at = int(factor) if factor.isdigit() else struct
        for part in factor.split('.') if at is struct else ():
            at = getattr(at, part)
        sizes.append(at)
    return tuple(sizes) if sizes else full


def _member(members, value):
    try:
        return members(value)
    except ValueError:
        return value


def _text(value):
    return value if value is None else value.decode('utf-8', 'surrogateescape')


def function(name, result, parameters, signature, doc):
    """A function of the library. One that returns a palp_status raises Error unless it is PALP_OK."""
    call = getattr(_library, name)
    call.argtypes, call.restype = parameters, result
    call.__doc__ = signature + '\n\n' + doc
    if isinstance(result, type) and issubclass(result, Enum):
        call.restype = c_int
        call.errcheck = _raise_unless_ok if result.__name__ == 'palp_status' else lambda value, *_: _member(result, value)
        call.members = result
    elif result is c_char_p:
        call.errcheck = lambda value, *_: _text(value)
    return call


def _raise_unless_ok(value, call, arguments):
    if value:
        told = (getattr(a, '_obj', a) for a in arguments)
        text = next((a.text for a in told if type(a).__name__ == 'palp_error' and a.text), None)
        raise Error(call.members(value), f'{call.__name__}: {text or _library.palp_status_text(value)}')
    return value
