"""Services that pull at a body, as the pointer of the live view does; part of the pseudo component ``simulation``."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from morse.core.abstractobject import AbstractObject
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.hints import nearest
from morse.core.limits import Point
from morse.core.quoting import short
from morse.core.services import service

if TYPE_CHECKING:
    from morse.core.context import Context

#: stiffness per mass, 1/s^2; with critical damping the body follows within half a second
_STIFFNESS = 60.0
_DAMPING = 2.0 * math.sqrt(_STIFFNESS)
#: m/s^2: the pull is never stronger than eight times the weight on Earth
_STRONGEST = 8.0 * 9.81


class PullServices(AbstractObject):
    """Pulls one body as if by a spring, until told to let go."""

    def __init__(self, context: Context) -> None:
        super().__init__()
        self._context = context
        self._pulled: tuple[str, list[float], list[float]] | None = None

    def name(self) -> str:
        """``simulation``."""
        return "simulation"

    @service
    def pull(self, object_name: str, anchor: Point, target: Point) -> None:
        """Pull a point of an object towards a place, as a spring does, until `let_go`.

        An object that does not obey forces stays where it is.

        Args:
            anchor: the point, x, y, z in the frame of the object, m.
            target: the place, x, y, z in the world, m.
        """
        objects = self._context.world.objects_by_name
        if object_name not in objects:
            raise MorseRPCInvokationError(f"Object {short(object_name)} unknown{nearest(object_name, list(objects))}")
        self._pulled = (object_name, [float(x) for x in anchor], [float(x) for x in target])

    @service
    def let_go(self) -> None:
        """Pull no longer."""
        self._pulled = None

    def restart(self) -> None:
        """The simulation starts anew: nothing is pulled."""
        self._pulled = None

    def get_state(self) -> list[Any]:
        """What is pulled, at which point, and whereto; empty for nothing."""
        return [] if self._pulled is None else list(self._pulled)

    def set_state(self, state: list[Any]) -> None:
        """Take a state from `get_state`."""
        self._pulled = (state[0], list(state[1]), list(state[2])) if state else None

    def apply(self) -> None:
        """Pull during this tick."""
        if self._pulled is None:
            return
        name, anchor, target = self._pulled
        obj = self._context.world.objects_by_name.get(name)
        if obj is None:
            self._pulled = None
        elif obj.is_dynamic:
            obj.pull(anchor, target, _STIFFNESS, _DAMPING, _STRONGEST)
