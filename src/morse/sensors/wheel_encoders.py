"""Wheel encoders."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind, add_property, add_state

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body


class WheelEncoders(Sensor):
    """Measures the rotation of the driven wheels of a robot with physical wheels, in steps of incremental encoders.

    The rotation includes slip: the distance is angle times radius only for rolling wheels.
    """

    _name = "Wheel encoders"
    _short_desc = "Counts, angles and speeds of the driven wheels of a robot"
    _source = "incremental encoder: angle divided by the step, rounded down"
    _builder = BuilderDefaults(visual=Visual("cylinder", (0.02, 0.02, 0.01), (0.2, 0.2, 0.2)))

    add_data("wheels", [], "list<string>", "Names of the wheels", follows="position")
    add_data(
        "ticks",
        [],
        "list<int>",
        "Steps since the start, positive forward; one number per wheel",
        shape=(None,),
        follows="position",
    )
    add_data(
        "position", [], "list<float>", "Angle since the start, in whole steps", unit="rad", frame="joint", shape=(None,)
    )
    add_data(
        "velocity",
        [],
        "list<float>",
        "Steps per second since the last measurement",
        unit="rad/s",
        frame="joint",
        shape=(None,),
    )
    add_property(
        "_steps", 4096, "StepsPerTurn", "int", "Resolution of the encoders; 0 for exact angles", low=0, high=10_000_000
    )
    add_kind("joints", names=lambda encoders: encoders.local_data["wheels"], position="position", velocity="velocity")

    add_state("_before", list, "Angles of the wheels at the last measurement", unit="rad")
    add_state("_time", float, "Time of the last measurement", unit="s")

    _steps: int

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        wheels = getattr(parent, "get_wheels", None)
        if wheels is None:
            raise ValueError(
                f"the robot '{self.robot_parent.name()}' has no driven wheels: append wheel encoders to a robot whose "
                "wheels turn, such as Pioneer3DX or SegwayRMP400"
            )
        self._wheels = wheels()
        count = len(self._wheels)
        self._time = self.clock.time
        self._before = [0.0] * count
        data = self.local_data
        data["wheels"] = [wheel.object.name.rpartition(".")[2] for wheel in self._wheels]
        data["ticks"], data["position"], data["velocity"] = [0] * count, [0.0] * count, [0.0] * count

    @property
    def radii(self) -> list[float]:
        """The radii of the wheels, m."""
        return [float(wheel.radius) for wheel in self._wheels]

    def measure(self) -> None:
        """Measure the angles."""
        step = math.tau / self._steps if self._steps else 0.0
        angles = [wheel.angle for wheel in self._wheels]
        ticks = [math.floor(angle / step) if step else 0 for angle in angles]
        positions = [tick * step for tick in ticks] if step else angles
        dt = self.clock.time - self._time
        data = self.local_data
        data["ticks"], data["position"] = ticks, positions
        if dt > 0.0:
            data["velocity"] = [(b - a) / dt for a, b in zip(self._before, positions, strict=True)]
        self._before, self._time = positions, self.clock.time
