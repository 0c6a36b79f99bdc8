"""Atmospheric pressure."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind, add_property
from morse.helpers.geodesy import LocalPlane, has_place

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

#: constants of the International Standard Atmosphere (ISO 2533) up to 11 km: K/m, K, J/(mol K), kg/mol
_LAPSE_RATE, _TEMPERATURE = 0.0065, 288.15
_GAS_CONSTANT, _MOLAR_MASS = 8.31447, 0.0289644
#: pressure at sea level, Pa
_SEA_LEVEL = 101325.0


class Barometer(Sensor):
    """Measures the pressure of the air at the altitude of the sensor.

    ``p = p0 (1 - L h / T)^(g M / (R L))``, the International Standard Atmosphere up to 11 km, with the gravity g of the
    scene. If the environment declares its position on the earth (``env.properties(longitude=..., latitude=...,
    altitude=...)``), h is the altitude above sea level, and p0 is 101325 Pa. Without it, or with a
    ``ReferencePressure``, h is the height relative to the start, where the pressure is p0.
    """

    _name = "Barometer"
    _short_desc = "A sensor returning the atmospheric pressure"
    _source = "ISO 2533:1975, Standard Atmosphere: the layer up to 11 km"
    _builder = BuilderDefaults(visual=Visual("cube", (0.02, 0.02, 0.02), (0.8, 0.1, 0.1)))

    add_data("pressure", 0.0, "float", "Pressure of the air", unit="Pa", low=0.0)
    add_property(
        "_reference_pressure",
        None,
        "ReferencePressure",
        "float",
        "Pressure at the start; none for that of the standard atmosphere",
        unit="Pa",
        low=0.0,
        allow=("none",),
    )
    add_kind("pressure", absolute="pressure")

    _reference_pressure: float | None

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._start = self.position_3d.z
        place = self.context.scene.properties
        self._plane = LocalPlane.of(place) if has_place(place) else None

    def measure(self) -> None:
        """Measure the pressure."""
        base = self._reference_pressure
        if base is None and self._plane is not None:
            height = self._plane.geodetic_of(self.position_3d.get_pose()[0])[2]
        else:
            height = self.position_3d.z - self._start
        exponent = self.context.scene.settings.gravity * _MOLAR_MASS / (_GAS_CONSTANT * _LAPSE_RATE)
        # the formula is not defined above 44 km
        ratio = max(1.0 - _LAPSE_RATE * height / _TEMPERATURE, 0.0)
        self.local_data["pressure"] = (_SEA_LEVEL if base is None else base) * ratio**exponent
