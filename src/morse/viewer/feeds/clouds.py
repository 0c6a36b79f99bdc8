"""Sends the point clouds of depth cameras to pages."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.declarations import fields_of_component
from morse.viewer.view_messages import Cloud

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.core.object import Object
    from morse.core.values import Fields
    from morse.viewer.server import ViewServer

#: maximum number of points; above it, every second, third, ... point is sent: a point is 12 bytes
_MOST_SHOWN = 10_000


class ViewClouds:
    """Sends the clouds of the sensors that pages show; those of sensors with rays are shown as rays."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._last_clouds: Fields = {}
        self._components: list[Object] = []
        self.restarted()

    def restarted(self) -> None:
        """The components were created again."""
        self._components = [c for c in self._context.components.values() if c.rays is None and has_points(c)]

    def update(self) -> None:
        """Send the clouds measured since the last call."""
        wishes = self._server.wishes.overlays
        for component in self._components:
            name = component.name()
            if name not in wishes:
                self._last_clouds.pop(name, None)
                continue
            points = component.local_data.get("points")
            if points is self._last_clouds.get(name):
                continue
            self._last_clouds[name] = points
            self._server.send(Cloud(in_world(component, points).tobytes(), name))


def has_points(component: Object) -> bool:
    """Whether a component measures a cloud: a field ``points`` of shape (N, 3)."""
    field = fields_of_component(component).get("points")
    return field is not None and tuple(field.shape or ()) == (None, 3)


def in_world(component: Any, points: object) -> NDArray[np.float32]:
    """Some points of a cloud, (N, 3), in the frame of the world; the origin of the sensor stands for no point."""
    array = np.asarray(points, np.float32)
    if array.ndim != 2 or array.shape[1] != 3:
        return np.zeros((0, 3), np.float32)
    array = array[np.isfinite(array).all(axis=1) & array.any(axis=1)]
    array = array[:: max(-(-len(array) // _MOST_SHOWN), 1)]
    position, rotation = component.measured_from()
    return np.asarray(array @ np.reshape(rotation, (3, 3)).T + np.array(position), np.float32)
