"""Pulls a body with the pointer of the driving page, as if by a spring."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.viewer import page_messages as page

#: stiffness per mass, 1/s^2; with critical damping the body follows within half a second
_STIFFNESS = 60.0
_DAMPING = 2.0 * math.sqrt(_STIFFNESS)
#: the pull is never stronger than that many times the weight on Earth
_STRONGEST = 8.0 * 9.81


class ViewDrag:
    """Applies the pull of the pointer during every tick until it lets go."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._event: page.Drag | None = None

    def hold(self, event: page.Drag) -> None:
        """Pull from now on, or to another place."""
        self._event = event

    def release(self, _event: Any = None) -> None:
        """Let go."""
        self._event = None

    def apply(self) -> None:
        """Pull during the next tick."""
        if self._event is None:
            return
        obj = self._context.world.objects_by_name.get(self._event.node)
        if obj is None or not obj.is_dynamic:
            return
        obj.pull(self._event.anchor, self._event.target, _STIFFNESS, _DAMPING, _STRONGEST)
