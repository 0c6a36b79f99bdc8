"""The data of a sensor in many ticks: a tick keeps a row, and the thread of the recording takes columns."""

from __future__ import annotations

from bisect import bisect_right
from operator import itemgetter
from struct import Struct
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.recording.fields.messages import NUMBERS, Written

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from morse.core.values import Fields
    from morse.recording.fields.messages import Keeper

#: number of values of a row in the flat list
_STRIDE = 3
#: number of rows after which their size is determined again
_LOOK = 16


class Rows(NamedTuple):
    """The data of R ticks.

    Attributes:
        ticks: (R,) numbers of the ticks.
        columns: of each field: (R,) numbers, (R, ...) arrays, or a list of R values that a `Keeper` returned.
        live: of each value that does not follow from the fields, the R values.
    """

    ticks: NDArray[np.int64]
    columns: Mapping[str, Any]
    live: Sequence[Sequence[Any]]

    def some(self, part: slice) -> Rows:
        """Some of the ticks."""
        columns = {name: column[part] for name, column in self.columns.items()}
        return Rows(self.ticks[part], columns, [values[part] for values in self.live])


def runs_of(parts: Sequence[Rows]) -> list[Rows]:
    """The rows in the order of their ticks: those of consecutive ticks of one part together."""
    if len(parts) < 2:
        return list(parts)
    ticks = np.concatenate([rows.ticks for rows in parts])
    owners = np.repeat(np.arange(len(parts)), [len(rows.ticks) for rows in parts])
    places = np.concatenate([np.arange(len(rows.ticks)) for rows in parts])
    order = np.argsort(ticks, kind="stable")
    changes = np.flatnonzero(np.diff(owners[order])) + 1
    return [parts[owners[run[0]]].some(slice(places[run[0]], places[run[-1]] + 1)) for run in np.split(order, changes)]


class Columns:
    """Keeps the values of fields whose types stay the same.

    Args:
        names: of the fields.
        kinds: types of their values.
        keeper: of the thread of the simulation.
        live: return values that do not follow from the fields.

    Attributes:
        size: approximate size of a row, bytes.
    """

    def __init__(
        self, names: Sequence[str], kinds: Sequence[type], keeper: Keeper, live: Sequence[Callable[[], object]]
    ) -> None:
        numbers = [index for index, kind in enumerate(kinds) if kind in NUMBERS]
        others = [index for index, kind in enumerate(kinds) if kind not in NUMBERS]
        self._number_names = [names[index] for index in numbers]
        self._other_names = [names[index] for index in others]
        form = "".join(NUMBERS[kinds[index]] for index in numbers)
        self._dtype = np.dtype([(name, f"<{letter}") for name, letter in zip(self._number_names, form, strict=True)])
        self._pack = Struct(f"<{form}").pack
        self._numbers = _getter(numbers)
        self._others = [(index, keeper.way_of(kinds[index])) for index in others]
        self._live = list(live)
        self._is_plain = not (self._others or self._live)
        self.size = self._dtype.itemsize
        self._row_count = 0
        # each operation on a list is atomic: the simulation appends, and only the thread of the recording removes
        self._rows: list[Any] = []

    def keep(self, tick: int, values: Sequence[object]) -> int:
        """Keep the values of a tick, and return their approximate size, bytes.

        Raises:
            struct.error: an integer has more than 64 bits.
        """
        data = self._pack(*self._numbers(values))
        if self._is_plain:
            self._rows += (tick, data, None)
            return self.size
        others = [values[index] if way is None else way(values[index]) for index, way in self._others]
        others += [live() for live in self._live]
        self._rows += (tick, data, others)
        self._row_count += 1
        if self._row_count % _LOOK == 1:
            self.size = self._dtype.itemsize + sum(map(_size, others))
        return self.size

    def take(self, until: int) -> Rows | None:
        """Return the rows up to a tick, and forget them; None if there are none."""
        some = self._rows[:]
        ticks = some[::_STRIDE]
        count = bisect_right(ticks, until)
        if not count:
            return None
        del self._rows[: _STRIDE * count]
        rows_of_numbers, others = some[1 : _STRIDE * count : _STRIDE], some[2 : _STRIDE * count : _STRIDE]
        columns: Fields = {}
        if self._number_names:
            numbers = np.frombuffer(b"".join(rows_of_numbers), dtype=self._dtype)
            columns.update({name: np.ascontiguousarray(numbers[name]) for name in self._number_names})
        live: Sequence[Sequence[object]] = ()
        if not self._is_plain:
            values = list(zip(*others, strict=True))
            columns.update(zip(self._other_names, values, strict=False))
            live = values[len(self._other_names) :]
        return Rows(np.array(ticks[:count], dtype=np.int64), columns, live)


def _getter(indices: Sequence[int]) -> Callable[[Sequence[object]], Sequence[object]]:
    if len(indices) > 1:
        return itemgetter(*indices)
    return lambda values: [values[index] for index in indices]


def _size(value: object) -> int:
    if isinstance(value, np.ndarray):
        return int(value.nbytes)
    return 100 if isinstance(value, Written) else 16
