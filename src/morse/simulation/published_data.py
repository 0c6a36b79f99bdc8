"""Warns about sensors of users whose data do not match their declarations."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from morse.core.parts.overwritten import uncover
from morse.core.validation.published import misfits

if TYPE_CHECKING:
    from morse.core.declarations import DataField
    from morse.core.object import Object
    from morse.simulation.simulation import Simulation

logger = logging.getLogger(__name__)

#: types of initial values, by the declared type of a field
_TYPES: dict[str, tuple[type, ...]] = {
    "float": (float, int), "double": (float, int), "int": (int,), "integer": (int,), "bool": (bool,),
    "boolean": (bool,), "string": (str,), "str": (str,),
}  # fmt: skip


class PublishedData:
    """Checks the data after ticks 1, 2, 4, 8, and so on: errors of the first measurement and rare ones are found.

    The sensors of MORSE itself are not checked: `morse check component` and its tests do that.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        # a new version of a class is reported again
        self._reports: set[tuple[str, str, type]] = set()
        self._begin = self._next = 0

    def review(self, tick: int, changed: bool) -> int:
        """Check all sensors of users; see `morse.simulation.ticks.ticking.Ticker.reviews`."""
        if changed:
            self._begin, self._next = tick - 1, tick
        if tick < self._next:
            return self._next
        self._next = tick + max(1, tick - self._begin)
        sensors = self._simulation.loaded.sensors
        users = [one for one in sensors if not type(one).__module__.startswith("morse.") and one.active]
        guard = self._simulation.context.guard
        # what cannot be read makes the sensor fail, and not the check
        guard.each(users, self._check, guard.deactivate)
        return self._next

    def _check(self, sensor: Object) -> None:
        if not sensor.local_data.get("timestamp"):  # a measurement has a time stamp
            return
        for text in uncover(sensor):
            if (sensor.name(), text, type(sensor)) not in self._reports:
                self._reports.add((sensor.name(), text, type(sensor)))
                logger.warning("%s: %s", sensor.name(), text)
        for field, _, text in misfits(sensor, _is_definite):
            key = sensor.name(), field, type(sensor)
            if key in self._reports:
                continue
            self._reports.add(key)
            # a sensor may publish any number of them
            line = f"{sensor.name()} ({type(sensor).__name__}): {text}"
            self._simulation.context.complaints.warn(line, line)


def _is_definite(field: DataField) -> bool:
    """Return whether type and initial value agree: components of 1.4 declare a list with the initial value 'none'."""
    return field.shape is not None or type(field.default) in _TYPES.get(field.type, ())
