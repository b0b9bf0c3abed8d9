"""What the other modules share: arrays of the right kind, callbacks, and objects of the library."""
import ctypes
from contextlib import contextmanager

import numpy as np

from ._base import Error, Owner, view


free = ctypes.CDLL(None).free
free.argtypes = [ctypes.c_void_p]


def numbers(*arrays):
    """Contiguous doubles, all of one length."""
    arrays = [np.ascontiguousarray(a, float) for a in arrays]
    if any(a.ndim != 1 or len(a) != len(arrays[0]) for a in arrays):
        raise ValueError('arrays must have one dimension and the same length')
    return arrays


def array(kind, items):
    return (kind * len(items))(*items)


@contextmanager
def raising(raised):
    """Raises what a callback raised, in place of the library's ERR_STOPPED."""
    try:
        yield
    except Error:
        if not raised:
            raise
    if raised:
        raise raised[0]


def callback(kind, function, raised, stop=1):
    """A callback of the library that stops where function returns something true or raises."""
    def call(*arguments):
        try:
            return stop if not raised and function(*arguments[1:]) else 0
        except BaseException as error:  # raised again by raising
            raised.append(error)
            return stop
    return kind(call) if function else kind()


class Handle:
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
