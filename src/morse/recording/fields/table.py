"""Data fields as rows of tables."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.recording.errors import RecordingError
from morse.recording.fields import DECLARED
from morse.recording.fields.reading import block_of
from morse.recording.tables import FIRST

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.recording.mcap.reader import Channel
    from morse.recording.mcap.records import Message

#: type of a column and its values in Python, by the declared type of a field
_SINGLE: dict[str, tuple[str, tuple[type, ...]]] = {
    "float": ("float64", (float, int)),
    "int": ("int64", (int,)),
    "integer": ("int64", (int,)),
    "bool": ("bool", (bool,)),
    "string": ("string", (str,)),
}
#: maximum number of fields of a component
_MOST = 1000


class FieldsTable:
    """The data fields of a component, one row for each measurement; see `morse.recording.tables.Table`.

    Args:
        channel: of the fields.
        path: of the file, for errors.
        without_data: leave out images and clouds.

    Attributes:
        columns, left_out: as those of `Table`. Lists, arrays and structures have the type ``json``.

    Raises:
        RecordingError: the declarations of the fields are damaged.
    """

    def __init__(self, channel: Channel, path: str, *, without_data: bool = False) -> None:
        self.columns: list[tuple[str, str]] = list(zip(FIRST, ("float64", "float64", "int64"), strict=True))
        self.left_out: list[str] = []
        self._path = path
        self._fields: list[tuple[str, tuple[type, ...]]] = []
        try:
            declarations = json.loads(channel.metadata[DECLARED])[:_MOST]
            for field in declarations:
                name, kind, shape = str(field["name"]), str(field["type"]), field.get("shape")
                if without_data and isinstance(shape, list) and len(shape) > 1:
                    self.left_out.append(name)
                    continue
                column, types = _SINGLE.get(kind, ("json", (object,)))
                self.columns.append((name, column))
                self._fields.append((name, types))
        except (ValueError, LookupError, TypeError, RecursionError) as error:
            raise RecordingError(f"the declarations of its fields are damaged: {error}") from None

    def rows(self, one: Message) -> Iterator[list[Any]]:
        """The rows of a message; a value of another type than its column is None.

        Raises:
            RecordingError: it is damaged.
        """
        block = block_of(one, self._path)
        for row in range(len(block)):
            fields = block.row(row)
            values = [_fitting(fields.values.get(name), types) for name, types in self._fields]
            yield [(fields.time - one.log_time + one.publish_time) / 1e9, fields.time / 1e9, fields.tick, *values]


def _fitting(value: object, types: tuple[type, ...]) -> object:
    if types == (object,):
        return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value
    is_number = bool not in types and isinstance(value, bool)
    return value if isinstance(value, types) and not is_number else None
