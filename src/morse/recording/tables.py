"""Messages as rows of tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.exceptions import MorseError
from morse.recording.errors import RecordingError
from morse.rosmsgs.cdr import CdrError, decode
from morse.rosmsgs.definitions import PRIMITIVES, SEQUENCE, SINGLE, fields_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.core.values import RosMessage, Value
    from morse.recording.mcap.records import Message
    from morse.rosmsgs.definitions import MessageField

#: maximum length of fixed arrays with one column for each item
_MOST_ITEMS = 36
#: the columns before those of the message: simulated time (s), the same without the jumps of restarts, number of ticks
FIRST = ("time", "log_time", "tick")


class Table:
    """The messages of one type as rows.

    A column has the name of its field: ``pose.position.x``, ``header.frame_id``. A message that only contains a list of
    others, such as ``tf2_msgs/TFMessage``, gives a row for each of them.

    Args:
        type_name: of the messages, ``geometry_msgs/msg/PoseStamped``.
        without_data: leave out fields of bytes (images, point clouds).

    Attributes:
        columns: name and type, of `PRIMITIVES` or ``string``, with ``[]`` at the end for a list; a list of messages
            has the type ``json``.
        left_out: fields without a column.

    Raises:
        RecordingError: the type is not known.
    """

    def __init__(self, type_name: str, *, without_data: bool = False) -> None:
        self.columns: list[tuple[str, str]] = list(zip(FIRST, ("float64", "float64", "int64"), strict=True))
        self.left_out: list[str] = []
        self._type = type_name
        self._without_data = without_data
        self._getters: list[Callable[[RosMessage], object]] = []
        try:
            fields = fields_of(type_name)
        except MorseError as error:
            raise RecordingError(str(error)) from None
        self._list = ""
        if len(fields) == 1 and fields[0].size == SEQUENCE and "/" in fields[0].type:
            self._list, fields = fields[0].name, fields_of(fields[0].type)
        self._add(fields, (), lambda message: message)

    def _add(
        self, fields: tuple[MessageField, ...], above: tuple[str, ...], owner: Callable[[RosMessage], Value]
    ) -> None:
        for field in fields:
            path = (*above, field.name)

            def get(message: RosMessage, name: str = field.name) -> Value:
                return owner(message)[name]

            if "/" in field.type and field.size == SINGLE:
                self._add(fields_of(field.type), path, get)
            else:
                self._column(".".join(path), field, get)

    def _column(self, name: str, field: MessageField, get: Callable[[RosMessage], Value]) -> None:
        if self._without_data and field.type == "uint8" and field.size == SEQUENCE:
            self.left_out.append(name)
        elif field.size == SINGLE:
            self.columns.append((name, field.type))
            self._getters.append(get)
        elif field.type in PRIMITIVES and 0 < field.size <= _MOST_ITEMS:
            for item in range(field.size):
                self.columns.append((f"{name}[{item}]", field.type))
                self._getters.append(lambda message, item=item: _plain(get(message)[item]))  # type: ignore[misc]
        else:
            is_plain = field.type in PRIMITIVES or field.type == "string"
            self.columns.append((name, f"{field.type}[]" if is_plain else "json"))
            self._getters.append(lambda message: get(message))

    def rows(self, one: Message) -> Iterator[list[Value]]:
        """The rows of a message.

        Raises:
            RecordingError: it is damaged.
        """
        try:
            message = decode(self._type, one.data)
        except (CdrError, ValueError) as error:
            raise RecordingError(f"a message of tick {one.sequence} is damaged: {error}") from None
        first = [one.publish_time / 1e9, one.log_time / 1e9, one.sequence]
        for row in message[self._list] if self._list else (message,):
            yield first + [get(row) for get in self._getters]


def _plain(value: object) -> Value:
    return value.item() if hasattr(value, "item") else value
