"""Numpy arrays and numpy generators of random numbers as plain data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.lib.format import descr_to_dtype, dtype_to_descr

from morse.core.state.errors import StateError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.values import StateData

Array = np.ndarray
_GENERATORS = ("PCG64", "PCG64DXSM", "MT19937", "Philox", "SFC64")
#: sizes of the tables of generators, because numpy does not check the position in the table
_PLACES = {"MT19937": ("state", "pos", 624), "Philox": ("", "buffer_pos", 4)}


def type_of(kind: np.dtype) -> object:
    """Return the type of the items of an array: a string, or a list of fields for a structured type."""
    return kind.str if kind.names is None else dtype_to_descr(kind)


def dtype(data: Any) -> np.dtype:
    """Return the dtype for a result of `type_of`.

    Raises:
        StateError: the type contains Python objects.
    """
    kind = np.dtype(data) if isinstance(data, str) else descr_to_dtype(data)
    if kind.hasobject:
        raise StateError("an array of objects cannot be read from bytes")
    return kind


def root_of(array: Array) -> Array:
    """Return the array that owns the memory of a view."""
    while type(array.base) is np.ndarray:
        array = array.base
    return array


def can_be_shared(root: Array) -> bool:
    """Whether views of the array can be recreated."""
    return root.flags.c_contiguous and root.flags.writeable and not root.dtype.hasobject


def place_in(root: Array, view: Array) -> tuple[int, list[int]]:
    """Return the offset of a view in the memory of its root, bytes, and its strides."""
    return view.__array_interface__["data"][0] - root.__array_interface__["data"][0], list(view.strides)


def view_of(root: Array, kind: np.dtype, shape: Sequence[int], begin: int, strides: Sequence[int]) -> Array:
    """Recreate a view from the result of `place_in`; numpy refuses a view that exceeds the root."""
    return np.ndarray(tuple(shape), kind, root, begin, tuple(strides))


def content(array: Array) -> list[object]:
    """Return the shape, the bytes and the order of the axes. The bits of a sum depend on that order."""
    if array.flags.f_contiguous and not array.flags.c_contiguous:
        return [list(array.shape), array.tobytes("F"), "F"]
    return [list(array.shape), array.tobytes()]


def array_of(kind: np.dtype, shape: Sequence[int], data: bytes, order: object = "C") -> Array:
    """Recreate an array from the result of `content`."""
    return np.frombuffer(data, dtype=kind).reshape(shape, order="F" if order == "F" else "C").copy(order="A")


def generator(name: str) -> np.random.Generator:
    """Create a generator of random numbers of that kind.

    Raises:
        StateError: there is no such kind.
    """
    if name not in _GENERATORS:
        raise StateError(f"{name!r:.40} is not a generator of random numbers")
    return np.random.Generator(getattr(np.random, name)(0))


def check_generator(name: str, state: StateData) -> None:
    """Raise an error for a state that would make numpy read beyond its table."""
    if name in _PLACES:
        part, key, size = _PLACES[name]
        check_place((state[part] if part else state)[key], size)


def check_place(place: object, size: int) -> None:
    """Raise an error for a position outside the table of a generator."""
    if not isinstance(place, int) or not 0 <= place <= size:
        raise StateError("a generator of random numbers is damaged")
