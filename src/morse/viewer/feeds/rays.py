"""Sends the rays of sensors to pages."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.physics.rays import RayBundle
from morse.viewer.view_messages import Rays

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.object import Object
    from morse.viewer.server import ViewServer

#: maximum number of rays; above it, every second, third, ... ray is sent: a ray is 28 bytes, ten times per second
_MOST_SHOWN = 4000


class ViewRays:
    """Sends the rays of sensors that pages show, and of those with a visible arc."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._last_counts: dict[str, int] = {}
        self._components: list[Object] = []
        self.restarted()

    def restarted(self) -> None:
        """The components were created again."""
        self._components = [c for c in self._context.components.values() if _bundles(c)]

    def update(self) -> None:
        """Send the rays cast since the last call."""
        wishes = self._server.wishes.overlays
        for component in self._components:
            name = component.name()
            if name not in wishes and not getattr(component, "visible_arc", False):
                self._last_counts.pop(name, None)
                continue
            bundles = [bundle for bundle in _bundles(component) if bundle.stamp >= 0]
            stamp = max((bundle.stamp for bundle in bundles), default=None)
            if stamp is not None and self._last_counts.get(name) != stamp:
                self._last_counts[name] = stamp
                segments = np.concatenate([bundle.segments() for bundle in bundles])
                step = -(-len(segments) // _MOST_SHOWN)
                self._server.send(Rays(segments[:: max(step, 1)].tobytes(), name))


def _bundles(component: Object) -> list[RayBundle]:
    return [request for request in component.requests if isinstance(request, RayBundle)]
