"""Robots that are driven by wheels."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.ackermann_robot import PhysicsAckermannRobot
from morse.core.declarations import add_property
from morse.core.parts.moving_parts import MovingPart
from morse.core.robot import Robot
from morse.mathutils.rotations import rows_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.world import Body, Wheel

_STANDSTILL = 1e-3


class PhysicsDifferentialRobot(Robot):
    """A robot with two driven wheels, or two rows of driven wheels, which turns by a difference of wheel speeds.

    Wheels are the parts of the model whose names contain ``wheel`` and that collide. The track and the radius are
    measured on the model; ``FixTurningSpeed`` replaces the track in the equations

        left  = (v - e/2 w) / R        right = (v + e/2 w) / R
    """

    add_property(
        "_fix_turning", 0.0, "FixTurningSpeed", "double", "Effective track in metres; 0 for the measured track"
    )
    add_property("_influence", 0.1, "Influence", "double", "Exists for scripts of 1.4; the engine does not use it")
    add_property("_wheel_friction", 0.8, "Friction", "double", "Exists for scripts of 1.4; see set_friction")
    add_property("_has_suspension", True, "HasSuspension", "bool", "Exists for scripts of 1.4; wheels are rigid")

    add_property(
        "_ride_height", 0.0, "RideHeight", "double", "Height of the body above its wheels, relative to the model, m"
    )

    _fix_turning: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._wheels = obj.wheels()
        if not self._wheels:
            raise ValueError(
                f"'{obj.name}' has no wheels: a wheeled robot needs parts that collide and whose names contain 'wheel'"
            )
        sides = [wheel.offset_y for wheel in self._wheels]
        self._track: float = max(sides) - min(sides)
        self._radius: float = sum(wheel.radius for wheel in self._wheels) / len(self._wheels)

    @property
    def track(self) -> float:
        """Distance between the left and right wheels in the equations of the speed, m."""
        return self._fix_turning or self._track

    @property
    def wheel_radius(self) -> float:
        """Radius of the wheels, m."""
        return self._radius

    def get_wheels(self) -> list[Wheel]:
        """The driven wheels."""
        return list(self._wheels)

    def moving_parts(self) -> list[MovingPart]:
        """The wheels."""
        left = rows_of(self.bge_object.world_pose()[1])
        parts = []
        for wheel in self._wheels:
            wheel_rotation = rows_of(wheel.object.world_pose()[1])
            # its axle is the Y axis of the robot; because of the rotation of the wheel both have the same coordinates
            x, y, z = (sum(wheel_rotation[k][i] * left[k][1] for k in range(3)) for i in range(3))
            name = wheel.object.name.rpartition(".")[2]
            parts.append(MovingPart(name, wheel.object, None, (x, y, z), lambda wheel=wheel: wheel.angle))  # type: ignore[misc]
        return parts

    def apply_vw_wheels(self, vx: float, vw: float) -> None:
        """Turn the wheels so that the robot drives at ``vx`` m/s and turns at ``vw`` rad/s."""
        if abs(vx) < _STANDSTILL and abs(vw) < _STANDSTILL:
            vx = vw = 0.0
        half = 0.5 * self.track * vw
        for wheel in self._wheels:
            wheel.set_speed((vx - half if wheel.offset_y > 0.0 else vx + half) / self._radius)

    def apply_speed(self, kind: str, linear_speed: Sequence[float], angular_speed: Sequence[float]) -> None:
        """Drive with the wheels; only the forward speed and the yaw rate are used."""
        self.apply_vw_wheels(linear_speed[0], angular_speed[2])


def drives_wheels(robot: Robot) -> bool:
    """Whether a robot turns its wheels as `PhysicsDifferentialRobot` does, so that their speeds last."""
    return all(
        getattr(type(robot), name) is getattr(PhysicsDifferentialRobot, name) and name not in vars(robot)
        for name in ("apply_vw_wheels", "track", "wheel_radius")
    )


__all__ = ["PhysicsAckermannRobot", "PhysicsDifferentialRobot", "drives_wheels"]
