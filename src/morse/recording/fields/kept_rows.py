"""Keeps what sensors that measure when they are read have seen: a tick keeps one row for all of a class."""

from __future__ import annotations

from bisect import bisect_right
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol
from weakref import WeakKeyDictionary

import numpy as np

from morse.core.rows.columns import columns_of
from morse.recording.fields.columns import Rows

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.core.object import Object
    from morse.core.rows.columns import Columns
    from morse.core.rows.rows import SensorRows
    from morse.recording.fields.columns import Batch, Line

#: number of values of a row in the flat list
_STRIDE = 5
#: approximate size of a row without its data, bytes
_OVERHEAD, _POSE = 600, 96


class RowStream(Protocol):
    """A stream of one sensor; see `morse.recording.recorded_stream.RecordedStream`.

    Attributes:
        component_instance: the sensor.
        form: its messages, and functions that return what does not follow from the fields.
    """

    component_instance: Object
    form: tuple[Sequence[Line], Sequence[Callable[[], Any]]]

    def take_over(self, rows: Rows) -> None:
        """Encode these rows."""


class _Plan(NamedTuple):
    """What is kept of some sensors.

    Attributes:
        sensors: all sensors of the rows; another list whenever they change.
        members: those that are recorded.
        streams: their streams, and their places among the sensors.
        columns: of their class.
        live: return the values of each of them that do not follow from the fields.
        rows: what was kept in ticks, one value after the other.
    """

    sensors: Sequence[Any]
    members: Sequence[Any]
    streams: Sequence[tuple[RowStream, int]]
    columns: Columns
    live: Sequence[Sequence[Callable[[], Any]]]
    rows: list[Any]


class KeptRows:
    """Keeps poses and observations; the thread of the recording computes the fields.

    Args:
        context: of the simulation.
        topic_file: of the file; see `morse.recording.streams.TopicFile`.
    """

    def __init__(self, context: Context, topic_file: Any) -> None:
        self._context, self._topic_file = context, topic_file
        self._streams: dict[Any, RowStream] = {}
        self._plans: WeakKeyDictionary[SensorRows, _Plan | None] = WeakKeyDictionary()
        #: plans with rows that are not encoded yet, and those in use
        # each operation on their lists is atomic: the simulation appends, only the thread of the recording removes
        self._filled: list[_Plan] = []
        context.row_taps.append(self._measured)
        topic_file.kept.append(self)

    def close(self) -> None:
        """Keep nothing more."""
        if self._measured in self._context.row_taps:
            self._context.row_taps.remove(self._measured)

    def add(self, stream: RowStream) -> None:
        """Record a sensor whenever it measures on read."""
        self._streams[stream.component_instance] = stream
        self._plans.clear()

    def remove(self, stream: RowStream) -> None:
        """Remove a stream."""
        if self._streams.pop(stream.component_instance, None) is not None:
            self._plans.clear()

    # -- the tick ----------------------------------------------------------------------------

    def _measured(self, rows: SensorRows) -> None:
        plan = self._plans.get(rows)
        if plan is None or plan.sensors is not rows.sensors:
            plan = self._plan(rows.sensors)
            if plan is None:
                return
            self._plans[rows] = plan
            in_use = set(map(id, self._plans.values()))
            self._filled = [one for one in [*self._filled, plan] if one.rows or id(one) in in_use]
        keep, arrays = plan.columns.keep, list[Any]()
        size = _OVERHEAD + _POSE * len(plan.sensors)
        if keep is not None:
            arrays = [keep(member.observed) for member in plan.members]
            size += sum([one.nbytes for one in arrays])
        live = [[read() for read in reads] for reads in plan.live]
        plan.rows.extend((self._context.clock.tick, rows.time, rows.poses, arrays, live))
        self._topic_file.held += size

    def _plan(self, sensors: Sequence[object]) -> _Plan | None:
        streams = [(self._streams[one], place) for place, one in enumerate(sensors) if one in self._streams]
        if not streams:
            return None
        columns = columns_of(type(sensors[0]))
        assert columns is not None
        lives = [stream.form[1] for stream, _ in streams]
        members = [stream.component_instance for stream, _ in streams]
        return _Plan(sensors, members, streams, columns, lives if any(lives) else [], [])

    # -- the thread of the recording ---------------------------------------------------------

    def batches(self, until: int, times: Callable[[NDArray[np.int64]], NDArray[np.int64]]) -> Iterator[Batch]:
        """Give the streams what was kept of them; they encode it."""
        for plan in self._filled[:]:
            some = plan.rows[:]
            count = _STRIDE * bisect_right(some[::_STRIDE], until)
            if count:
                del plan.rows[:count]
                self._deal(plan, *(some[k:count:_STRIDE] for k in range(_STRIDE)))
        return iter(())

    @staticmethod
    def _deal(
        plan: _Plan,
        ticks: Sequence[int],
        times: Sequence[float],
        poses: Sequence[Any],
        arrays: Sequence[Any],
        lives: Sequence[Any],
    ) -> None:
        numbers, stamps = np.array(ticks, dtype=np.int64), np.array(times)
        fields = plan.columns.of(poses, arrays)
        for index, (stream, place) in enumerate(plan.streams):
            column = index if plan.columns.keep else place
            values = {"timestamp": stamps, **{name: each[column] for name, each in fields.items()}}
            live = list(zip(*[each[index] for each in lives], strict=True)) if plan.live else ()
            stream.take_over(Rows(numbers, values, live))
