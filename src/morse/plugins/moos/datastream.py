"""Sends and receives data streams as variables of a MOOS database."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.core.datastream import DatastreamManager
from morse.core.mapping import maps
from morse.plugins.moos import MANAGER_OPTIONS
from morse.plugins.moos.database import Database

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from morse.core.context import Context
    from morse.core.kinds import Message
    from morse.core.values import Options
    from morse.plugins.moos.streams import MoosPublisher, MoosStream

logger = logging.getLogger(__name__)


#: options that tell databases apart
_PLACE = ("moos_host", "moos_port", "moos_name")


class MOOSDatastreamManager(DatastreamManager):
    """Variables of sensors are published, and variables of actuators are registered.

    Streams with the same ``moos_host``, ``moos_port`` and ``moos_name`` share a connection. A stream that does not set
    them uses the options of the manager.
    """

    classpath = "morse.middleware.moos_datastream.MOOSDatastreamManager"
    manager_options = MANAGER_OPTIONS
    by_component = True

    def __init__(self, options: Options, context: Context) -> None:
        super().__init__(options, context)
        self._databases: dict[tuple[object, ...], Database] = {}
        self._takers: dict[tuple[Database, str], list[Callable[[str, float | str], object]]] = {}
        self._owners: dict[tuple[Database, str], str] = {}

    def database_of(self, options: Mapping[str, object]) -> Database:
        """The connection of a stream with these options."""
        own_options = {name: options[name] for name in _PLACE if options[name] is not None}
        all_options = {**self.options, **own_options}
        place = tuple(all_options[name] for name in _PLACE)
        if place not in self._databases:
            database = self._databases[place] = Database(all_options)
            logger.info("moos: the database is expected at %s", database.place)
        return self._databases[place]

    def wanted(self, stream: MoosStream, topic: str) -> bool:
        """Whether the database is connected."""
        return stream.database.connected

    @maps("general")
    def general(self, stream: MoosPublisher, message: Message) -> None:
        """The variables of a sensor."""
        for name, value in stream.variables(stream.database.connections):
            stream.database.publish(name, value)

    def claim(self, database: Database, variable: str, name: str) -> None:
        """Log if two components publish the same variable: 1.4 has no names of robots in some variables."""
        owner = self._owners.setdefault((database, variable), name)
        if owner != name:
            logger.warning(
                "moos: %s and %s publish the same variable %s; set prefix='...' for one of them", owner, name, variable
            )

    def listen(self, database: Database, variable: str, take: Callable[[str, float | str], object]) -> None:
        """Call ``take`` before each tick with the variables that have arrived."""
        takers = self._takers.setdefault((database, variable), [])
        takers.append(take)
        if len(takers) == 1:
            database.register(variable)

    def ignore(self, database: Database, variable: str, take: Callable[[str, float | str], object]) -> None:
        """End `listen`."""
        takers = self._takers.get((database, variable), [])
        if take in takers:
            takers.remove(take)
        if not takers and self._takers.pop((database, variable), None) is not None:
            database.unregister(variable)

    def closed(self, stream: Any) -> None:
        """Release the variables of a component."""
        self._owners = {key: owner for key, owner in self._owners.items() if owner != stream.component_name}

    def action(self) -> None:
        """Pass on the variables that have arrived."""
        for database in self._databases.values():
            for variable, value in database.received():
                for take in self._takers.get((database, variable), ()):
                    take(variable, value)

    def drain(self) -> None:
        """See `DatastreamManager.drain`."""
        self.action()

    def finalize(self) -> None:
        """Disconnect."""
        super().finalize()
        for database in self._databases.values():
            database.close()
