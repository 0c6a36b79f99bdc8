"""Temperature near fires."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind, add_property

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

_ENVIRONMENT = "Temperature"
_DEFAULT = "DefaultTemperature"


class Thermometer(Sensor):
    """Measures a temperature that rises exponentially towards fires.

    ``T = T0 + Σ Tf exp(-α d)`` over all objects that have the property ``FireTag``, with d their distance in metres.
    Tf is the value of that property, if it is a number, and ``FireTemperature`` otherwise. A fire with a property
    ``Fire_Growth`` (the tag and ``_Growth``) grows by this share of Tf each second, as that of ``land-1/rosace_1``. T0
    is ``DefaultTemperature``. If a script does not set it, T0 is ``env.properties(Temperature=...)``, if there is one.
    """

    _name = "Thermometer"
    _short_desc = "A sensor returning the temperature, which depends on the distance of fires"
    _builder = BuilderDefaults(visual=Visual("cylinder", (0.02, 0.02, 0.04), (0.6, 0.0, 0.0)))

    add_data("temperature", 0.0, "float", "Temperature", unit="°C", low=-273.15)
    add_property("_global_temp", 15.0, _DEFAULT, "float", "Temperature far from all fires", unit="°C", low=-273.15)
    add_property("_fire_tag", "Fire", "FireTag", "string", "Property that marks fires")
    add_property("_fire_temp", 200.0, "FireTemperature", "float", "Temperature increase at a fire", unit="K")
    add_property(
        "_fire_range",
        float(sys.maxsize),
        "Range",
        "float",
        "Distance beyond which fires are ignored",
        unit="m",
        low=0.0,
        allow=("inf",),
    )
    add_property("_alpha", 0.2, "Alpha", "float", "Decay of the temperature with the distance, per metre", low=0.0)
    add_kind("temperature", temperature="temperature")

    _global_temp: float
    _fire_tag: str
    _fire_temp: float
    _fire_range: float
    _alpha: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        around = self.context.scene.properties.get(_ENVIRONMENT)
        if around is not None and _DEFAULT not in obj:
            try:
                self._global_temp = float(around)  # type: ignore[arg-type]
            except (TypeError, ValueError):
                raise ValueError(f"env.properties({_ENVIRONMENT}={around!r}): expected degrees Celsius") from None

    def measure(self) -> None:
        """Measure the temperature."""
        here, tag = self.position_3d.get_pose()[0], self._fire_tag
        temperature = self._global_temp
        for obj in self.context.world.objects():
            if tag not in obj.properties:
                continue
            distance = math.dist(here, obj.world_pose()[0])
            if distance <= self._fire_range:
                heat = self._heat_of(obj.properties[tag]) * self._size_of(obj.properties.get(f"{tag}_Growth"))
                temperature += heat * math.exp(-self._alpha * distance)
        self.local_data["temperature"] = temperature

    def _size_of(self, growth: object) -> float:
        """The present size of a fire relative to that at the start, from its growth per second."""
        if isinstance(growth, (int, float)) and math.isfinite(growth):
            return max(0.0, 1.0 + growth * self.clock.tick / self.clock.frequency)
        return 1.0

    def _heat_of(self, value: object) -> float:
        # 1 is a truth value: custom properties of .blend files have no booleans
        is_truth = isinstance(value, bool) or (isinstance(value, int) and value == 1)
        if isinstance(value, (int, float)) and not is_truth and math.isfinite(value):
            return float(value)
        return self._fire_temp
