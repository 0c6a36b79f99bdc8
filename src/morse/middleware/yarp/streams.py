"""The streams of components: publishers send bottles, readers receive bottles."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.core.clients.complaints import Complaints
from morse.core.datastream import AbstractDatastream
from morse.core.kinds import bind
from morse.core.validation import ClientCommands
from morse.middleware.yarp.bottle import as_dict
from morse.middleware.yarp.mapping import STREAM_OPTIONS
from morse.middleware.yarp.waiting import WaitingBottles

if TYPE_CHECKING:
    from collections.abc import Callable, Sized

    from morse.core.object import Object

logger = logging.getLogger(__name__)

#: number of bottles that wait for the next action of an actuator
_MOST_WAITING = 64


class YarpStream(AbstractDatastream):
    """A stream with a port."""

    options = STREAM_OPTIONS
    _end = ""

    def initialize(self) -> None:
        """Open the port.

        Raises:
            MorseMiddlewareError: its name is not one of YARP, or another component has it.
        """
        self.complaints = Complaints(logger)
        path = f"{self.component_name.replace('.', '/')}/{self._end}"
        name = self.kwargs["port"] or self.manager.ports.name(path)
        self.port = self.manager.ports.open(name, self.component_name, self._taker())

    def _taker(self) -> Callable[[list[Any], int], object] | None:
        return None

    def finalize(self) -> None:
        """Close the port."""
        self.manager.ports.close(self.port)


class YarpPublisher(YarpStream):
    """Sends the values of a component as a bottle at each of its actions; pixels as an image."""

    _end = "out"

    def initialize(self) -> None:
        """Determine the form of the bottles."""
        self.kinds = bind(self.component_instance)
        main = next((bound for bound in self.kinds if not bound.topic), None)
        self._form = self.form(main.kind.name if main else "general")
        super().initialize()

    def form(self, kind: str) -> Callable[[YarpPublisher], bytes | None]:
        """The function that makes the bottles."""
        has_points = "point_list" in self.data
        found: Callable[[YarpPublisher], bytes | None] = (
            self.manager.points if has_points else self.manager.mapping(kind)
        )
        return found

    def default(self, ci: Object | None = None) -> bool:
        """Send the data if another port is connected."""
        if self.port.outputs:
            try:
                data = self._form(self)
            except (ValueError, TypeError) as error:
                self.complaints.warn("form", f"{self.component_name}: a message for YARP is left out: {error}")
                return False
            if data is not None:
                self.manager.send(self.port, data)
        return False


class YarpReader(YarpStream):
    """Writes the values of bottles into the data of an actuator, in the order of its fields.

    A bottle may have fewer values than the actuator has fields; the others keep their values. A bottle with a wrong
    value is refused as a whole.
    """

    _end = "in"

    def initialize(self) -> None:
        """Listen."""
        self._arrived: WaitingBottles[list[Any]] = WaitingBottles(
            _MOST_WAITING, Complaints(logger), f"{self.component_name}: bottles"
        )
        self._commands = ClientCommands(self.component_instance, logger, "bottle")
        self._fields = [name for name in self.data if name != "timestamp"]
        super().initialize()

    def _taker(self) -> Callable[[list[Any], int], object]:
        return self._arrived.append

    @property
    def waiting(self) -> Sized:
        """Bottles that have arrived."""
        return self._arrived

    def default(self, ci: Object | None = None) -> bool:
        """Process received bottles; True if there were any."""
        taken = False
        while self._arrived and not self._commands.rest:
            taken = self._commands.take(self.message, self._arrived.popleft()) or taken
        return taken

    def message(self, values: list[Any]) -> Any:
        """The fields of a bottle.

        Raises:
            ValueError: it does not fit.
        """
        if len(values) > len(self._fields):
            fields = ", ".join(self._fields)
            raise ValueError(f"it has {len(values)} values, expected at most {len(self._fields)}: {fields}")
        return {name: self._value(name, value) for name, value in zip(self._fields, values, strict=False)}

    def _value(self, name: str, value: Any) -> Any:
        known = self.data[name]
        if isinstance(known, bool) and type(value) is int and value in (0, 1):
            return bool(value)  # a bottle of 1.4 has no booleans
        if isinstance(known, dict) and isinstance(value, list):
            return as_dict(value) or value
        return value
