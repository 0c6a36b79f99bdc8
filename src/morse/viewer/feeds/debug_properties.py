"""Shows pages the properties selected by ``env.show_debug_properties()``, and the costs of profiled sensors."""

from __future__ import annotations

import reprlib
import time
from typing import TYPE_CHECKING

from morse.viewer.view_messages import DebugProperties, DebugProperty

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.physics.objects.gameobject import GameObject
    from morse.simulation.simulation import Simulation
    from morse.simulation.ticks.profile import Profile
    from morse.viewer.server import ViewServer

#: maximum number of lines; the number of the others is shown instead
_MOST = 100
#: maximum number of characters of a string
_LENGTH = 200
#: wall-clock seconds between two updates of properties, and of costs
_LOOKS, _COSTS = 0.2, 1.0


class ViewDebug:
    """Sends the marked properties, and properties that were set while the simulation runs."""

    def __init__(self, simulation: Simulation, server: ViewServer) -> None:
        self._world = simulation.world
        self._profile: Profile | None = simulation.sensor_profile
        self._server = server
        self._is_on = simulation.scene.settings.view.show_debug_properties
        self._profile_names = [d.name for d in simulation.scene.components if d.profile]
        self._times: dict[str, float] = {}
        self._shares: list[DebugProperty] = []
        self._last_look = self._last_measurement = 0.0
        self._last_message: DebugProperties | None = None

    def update(self) -> None:
        """Send the list if it has changed since the last call."""
        now = time.monotonic()
        if not (self._is_on or self._profile_names) or now - self._last_look < _LOOKS:
            return
        self._last_look = now
        if now - self._last_measurement >= _COSTS:
            self._shares = list(self._costs(now - self._last_measurement)) if self._last_measurement else []
            self._last_measurement = now
        lines = [*self._shares]
        if self._is_on:
            lines += [line for obj in self._world.objects_by_name.values() for line in _shown(obj)]
        message = DebugProperties(lines[:_MOST], max(0, len(lines) - _MOST))
        if message != self._last_message:
            self._last_message = message
            self._server.send(message)

    def _costs(self, seconds: float) -> Iterator[DebugProperty]:
        """The share of one processor that each profiled sensor used in that time."""
        if self._profile is None:
            return
        for name in self._profile_names:
            cost = self._profile.components.get(name)
            total = 0.0 if cost is None else cost.total
            share = (total - self._times.get(name, 0.0)) / seconds
            self._times[name] = total
            yield DebugProperty(name, "profile", f"{100.0 * share:.1f} %")


def _shown(obj: GameObject) -> Iterator[DebugProperty]:
    own = obj.node.properties
    for name, value in obj.properties.items():
        if name in obj.node.debug or name not in own or own[name] is not value:
            # values of users may be of any type and size, and may be impossible to format
            text = value if isinstance(value, str) else reprlib.repr(value)
            yield DebugProperty(obj.name, str(name), text[:_LENGTH])
