"""Streams whose bottles have one value, a JSON text."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.middleware.yarp.streams import YarpPublisher, YarpReader
from morse.wire.encoding import from_json

if TYPE_CHECKING:
    from collections.abc import Callable


class YarpJsonPublisher(YarpPublisher):
    """Sends the data of a component as a JSON text."""

    def form(self, kind: str) -> Callable[[YarpPublisher], bytes | None]:
        """The function that makes the bottles."""
        found: Callable[[YarpPublisher], bytes | None] = self.manager.general
        return found


class YarpJsonReader(YarpReader):
    """Writes the fields of JSON objects into the data of an actuator."""

    def message(self, values: list[Any]) -> Any:
        """The fields of a bottle.

        Raises:
            ValueError: it is not a JSON text.
        """
        if len(values) != 1 or not isinstance(values[0], str):
            raise ValueError("expected one JSON text")
        return from_json(values[0].encode("utf-8", "replace"))
