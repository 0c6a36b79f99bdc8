"""Atmospheric pressure."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind, add_property

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

#: constants of the International Standard Atmosphere (ISO 2533) up to 11 km: K/m, K, J/(mol K), kg/mol
_LAPSE_RATE, _TEMPERATURE = 0.0065, 288.15
_GAS_CONSTANT, _MOLAR_MASS = 8.31447, 0.0289644


class Barometer(Sensor):
    """Measures the pressure of the air, which depends on the height of the sensor relative to the start.

    ``p = p0 (1 - L h / T)^(g M / (R L))``, the International Standard Atmosphere up to 11 km, with the gravity g of the
    scene. ``ReferencePressure`` is the pressure p0 at the initial height.
    """

    _name = "Barometer"
    _short_desc = "A sensor returning the atmospheric pressure"
    _source = "ISO 2533:1975, Standard Atmosphere: the layer up to 11 km"
    _builder = BuilderDefaults(visual=Visual("cube", (0.02, 0.02, 0.02), (0.8, 0.1, 0.1)))

    add_data("pressure", 0.0, "float", "Pressure of the air", unit="Pa", low=0.0)
    add_property(
        "_reference_pressure", 101325.0, "ReferencePressure", "float", "Pressure at the start", unit="Pa", low=0.0
    )
    add_kind("pressure", absolute="pressure")

    _reference_pressure: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._start = self.position_3d.z

    def measure(self) -> None:
        """Measure the pressure."""
        ratio = 1.0 - _LAPSE_RATE * (self.position_3d.z - self._start) / _TEMPERATURE
        exponent = self.context.scene.settings.gravity * _MOLAR_MASS / (_GAS_CONSTANT * _LAPSE_RATE)
        # the formula is not defined above 44 km
        self.local_data["pressure"] = self._reference_pressure * max(ratio, 0.0) ** exponent
