"""Commands that expire: without new ones, an actuator does what it did before the first."""

from __future__ import annotations

import logging
from copy import deepcopy
from typing import TYPE_CHECKING, Any

from morse.core.complaints import Complaints
from morse.core.datastream import AbstractDatastream
from morse.core.declarations import fields_of_component

if TYPE_CHECKING:
    from morse.core.object import Object

logger = logging.getLogger(__name__)


class CommandTimeout(AbstractDatastream):
    """Reads the stream of an actuator; after a while without a command, the first values of all fields apply again.

    Args:
        stream: of the actuator.
        seconds: of simulated time.
    """

    def __init__(self, stream: Any, seconds: float) -> None:
        component = stream.component_instance
        super().__init__(component, stream.kwargs)
        self.stream, self._seconds = stream, seconds
        declared = fields_of_component(component)
        self._first = deepcopy({name: value for name, value in self.data.items() if name in declared})
        #: simulated time of the last command; None if none is active
        self._last: float | None = None
        self._complaints = Complaints(logger)

    def default(self, ci: Object | None = None) -> bool:
        """See `AbstractDatastream.default`: True also when the commands have expired."""
        now = self.component_instance.clock.time
        if self.stream.default(ci):
            self._last = now
            return True
        if self._last is None:
            return False
        self._last = min(self._last, now)  # a restored state sets the time back
        if now - self._last < self._seconds:
            return False
        self._last = None
        self.data.update(deepcopy(self._first))
        text = f"{self.component_name}: no command for {self._seconds:g} s: its first values apply again"
        self._complaints.warn("timeout", text)
        return True
