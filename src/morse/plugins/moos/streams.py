"""The streams of components: publishers set variables, readers take variables."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.exceptions import MorseMiddlewareError
from morse.core.reports.quoting import shown
from morse.core.streams.kind_stream import KindStream
from morse.plugins.moos import STREAM_OPTIONS
from morse.plugins.moos.variables import commands_of, constants_of, form_of
from morse.wire.encoding import from_json

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator

    from morse.core.values import Fields
    from morse.plugins.moos.database import Database
    from morse.plugins.moos.datastream import MOOSDatastreamManager

#: words for a boolean field
_WORDS = {"true": True, "on": True, "1": True, "false": False, "off": False, "0": False}
#: maximum size of a command, characters
_LONGEST = 1 << 16


class MoosStream(KindStream):
    """A stream with variables.

    Attributes:
        database: the connection.
    """

    options = STREAM_OPTIONS
    manager: MOOSDatastreamManager

    def initialize(self) -> None:
        """Check the prefix, and find the database.

        Raises:
            MorseMiddlewareError: it is no part of a name of MOOS.
        """
        super().initialize()
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
        self._connection = 0
        self._is_claimed = False

    def variables(self, connection: int) -> Iterator[tuple[str, float | str]]:
        """The variables of a measurement; with the constants in the first one of each connection.

        Args:
            connection: number of the connection.
        """
        constants = constants_of(self.component_instance) if connection != self._connection else ()
        self._connection = connection
        for name, value in constants:
            yield f"{self.prefix}_{name}", value
        for name, value in self._form(self.component_instance):
            variable = f"{self.prefix}_{name}"
            if not self._is_claimed:
                self._is_claimed = True
                self.manager.claim(self.database, variable, self.component_name)
            yield variable, value


class MoosReader(MoosStream):
    """Writes variables into the data of an actuator; of several values of a variable, the last one."""

    what = "command"

    def initialize(self) -> None:
        """Register the variables."""
        super().initialize()
        #: the last value of each field that has arrived
        self._values: Fields = {}
        self.fields = {f"{self.prefix}_{name}": field for name, field in commands_of(self.component_instance).items()}
        for variable in self.fields:
            self.manager.listen(self.database, variable, self.take)

    def finalize(self) -> None:
        """End the registrations."""
        for variable in self.fields:
            self.manager.ignore(self.database, variable, self.take)

    @property
    def waiting(self) -> Collection[object]:
        """Fields that have arrived."""
        return self._values

    def take(self, variable: str, value: float | str) -> None:
        """Keep the value of a variable that has arrived."""
        field = self.fields[variable]
        try:
            self._values[field] = self._read_value(field, value)
        except ValueError as error:
            self.complain(variable, f"{variable} is refused: {error}: {shown(value)}")

    def _read_value(self, field: str, value: object) -> object:
        present = self.data.get(field)
        if isinstance(value, bytes) or (isinstance(value, str) and len(value) > _LONGEST):
            raise ValueError("expected a number or a short string")
        if isinstance(present, bool):
            word = str(value).strip().lower() if isinstance(value, str) else str(int(value != 0.0))
            if word not in _WORDS:
                raise ValueError(f"expected one of {', '.join(_WORDS)}")
            return _WORDS[word]
        if isinstance(present, str) or not isinstance(value, str):
            return value
        return from_json(value.encode("utf-8", "replace"))

    def arrived(self) -> Iterable[Fields]:
        """The fields that have arrived, one by one: a wrong variable does not invalidate the others."""
        if not self._values or self.rests:
            return ()
        fields, self._values = self._values, {}
        return [{field: value} for field, value in fields.items()]
