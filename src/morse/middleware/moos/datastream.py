"""Sends and receives data streams as variables of a MOOS database."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.core.datastream import DatastreamManager
from morse.core.mapping import maps
from morse.middleware.moos.database import Database
from morse.middleware.moos.mapping import MANAGER_OPTIONS

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.context import Context
    from morse.middleware.moos.streams import MoosPublisher

logger = logging.getLogger(__name__)


class MOOSDatastreamManager(DatastreamManager):
    """Variables of sensors are published, and variables of actuators are registered.

    Attributes:
        database: the connection.
    """

    classpath = "morse.middleware.moos_datastream.MOOSDatastreamManager"
    manager_options = MANAGER_OPTIONS

    def __init__(self, options: dict[str, Any], context: Context) -> None:
        super().__init__(options, context)
        self.database = Database(self.options)
        logger.info("moos: the database is expected at %s", self.database.place)
        self._takers: dict[str, list[Callable[[str, float | str], object]]] = {}
        self._owners: dict[str, str] = {}

    @maps("general")
    def general(self, stream: MoosPublisher) -> None:
        """The variables of a sensor."""
        stream.publish()

    def claim(self, variable: str, name: str) -> None:
        """Log if two components publish the same variable: 1.4 has no names of robots in some variables."""
        owner = self._owners.setdefault(variable, name)
        if owner != name:
            logger.warning(
                "moos: %s and %s publish the same variable %s; set prefix='...' for one of them", owner, name, variable
            )

    def listen(self, variable: str, take: Callable[[str, float | str], object]) -> None:
        """Call ``take`` before each tick with the variables that have arrived."""
        takers = self._takers.setdefault(variable, [])
        takers.append(take)
        if len(takers) == 1:
            self.database.register(variable)

    def ignore(self, variable: str, take: Callable[[str, float | str], object]) -> None:
        """End `listen`."""
        takers = self._takers.get(variable, [])
        if take in takers:
            takers.remove(take)
        if not takers and self._takers.pop(variable, None) is not None:
            self.database.unregister(variable)

    def closed(self, stream: Any) -> None:
        """Release the variables of a component."""
        self._owners = {key: owner for key, owner in self._owners.items() if owner != stream.component_name}

    def action(self) -> None:
        """Pass on the variables that have arrived."""
        for variable, value in self.database.received():
            for take in self._takers.get(variable, ()):
                take(variable, value)

    def drain(self) -> None:
        """See `DatastreamManager.drain`."""
        self.action()

    def finalize(self) -> None:
        """Disconnect."""
        super().finalize()
        self.database.close()
