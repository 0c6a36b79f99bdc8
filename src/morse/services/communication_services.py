"""The pseudo component ``communication``: distance and visibility between robots."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.abstractobject import AbstractObject
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.reports.quoting import nearest, short
from morse.core.services import service

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.world import Body


class CommunicationServices(AbstractObject):
    """Distances and lines of sight between robots."""

    def __init__(self, context: Context) -> None:
        super().__init__()
        self.context = context

    def name(self) -> str:
        """``communication``."""
        return "communication"

    @service(changes=False)
    def distance_and_view(self, robot1: str, robot2: str) -> list[float]:
        """Return the distance between two robots (m), and whether the line of sight between their origins is free."""
        first, second = self._robot(robot1), self._robot(robot2)
        obstacle = first.rayCastTo(second, first.getDistanceTo(second) + 1e-3)
        return [first.getDistanceTo(second), obstacle is None or obstacle.slot == second.slot]

    def _robot(self, name: str) -> Body:
        robots = self.context.robots
        if name not in robots:
            raise MorseRPCInvokationError(f"Robot {short(name)} unknown{nearest(str(name), list(robots))}")
        return robots[name].bge_object
