"""The stream of a recorded sensor: a tick keeps its data, and the thread of the recording makes messages of them."""

from __future__ import annotations

import json
from functools import partial
from operator import attrgetter
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.kinds import GENERAL, Message, fields_of
from morse.core.kinds.binding import as_slot
from morse.core.rows.columns import columns_of
from morse.core.rows.marks import known_data
from morse.core.sensor import Sensor
from morse.core.streams.local_data import Later
from morse.recording.fields import CLASS, COMPONENT, DECLARED, FIELDS, FIELDS_TYPE
from morse.recording.fields.blocks import encode_block
from morse.recording.fields.columns import UNFIT, Batch, Columns, Line, messages_of, runs_of
from morse.rosmsgs.cdr import encode
from morse.rosmsgs.names import cleaned
from morse.rosmsgs.table import Qos
from morse.rosmsgs.topics.stream import TopicStream

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Sequence

    from numpy.typing import NDArray

    from morse.core.kinds import BoundKind
    from morse.core.object import Object
    from morse.core.values import Fields, Value
    from morse.recording.fields.columns import Keeper, Rows
    from morse.recording.streams import RecordedStreams
    from morse.rosmsgs.topics.stream import Sending

    #: names of fields and types of their values
    _Key = tuple[tuple[str, ...], tuple[type, ...]]


class RecordedStream(TopicStream):
    """Keeps the data fields of a sensor, and the parts of its messages that do not follow from these."""

    manager: RecordedStreams

    def initialize(self) -> None:
        """Open the topics in the file."""
        super().initialize()
        component = self.component_instance
        #: None: messages are encoded in the tick
        self._topic_file = topic_file = self.manager.topic_file
        self._clock = component.clock
        self._keeper: Keeper = self.manager.keeper
        #: by names of the fields and types of their values
        self._layouts: dict[_Key, tuple[Columns, Sequence[Line]]] = {}
        self._choices: dict[_Key, tuple[str, ...]] = {}
        topic = f"{FIELDS}/{cleaned(self.component_name)}"
        self._fields = 0
        if topic_file is not None:
            self._fields = topic_file.topic(topic, FIELDS_TYPE, Qos(100), described(component)).number
            topic_file.kept.append(self)
        #: rows of the data that were kept with those of other sensors
        self._together: list[Rows] = []
        self._lines_with_numbers = [
            (bound, line, number)
            for bound, lines in self.sending
            for line in lines
            if (number := getattr(line.publisher, "number", None)) is not None
        ]
        #: the messages, and functions that return what does not follow from the fields
        self.form: tuple[Sequence[Line], Sequence[Callable[[], Any]]] = self._lines_of_rows()
        self._in_rows = self.manager.rows is not None and self._follows_from_rows()
        if self.manager.rows is not None and self._in_rows:
            self.manager.rows.add(self)

    def _follows_from_rows(self) -> bool:
        """Whether all data and messages follow from columns, see `morse.core.rows.columns`."""
        component = self.component_instance
        columns = columns_of(type(component))
        is_on_demand = isinstance(component, Sensor) and component.on_demand  # it is not a row
        if (
            columns is None
            or is_on_demand
            or self.moves_frames
            or any(bound.kind.name == GENERAL for bound, _ in self.sending)
        ):
            return False
        fields = fields_of(component)
        others = known_data(component).keys() - {"timestamp", *columns.fields}
        return all(name in fields and fields[name].follows for name in others) and all(
            line.ready is None and line.message is None for line in self.form[0]
        )

    def take_over(self, rows: Rows) -> None:
        """Encode these rows with the next `batches`, in the thread of the recording."""
        self._together.append(rows)

    # -- the tick ----------------------------------------------------------------------------

    @property
    def waiting(self) -> Collection[Any] | None:
        """See `AbstractDatastream.waiting`: nothing waits if the data are kept with those of other sensors."""
        return () if self._in_rows else None

    def default(self, ci: Object | None = None) -> bool:
        """Keep the present data."""
        topic_file = self._topic_file
        if topic_file is None:
            return super().default(ci)
        component = self.component_instance
        if isinstance(component, Sensor) and component.capturing is False:
            return False
        data: Fields = component.local_data
        values = tuple(dict.values(data))
        key = tuple(dict.keys(data)), tuple(map(type, values))
        if Later in key[1]:
            values, key = self._measured(data, key)
        form = self._layouts.get(key)
        if form is None:
            form = self._layouts[key] = self._form(*key)
        topic_file.held += form[0].keep(self._clock.tick, values)
        for bound in self.kinds:
            if self.moves(bound.topic):
                self.manager.transforms.moved(self, self.motion(bound.gather()).pose)
        return False

    def _measured(self, data: Fields, key: _Key) -> tuple[tuple[object, ...], _Key]:
        """The values of fields, without those that are computed on demand and follow from others."""
        names = self._choices.get(key)
        if names is None:
            names = self._choices[key] = tuple(self._choose(data))
        values_now = [dict.__getitem__(data, name) for name in names]
        # an array that is made here is nobody else's
        values = tuple([value.make() if type(value) is Later else value for value in values_now])
        return values, (names, tuple(map(type, values_now)))

    def _choose(self, data: Fields) -> Iterator[str]:
        fields = fields_of(self.component_instance)
        general = any(bound.kind.name == GENERAL for bound, _ in self.sending)
        for name, value in dict.items(data):
            if general or type(value) is not Later or not (name in fields and fields[name].follows):
                yield name

    def _form(self, names: tuple[str, ...], kinds: tuple[type, ...]) -> tuple[Columns, Sequence[Line]]:
        lines, live = self.form
        return Columns(names, kinds, self._keeper, live), lines

    def _lines_of_rows(self) -> tuple[list[Line], list[Callable[[], object]]]:
        component = self.component_instance
        sources = [
            source for bound, line, _ in self._lines_with_numbers if line.outlet.by_rows for _, source in bound.sources
        ]
        properties = tuple(dict.fromkeys(name for source in sources for name in source.properties))
        live: list[Callable[[], object]] = []
        if properties:
            live.append(partial(_tuple_getter(properties), component))
        lines = []
        for bound, line, number in self._lines_with_numbers:
            outlet, frame = line.outlet, self.frame_id(line.outlet.frame or bound.frame)
            row_line = Line(number, line.topic, outlet, frame, bound)
            if outlet.by_rows and bound.component is component:
                places: list[int | None] = []
                for index, (slot, source) in enumerate(bound.sources):
                    is_live = bound.is_live(slot, source)
                    places.append(len(live) if is_live else None)
                    live += [partial(self._slot, bound, index)] * is_live
                row_line = row_line._replace(properties=properties, slots=places)
            elif outlet.takes_long:
                row_line = row_line._replace(message=len(live))
                live.append(partial(self._message, bound))
            else:
                row_line = row_line._replace(ready=len(live))
                live.append(partial(self._encoded, line, bound, frame))
            lines.append(row_line)
        return lines, live

    def _slot(self, bound: BoundKind, index: int) -> object:
        value = bound.value_of(index, self.component_instance)
        return None if value is None else _own(as_slot(bound.sources[index][0], value))

    @staticmethod
    def _message(bound: BoundKind) -> Message | None:
        if bound.is_silent:
            return None
        message = bound.gather()
        slots = {name: _own(value) for name, value in message.slots.items()}
        return Message(message.kind, message.stamp, message.frame, slots, slots, message.topic)

    def _encoded(self, line: Sending, bound: BoundKind, frame: str) -> bytes | None:
        if bound.is_silent:
            return None
        try:
            content = line.outlet.make(bound.gather(), frame)
            return None if content is None else encode(line.outlet.type, content)
        except UNFIT as error:
            self._leave_out(line, error)
            return None

    def _leave_out(self, line: Line | Sending, error: BaseException) -> None:
        self.complain(
            f"encode {line.topic}",
            f"a message for {line.topic} is not a valid {line.outlet.type} and is omitted: {error}",
        )

    # -- the thread of the recording ---------------------------------------------------------

    def batches(self, until: int, times: Callable[[NDArray[np.int64]], NDArray[np.int64]]) -> Iterator[Batch]:
        """Encode what was kept up to a tick.

        Args:
            until: number of the tick.
            times: returns the log times of ticks, ns.
        """
        parts = [(rows, lines) for columns, lines in list(self._layouts.values()) if (rows := columns.take(until))]
        while self._together:
            parts.append((self._together.pop(0), self.form[0]))
        for rows in runs_of([rows for rows, _ in parts]):
            block = encode_block(rows.ticks, times(rows.ticks), rows.columns)
            yield Batch(self._fields, rows.ticks[:1], [encode(FIELDS_TYPE, {"data": block})])
        for rows, lines in parts:
            stamps = self._stamps(rows)
            for line in lines:
                yield from messages_of(line, rows, stamps, self._leave_out)

    def _stamps(self, rows: Rows) -> NDArray[np.int64]:
        """The times of the measurements, whole ns."""
        clock, stamps = self._clock, self._clock.stamps_of(rows.ticks)
        times = rows.columns.get("timestamp")
        if times is None:
            return stamps
        present: object = clock.origin + rows.ticks / clock.frequency
        late = np.flatnonzero(times != present) if isinstance(times, np.ndarray) else range(len(stamps))
        for row in late:
            stamps[row] = clock.stamp_at(times[row], int(rows.ticks[row]))
        return stamps


def _tuple_getter(names: tuple[str, ...]) -> Callable[[object], tuple[object, ...]]:
    get = attrgetter(*names)
    return get if len(names) > 1 else lambda component: (get(component),)


def _own(value: object) -> Value:
    """Arrays that nobody else changes."""
    return value.copy() if isinstance(value, np.ndarray) else value


def described(component: Object) -> dict[str, str]:
    """The declarations of the fields of a component, as named strings of a channel."""
    fields = [
        {
            "name": name,
            "type": field.dtype or field.type,
            **({"shape": field.shape} if field.shape is not None else {}),
            **{key: value for key in ("unit", "frame") if (value := getattr(field, key))},
        }
        for name, field in fields_of(component).items()
    ]
    path = f"{type(component).__module__}.{type(component).__qualname__}"
    return {COMPONENT: component.name(), CLASS: path, DECLARED: json.dumps(fields)}
