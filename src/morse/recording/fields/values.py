"""What a tick keeps of the values of data fields, which may change afterwards."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.core.state import NoReferences, Reader, Writer
from morse.core.streams.local_data import Later

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.values import Value

#: the format of numbers for `struct`, by their type
NUMBERS = {float: "d", int: "q", bool: "?"}
_CONSTANT = frozenset((float, int, bool, str, type(None)))


class Written(NamedTuple):
    """A value of any other kind, as plain data; see `morse.core.state.Writer`."""

    data: Value

    def value(self) -> Value:
        """The value."""
        return Reader(NoReferences()).value(self.data)


class Keeper:
    """Keeps values; for one thread."""

    def __init__(self) -> None:
        self._writer = Writer(NoReferences())
        self._ways: dict[type, Callable[[Value], object]] = {
            **dict.fromkeys((float, int, bool, str, np.float64), _itself),
            np.ndarray: self._array,
            list: self._list,
            Later: self._made,
        }

    def kept(self, value: object) -> Value:
        """Return a copy: of numbers, words, arrays and flat lists of these as they are, of others as `Written`."""
        way = self._ways.get(type(value))
        return self.written(value) if way is None else way(value)

    def way_of(self, kind: type) -> Callable[[Value], object] | None:
        """The function that keeps values of a type; None if they are constant."""
        way = self._ways.get(kind, self.written)
        return None if way is _itself else way

    def written(self, value: object) -> Written:
        """Return a value as plain data; None in place of an object that cannot be written."""
        data = self._writer.value(value)
        self._writer.release()
        self._writer.unsaved.clear()
        return Written(data)

    def _array(self, value: Value) -> Value:
        if value.dtype.kind not in "biuf":
            return self.written(value)
        copy = value.copy()
        copy.flags.writeable = False
        return copy

    def _made(self, value: object) -> object:
        """A value that was made for the recording."""
        return value if type(value) is np.ndarray and value.dtype.kind in "biuf" else self.kept(value)

    def _list(self, value: list[object]) -> object:
        return value[:] if _CONSTANT.issuperset(map(type, value)) else self.written(value)


def _itself(value: object) -> object:
    return value
