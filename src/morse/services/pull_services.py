"""Services that pull a body, like the pointer of the live view; part of the pseudo component ``simulation``."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import msgspec

from morse.core.abstractobject import AbstractObject
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.limits import Point
from morse.core.reports.quoting import nearest, short
from morse.core.services import service
from morse.core.state import StateError

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.context import Context

_Numbers = tuple[float, float, float]
#: stiffness per mass, 1/s^2; with critical damping the body follows within half a second
_STIFFNESS = 60.0
_DAMPING = 2.0 * math.sqrt(_STIFFNESS)
#: maximum pull per mass, m/s^2: eight times the weight on Earth
_STRONGEST = 8.0 * 9.81


class PullServices(AbstractObject):
    """Pulls one body with a virtual spring, until `let_go` is called.

    Args:
        pushes: functions that are called before the physics of each tick; `apply` is one of them while it pulls.
    """

    def __init__(self, context: Context, pushes: list[Callable[[], object]]) -> None:
        super().__init__()
        self._context, self._pushes = context, pushes
        self._pulled: tuple[str, list[float], list[float]] | None = None

    def name(self) -> str:
        """``simulation``."""
        return "simulation"

    @service
    def pull(self, object_name: str, anchor: Point, target: Point) -> None:
        """Pull a point of an object towards a position with a virtual spring, until `let_go`.

        A static or kinematic object does not move.

        Args:
            anchor: the point, x, y, z in the frame of the object, m.
            target: the position, x, y, z in the world, m.
        """
        objects = self._context.world.objects_by_name
        if object_name not in objects:
            raise MorseRPCInvokationError(f"Object {short(object_name)} unknown{nearest(object_name, list(objects))}")
        self._grasp((object_name, [float(x) for x in anchor], [float(x) for x in target]))

    @service
    def let_go(self) -> None:
        """Stop pulling."""
        self._grasp(None)

    def _grasp(self, pulled: tuple[str, list[float], list[float]] | None) -> None:
        self._pulled = pulled
        is_called = self.apply in self._pushes
        if pulled is not None and not is_called:
            self._pushes.append(self.apply)
        elif pulled is None and is_called:
            self._pushes.remove(self.apply)

    def restart(self) -> None:
        """Stop pulling when the simulation restarts."""
        self._grasp(None)

    def get_state(self) -> list[object]:
        """Return the pulled object, the anchor and the target; empty if no object is pulled."""
        return [] if self._pulled is None else list(self._pulled)

    def set_state(self, state: list[object]) -> None:
        """Restore a state that `get_state` returned.

        Raises:
            StateError: it is no such state.
        """
        try:
            if state:
                name, *points = msgspec.convert(state, tuple[str, _Numbers, _Numbers])
                if not all(math.isfinite(x) for point in points for x in point):
                    raise StateError("the saved state is damaged: a body is pulled to no point")
                self._grasp((name, list(points[0]), list(points[1])))
            else:
                self._grasp(None)
        except msgspec.ValidationError as error:
            raise StateError(f"the saved state is damaged: {error}") from None

    def apply(self) -> None:
        """Apply the force during this tick."""
        if self._pulled is None:
            return
        name, anchor, target = self._pulled
        obj = self._context.world.objects_by_name.get(name)
        if obj is None:
            self._grasp(None)
        elif obj.is_dynamic:
            obj.pull(anchor, target, _STIFFNESS, _DAMPING, _STRONGEST)
