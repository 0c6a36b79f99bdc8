"""Dynamic pressure of the air."""

from morse.core.declarations import BuilderDefaults, Visual
from morse.helpers.components import add_data, add_kind
from morse.mathutils.rotations import turn_back
from morse.sensors.motion_sensor import MotionSensor

#: density of the air of the standard atmosphere at sea level, kg/m^3
_DENSITY = 1.225


class Airspeed(MotionSensor):
    """Measures the dynamic pressure of the air along its X axis, like a Pitot tube.

    The pressure is ``1/2 ρ v²`` with ρ = 1.225 kg/m³, without wind.
    """

    _name = "Airspeed"
    _short_desc = "A sensor returning the dynamic pressure of the air, as a Pitot tube does"
    _source = "Bernoulli's equation; density of the air at sea level by ISO 2533:1975"
    _builder = BuilderDefaults(visual=Visual("cylinder", (0.02, 0.02, 0.04), (0.6, 0.6, 0.6)))

    add_data("diff_pressure", 0.0, "float", "Dynamic pressure", unit="Pa", low=0.0)
    add_kind("pressure", differential="diff_pressure")

    def measure(self) -> None:
        """Measure the pressure."""
        forward = turn_back(self.position_3d.get_pose()[1], self.motion().linear)[0]
        self.local_data["diff_pressure"] = 0.5 * _DENSITY * forward * forward
