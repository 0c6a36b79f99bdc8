"""Arrays and generators of random numbers of numpy, as plain data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.lib.format import descr_to_dtype, dtype_to_descr

from morse.core.state.errors import StateError

if TYPE_CHECKING:
    from collections.abc import Sequence

Array = np.ndarray[Any, Any]
_GENERATORS = ("PCG64", "PCG64DXSM", "MT19937", "Philox", "SFC64")
#: numpy does not check where in its table a generator is
_PLACES = {"MT19937": ("state", "pos", 624), "Philox": ("", "buffer_pos", 4)}


def type_of(kind: np.dtype[Any]) -> Any:
    """The type of an array's items: a string, or for a structure a list of its fields."""
    return kind.str if kind.names is None else dtype_to_descr(kind)


def dtype(saved: Any) -> np.dtype[Any]:
    """What `type_of` gave.

    Raises:
        StateError: it is a type of objects.
    """
    kind = np.dtype(saved) if isinstance(saved, str) else descr_to_dtype(saved)
    if kind.hasobject:
        raise StateError("an array of objects cannot be read from bytes")
    return kind


def root_of(array: Array) -> Array:
    """The array that owns the memory that an array shows a part of."""
    while type(array.base) is np.ndarray:
        array = array.base
    return array


def can_be_shared(root: Array) -> bool:
    """Whether views of it can be made anew."""
    return root.flags.c_contiguous and root.flags.writeable and not root.dtype.hasobject


def place_in(root: Array, view: Array) -> tuple[int, list[int]]:
    """Where in the memory of its root a view begins, bytes, and its strides."""
    return view.__array_interface__["data"][0] - root.__array_interface__["data"][0], list(view.strides)


def view_of(root: Array, kind: np.dtype[Any], shape: Sequence[int], begin: int, strides: Sequence[int]) -> Array:
    """A view, from what `place_in` gave; numpy refuses one that leads out of the root."""
    return np.ndarray(tuple(shape), kind, root, begin, tuple(strides))


def content(array: Array) -> list[Any]:
    """Shape, bytes and order of the axes: sums depend on the order, to the bit."""
    if array.flags.f_contiguous and not array.flags.c_contiguous:
        return [list(array.shape), array.tobytes("F"), "F"]
    return [list(array.shape), array.tobytes()]


def array_of(kind: np.dtype[Any], shape: Sequence[int], data: bytes, order: Any = "C") -> Array:
    """The array of a `content`."""
    return np.frombuffer(data, dtype=kind).reshape(shape, order="F" if order == "F" else "C").copy(order="A")


def generator(name: str) -> np.random.Generator:
    """A generator of random numbers of that kind.

    Raises:
        StateError: there is no such kind.
    """
    if name not in _GENERATORS:
        raise StateError(f"{name!r:.40} is not a generator of random numbers")
    return np.random.Generator(getattr(np.random, name)(0))


def check_generator(name: str, state: dict[str, Any]) -> None:
    """Refuse a state that would have numpy read beyond its table."""
    if name in _PLACES:
        part, key, size = _PLACES[name]
        check_place((state[part] if part else state)[key], size)


def check_place(place: Any, size: int) -> None:
    """Refuse a place outside a table of a generator."""
    if not isinstance(place, int) or not 0 <= place <= size:
        raise StateError("a generator of random numbers is damaged")
