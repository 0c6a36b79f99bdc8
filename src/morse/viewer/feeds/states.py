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


#: number of properties that are sent at once, to all pages: one that watches thousands of them must not make the others
#: wait
_MOST_TOLD = 500


class StatesFeed:
    """Compares the states of components with the states that were last sent."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._components: list[tuple[str, Component]] | None = None
        self._cameras: list[Sensor] = []
        self._active: list[bool] = []
        self._values: dict[str, JsonObject] = {}
        self._capturing: bool | None = None

    def restarted(self) -> None:
        """Forget the states, because the components are described again."""
        self.rearranged()
        self._active.clear()
        self._values.clear()

    def rearranged(self) -> None:
        """Components may have been replaced."""
        self._components = None

    def _present(self) -> list[tuple[str, Component]]:
        if self._components is None:
            self._components = [*self._context.robots.items(), *self._context.components.items()]
            self._cameras = cameras_of(self._context)
        return self._components

    def update(self) -> None:
        """Send the changes since the last call."""
        components = self._present()
        active = [component.active for _, component in components]
        if active != self._active:
            # a component is active unless a service has deactivated it
            before = self._active if len(self._active) == len(active) else [True] * len(active)
            for (name, _), now, earlier in zip(components, active, before, strict=True):
                if now is not earlier:
                    self._server.send(Activity(name, now))
            self._active = active
        left = _MOST_TOLD
        for name in self._server.wishes.values:
            component = self._context.components.get(name) or self._context.robots.get(name)
            if component is not None and left > 0:
                left -= self._tell_properties(name, component)
        self.tell_capturing()

    def _tell_properties(self, name: str, component: Component) -> int:
        """Send the changed properties of a component, and return their number."""
        values, count = self._values.setdefault(name, {}), 0
        for python_name, prop in properties(type(component)).items():
            value = getattr(component, python_name)
            if prop.name not in values or values[prop.name] != value:
                values[prop.name] = value
                self._server.send(PropertyValue(name, prop.name, value))
                count += 1
        return count

    def tell_capturing(self) -> None:
        """Send whether cameras capture images."""
        self._present()
        cameras = self._cameras
        capturing = any(camera.capturing for camera in cameras) if cameras else None
        if capturing is not None and capturing is not self._capturing:
            self._server.send(Capturing(capturing))
        self._capturing = capturing


def cameras_of(context: Context) -> list[Sensor]:
    """The components that capture images, active or paused."""
    from morse.core.sensor import Sensor

    sensors = (component for component in context.components.values() if isinstance(component, Sensor))
    return [sensor for sensor in sensors if sensor.capturing is not None]
