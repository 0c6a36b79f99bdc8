"""Commands that expire: without new ones, an actuator does what it did before the first."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.datastream import AbstractDatastream

if TYPE_CHECKING:
    from morse.core.actuator import Actuator
    from morse.core.object import Object


class CommandTimeout(AbstractDatastream):
    """Reads the stream of an actuator; the actuator itself ends the command, so that the end is part of its state.

    Args:
        stream: of the actuator.
        seconds: of simulated time.
    """

    component_instance: Actuator

    def __init__(self, stream: AbstractDatastream, seconds: float) -> None:
        super().__init__(stream.component_instance, stream.kwargs)
        self.stream, self._seconds = stream, seconds

    def default(self, ci: Object | None = None) -> bool:
        """See `AbstractDatastream.default`."""
        if not self.stream.default(ci):
            return False
        self.component_instance.command_end = self.component_instance.clock.time + self._seconds
        return True
