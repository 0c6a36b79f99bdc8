"""Objects that a state refers to by name: they exist before the state is restored."""

from __future__ import annotations

from datetime import date, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import numpy as np
from numpy.lib.format import descr_to_dtype, dtype_to_descr

from morse.core.exceptions import MorseError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from morse.core.values import StateData


class StateError(MorseError):
    """A saved state is damaged, or belongs to another scene."""


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
        place = state[part] if part else state
        check_place(place.get(key) if isinstance(place, dict) else None, size)


def check_place(place: object, size: int) -> None:
    """Raise an error for a position outside the table of a generator."""
    if not isinstance(place, int) or not 0 <= place <= size:
        raise StateError("a generator of random numbers is damaged")


class References(Protocol):
    """Maps the parts of a simulation, and the classes and variables of its project, to names and back."""

    def name_of(self, value: object) -> str | None:
        """The name of a part of the simulation, such as ``component robot.pose``; None for other objects."""

    def find(self, name: str) -> object:
        """The part of that name.

        Raises:
            StateError: there is no such part.
        """

    def find_class(self, path: str) -> type | None:
        """The class of that path (``module:name``), if it belongs to the simulation or the user's project."""

    def met_class(self, cls: type) -> None:
        """Record that an object of that class was saved, so that this process may recreate such objects."""

    def global_name(self, value: object) -> str | None:
        """``module:NAME`` of an object or function that is a variable of the user's project; None for others."""

    def find_global(self, name: str) -> object:
        """The object or function of that name.

        Raises:
            StateError: there is no such object or function.
        """


class NoReferences:
    """References for data from outside, which do not refer to parts of the simulation, to classes or functions."""

    def name_of(self, value: object) -> str | None:
        """Nothing has a name."""
        return None

    def find(self, name: str) -> object:
        """Refuse the name."""
        raise StateError(f"data from outside cannot contain {name!r:.60}")

    def find_class(self, path: str) -> type | None:
        """There are no classes."""
        return None

    def met_class(self, cls: type) -> None:
        """Do nothing, because such data do not contain objects of classes."""

    def global_name(self, value: object) -> str | None:
        """Nothing has a name."""
        return None

    def find_global(self, name: str) -> object:
        """Refuse the name."""
        raise StateError(f"data from outside cannot contain {name!r:.60}")


#: class to its word, and the function that returns its parts
TAKEN_APART: dict[type, tuple[str, Callable[[Any], list[object]]]] = {
    complex: ("complex", lambda v: [v.real, v.imag]),
    range: ("range", lambda v: [v.start, v.stop, v.step]),
    slice: ("slice", lambda v: [v.start, v.stop, v.step]),
    datetime: ("time", lambda v: [v.isoformat()]),
    date: ("day", lambda v: [v.isoformat()]),
    timedelta: ("duration", lambda v: [v.days, v.seconds, v.microseconds]),
    type(Path()): ("path", lambda v: [str(v)]),
}
#: word to the function that creates the value from its parts
PUT_TOGETHER: dict[str, Callable[..., object]] = {
    "complex": complex,
    "range": range,
    "slice": slice,
    "time": datetime.fromisoformat,
    "day": date.fromisoformat,
    "duration": timedelta,
    "path": Path,
}


#: maximum number of items that references to earlier lists may stand for
_MOST = 10_000_000
#: maximum nesting depth, references included
_DEEPEST = 340
#: maximum number of items of a set with the same hash: the hashes of numbers and tuples are known to everybody
_MOST_ALIKE = 100
_Item = TypeVar("_Item")


class Extents:
    """Counts the items of nested values, and those of earlier values to which they refer.

    The items of an object count for the object, and not for a list that contains it: graphs of objects may have cycles,
    and nothing expands them.
    """

    def __init__(self) -> None:
        self._of: dict[int, tuple[int, int]] = {}
        self._items = self._height = self._repetitions = 0

    def begin(self) -> tuple[int, int]:
        """Begin a nested value; the result is an argument of `end`."""
        outer = self._items, self._height
        self._items = self._height = 0
        return outer

    def end(self, outer: tuple[int, int], value: object, *, counts: bool) -> None:
        """End a nested value.

        Args:
            counts: whether its items count for the value that contains it.
        """
        items, height = (self._items + 1, self._height + 1) if counts else (1, 1)
        self._of[id(value)] = items, height
        self._items, self._height = outer[0] + items, max(outer[1], height)

    def count(self, items: int) -> None:
        """Count items that are not nested values."""
        self._items += items

    def refer(self, value: object, depth: int) -> None:
        """Count an earlier value once more, at a nesting depth.

        Raises:
            StateError: the limits are exceeded.
        """
        items, height = self._of.get(id(value), (1, 1))
        if depth + height > _DEEPEST:
            raise StateError("the saved state is nested too deeply")
        self.repeat(items)
        self._height = max(self._height, height)

    @staticmethod
    def spread(items: Iterable[_Item]) -> Iterator[_Item]:
        """Iterate over items of a set, or keys of a dictionary.

        Raises:
            StateError: many have the same hash: each of them would be compared with all others.
        """
        counts: dict[int, int] = {}
        for item in items:
            code = hash(item)
            counts[code] = count = counts.get(code, 0) + 1
            if count > _MOST_ALIKE:
                raise StateError("the saved state contains a set or a dictionary in which too many hashes are equal")
            yield item

    def repeat(self, items: int) -> None:
        """Count items of an earlier value once more.

        Raises:
            StateError: the limit is exceeded.
        """
        self._items += items
        self._repetitions += items
        if self._repetitions > _MOST:
            raise StateError("the saved state refers to the same values too often")
