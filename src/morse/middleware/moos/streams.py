"""The streams of components: publishers set variables, readers take variables."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.core.datastream import AbstractDatastream
from morse.core.exceptions import MorseMiddlewareError
from morse.core.reports.quoting import shown
from morse.core.validation import ClientCommands
from morse.middleware.moos.mapping import STREAM_OPTIONS
from morse.middleware.moos.variables import commands_of, constants_of, form_of
from morse.wire.encoding import from_json

if TYPE_CHECKING:
    from collections.abc import Collection

    from morse.core.object import Object
    from morse.middleware.moos.database import Database

logger = logging.getLogger(__name__)

#: words for a boolean field
_WORDS = {"true": True, "on": True, "1": True, "false": False, "off": False, "0": False}
#: maximum size of a command, characters
_LONGEST = 1 << 16


class MoosStream(AbstractDatastream):
    """A stream with variables.

    Attributes:
        database: the connection.
    """

    options = STREAM_OPTIONS

    def initialize(self) -> None:
        """Check the prefix, and find the database.

        Raises:
            MorseMiddlewareError: it is no part of a name of MOOS.
        """
        self.prefix = self.kwargs["prefix"]
        if not self.prefix.isprintable() or any(letter in self.prefix for letter in " ,=*?") or not self.prefix:
            raise MorseMiddlewareError(
                f"{self.component_name}: the prefix is {shown(self.prefix)}, expected a part of a name, such as 'MORSE'"
            )
        self.database: Database = self.manager.database_of(self.kwargs)


class MoosPublisher(MoosStream):
    """Publishes the data of a sensor at each of its measurements."""

    def initialize(self) -> None:
        """Determine the variables."""
        super().initialize()
        self._form = form_of(self.component_instance)
        self._has_constants = False
        self._claimed = False

    def default(self, ci: Object | None = None) -> bool:
        """Publish the data if a database is connected."""
        if self.database.connected:
            self.publish()
        else:
            self._has_constants = False
        return False

    def publish(self) -> None:
        """Publish the variables; constants after each connection."""
        publish = self.database.publish
        if not self._has_constants:
            self._has_constants = True
            for name, value in constants_of(self.component_instance):
                publish(f"{self.prefix}_{name}", value)
        variables = [(f"{self.prefix}_{name}", value) for name, value in self._form(self.component_instance)]
        if not self._claimed:
            self._claimed = True
            for name, _ in variables[:1]:
                self.manager.claim(self.database, name, self.component_name)
        for name, value in variables:
            publish(name, value)


class MoosReader(MoosStream):
    """Writes variables into the data of an actuator; of several values of a variable, the last one."""

    def initialize(self) -> None:
        """Register the variables."""
        super().initialize()
        self._arrived: dict[str, Any] = {}
        self._commands = ClientCommands(self.component_instance, logger, "command")
        self._fields = {f"{self.prefix}_{name}": field for name, field in commands_of(self.component_instance).items()}
        for variable in self._fields:
            self.manager.listen(self.database, variable, self._take)

    def finalize(self) -> None:
        """End the registrations."""
        for variable in self._fields:
            self.manager.ignore(self.database, variable, self._take)

    @property
    def waiting(self) -> Collection[Any]:
        """Fields that have arrived."""
        return self._arrived

    def _take(self, variable: str, value: float | str) -> None:
        field = self._fields[variable]
        try:
            self._arrived[field] = self._read(field, value)
        except ValueError as error:
            self._commands.complain(variable, f"{variable} is refused: {error}: {shown(value)}")

    def _read(self, field: str, value: Any) -> Any:
        known = self.data.get(field)
        if isinstance(value, bytes) or (isinstance(value, str) and len(value) > _LONGEST):
            raise ValueError("expected a number or a short string")
        if isinstance(known, bool):
            word = str(value).strip().lower() if isinstance(value, str) else str(int(value != 0.0))
            if word not in _WORDS:
                raise ValueError(f"expected one of {', '.join(_WORDS)}")
            return _WORDS[word]
        if isinstance(known, str) or not isinstance(value, str):
            return value
        return from_json(value.encode("utf-8", "replace"))

    def default(self, ci: Object | None = None) -> bool:
        """Take the fields that have arrived; True if there were any."""
        if not self._arrived or self._commands.rest:
            return False
        fields = list(self._arrived.items())
        self._arrived.clear()
        # a wrong variable does not invalidate the others
        taken = False
        for field, value in fields:
            taken = self._commands.take(dict, [(field, value)]) or taken
        return taken
