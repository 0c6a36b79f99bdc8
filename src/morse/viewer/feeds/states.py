"""Sends the activity of components, and their properties after every change."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.declarations import properties
from morse.viewer.view_messages import Activity, Capturing, PropertyValue

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.interfaces import Component
    from morse.core.sensor import Sensor
    from morse.core.values import JsonObject
    from morse.viewer.server import ViewServer


class StatesFeed:
    """Compares the states of components with the states that were last sent."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._active: dict[str, bool] = {}
        self._values: dict[str, JsonObject] = {}
        self._capturing: bool | None = None

    def restarted(self) -> None:
        """Forget the states, because the components are described again."""
        self._active.clear()
        self._values.clear()

    def update(self) -> None:
        """Send the changes since the last call."""
        everything: dict[str, Component] = {**self._context.robots, **self._context.components}
        for name, component in everything.items():
            active = component.active
            # a component is active unless a service has deactivated it
            if self._active.get(name, True) is not active:
                self._active[name] = active
                self._server.send(Activity(name, active))
        for name in self._server.wishes.values:
            if name in everything:
                self._tell_properties(name, everything[name])
        self.tell_capturing()

    def _tell_properties(self, name: str, component: Component) -> None:
        values = self._values.setdefault(name, {})
        for python_name, prop in properties(type(component)).items():
            value = getattr(component, python_name)
            if prop.name not in values or values[prop.name] != value:
                values[prop.name] = value
                self._server.send(PropertyValue(name, prop.name, value))

    def tell_capturing(self) -> None:
        """Send whether cameras capture images."""
        cameras = cameras_of(self._context)
        capturing = any(camera.capturing for camera in cameras) if cameras else None
        if capturing is not None and capturing is not self._capturing:
            self._server.send(Capturing(capturing))
        self._capturing = capturing


def cameras_of(context: Context) -> list[Sensor]:
    """The components that capture images, active or paused."""
    from morse.core.sensor import Sensor

    sensors = (component for component in context.components.values() if isinstance(component, Sensor))
    return [sensor for sensor in sensors if sensor.capturing is not None]
