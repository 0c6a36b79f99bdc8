"""The base class of motion sensors."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, NamedTuple

from morse.core.sensor import Sensor
from morse.helpers.components import add_property, add_state
from morse.mathutils.rotations import cross, rotation_vector, turn, turn_back

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import TypeAlias

    from morse.core.robot import Robot
    from morse.core.world import Body
    from morse.mathutils.rotations import Triple

    #: linear and angular velocity in the axes of the world, m/s and rad/s; origin, m
    _Observation: TypeAlias = tuple[Sequence[float], Sequence[float], Sequence[float]]

#: distance from the origin of the robot below which a sensor is treated as being at the origin, m
_LEVER_ARM = 0.01


class Motion(NamedTuple):
    """The motion of a sensor, in the axes of the world.

    Attributes:
        linear: velocity, m/s.
        angular: angular velocity, rad/s.
        acceleration: acceleration without gravity, m/s^2.
        angular_acceleration: rad/s^2.
    """

    linear: Triple
    angular: Triple
    acceleration: Triple
    angular_acceleration: Triple


class MotionSensor(Sensor):
    """A sensor that measures the motion of its robot.

    Depending on the property ``ComputationMode``, velocities are those of the body of the robot, those of the link that
    a dynamic joint moves, or are computed from the poses of the sensor at two measurements. Accelerations are the
    change of velocity since the last measurement; for a link, of the velocity in the axes of the sensor, and what the
    rotation of these axes adds is that at the measurement.
    """

    add_property(
        "_computation_mode",
        "Automatic",
        "ComputationMode",
        "string",
        "Source of velocities: Velocity for those of the body of the robot, Position for the change of the pose "
        "of the sensor, Automatic for Velocity if the robot is a dynamic body, and for that of the link of the sensor "
        "if a dynamic joint moves it",
        choices=("Automatic", "Velocity", "Position"),
    )

    add_state("_time", float, "Time of the last measurement", unit="s")
    add_state("_pose", tuple, "Position and rotation at the last measurement")
    add_state("_linear", tuple, "Linear velocity at the last measurement", unit="m/s")
    add_state("_angular", tuple, "Angular velocity at the last measurement", unit="rad/s")

    #: the fields that `velocities_at` returns
    velocity_fields: ClassVar[frozenset[str]] = frozenset()

    _computation_mode: str

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._is_on_robot = obj.slot == (parent or self).bge_object.slot
        self._time = self.clock.time
        self._pose = self._measured_pose()
        self._linear, self._angular = self._velocity_of_robot()

    def _velocity_of_robot(self) -> tuple[Triple, Triple]:
        (vx, vy, vz), (wx, wy, wz) = self.robot_parent.bge_object.velocity()
        return (vx, vy, vz), (wx, wy, wz)

    @property
    def _is_by_velocity(self) -> bool:
        mode = self._computation_mode
        is_of_robot = mode == "Automatic" and self._is_on_robot
        return mode == "Velocity" or (is_of_robot and self.robot_parent.bge_object.is_dynamic)

    @property
    def _is_by_link(self) -> bool:
        """Whether the velocity is that of a link that a dynamic joint moves."""
        return self._computation_mode == "Automatic" and not self._is_on_robot and self.bge_object.is_dynamic

    def may_wait(self) -> bool:
        """Return False for velocities computed from poses: accelerations then depend on two earlier measurements."""
        return self._is_by_velocity

    def observe(self) -> _Observation:
        """Return the present velocities of the body of the robot, and its origin."""
        body = self.robot_parent.bge_object
        linear, angular = body.velocity()
        return linear, angular, body.world_pose()[0]

    def remember(self) -> None:
        """Take note of the velocities from which the next accelerations are computed."""
        self._time, self._pose = self.local_data["timestamp"], self._measured_pose()
        (vx, vy, vz), (wx, wy, wz), _ = self.observation()
        self._linear, self._angular = (vx, vy, vz), (wx, wy, wz)

    def placed(self) -> None:
        """The next velocities and accelerations are computed from rest at the present pose."""
        position, rotation = self.bge_object.world_pose()
        self._time, self._pose = self.clock.time, (tuple(position), tuple(rotation))
        self._linear = self._angular = (0.0, 0.0, 0.0)

    def _measured_pose(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        # tuples: states of sensors that have measured in each tick are equal to those of others
        position, rotation = self.position_3d.get_pose()
        return tuple(position), tuple(rotation)

    def twist_place(self, fields: Sequence[str]) -> int | None:
        """Return where the world keeps the velocity of the robot, if it determines these fields, else None.

        See `morse.core.world.Body.twist_place` and `velocities_at`.
        """
        if not set(fields) <= self.velocity_fields or not (self._is_by_velocity and self._is_on_robot):
            return None
        return self.robot_parent.bge_object.twist_place

    def motion(self) -> Motion:
        """Return the motion at the measurement; call it once per measurement.

        The velocity of the body is that of its origin. If the sensor is not at the origin, its acceleration has a
        tangential and a centripetal part, ``α x r + ω x (ω x r)`` with the lever arm ``r``.
        """
        now = self.local_data["timestamp"]
        dt = now - self._time
        if dt <= 0.0:
            dt = self.clock.period
        pose = self._measured_pose()
        if self._is_by_link:
            return self._of_link(now, dt, pose)
        origin: Sequence[float] | None = None
        if self._is_by_velocity:
            (vx, vy, vz), (wx, wy, wz), origin = self.observation()
            linear, angular = (vx, vy, vz), (wx, wy, wz)
        else:
            (x, y, z), (x0, y0, z0) = pose[0], self._pose[0]
            linear = ((x - x0) / dt, (y - y0) / dt, (z - z0) / dt)
            rx, ry, rz = turn(pose[1], rotation_vector(self._pose[1], pose[1]))
            angular = (rx / dt, ry / dt, rz / dt)
        before = (self._linear, self._angular)
        self._time, self._pose, self._linear, self._angular = now, pose, linear, angular
        return changed(before, (linear, angular), dt, pose[0], origin)

    def _of_link(self, now: float, dt: float, pose: tuple[tuple[float, ...], tuple[float, ...]]) -> Motion:
        """Return the motion of a link: a steady rotation gives a centripetal acceleration alone."""
        (vx, vy, vz), (wx, wy, wz) = self.bge_object.velocity()
        linear, angular = (vx, vy, vz), (wx, wy, wz)
        rotation, before = pose[1], self._pose[1]
        rates = [
            turn(rotation, _rate(turn_back(before, old), turn_back(rotation, new), dt))
            for old, new in ((self._linear, linear), (self._angular, angular))
        ]
        (x, y, z), (cx, cy, cz) = rates[0], cross(angular, linear)
        self._time, self._pose, self._linear, self._angular = now, pose, linear, angular
        return Motion(linear, angular, (x + cx, y + cy, z + cz), rates[1])


def velocities_at(
    rotation: Sequence[float], linear: Sequence[float], angular: Sequence[float]
) -> dict[str, Sequence[float]]:
    """Return data of a sensor by field; of many sensors at once, if all numbers are arrays.

    Args:
        rotation: 9, row by row, from the axes of the sensor to those of the world.
        linear, angular: velocity in the axes of the world, m/s and rad/s.
    """
    return {
        "linear_velocity": turn_back(rotation, linear),
        "angular_velocity": turn_back(rotation, angular),
        "world_linear_velocity": linear,
    }


def changed(
    before: tuple[Triple, Triple],
    after: tuple[Triple, Triple],
    dt: float,
    position: Sequence[float],
    origin: Sequence[float] | None,
) -> Motion:
    """Return the motion of a sensor from two linear and angular velocities.

    Args:
        before, after: m/s and rad/s, in the axes of the world.
        dt: seconds between them.
        position: position of the sensor, m.
        origin: origin of the body that has these velocities; None if they are those of the sensor itself.
    """
    linear, angular = after
    acceleration, angular_acceleration = _rate(before[0], linear, dt), _rate(before[1], angular, dt)
    if origin is not None:
        acceleration = _at_lever_arm(acceleration, angular, angular_acceleration, position, origin)
    return Motion(linear, angular, acceleration, angular_acceleration)


def _at_lever_arm(
    acceleration: Triple,
    angular: Triple,
    angular_acceleration: Triple,
    position: Sequence[float],
    origin: Sequence[float],
) -> Triple:
    (x, y, z), (ox, oy, oz) = position, origin
    arm = (x - ox, y - oy, z - oz)
    if arm[0] ** 2 + arm[1] ** 2 + arm[2] ** 2 <= _LEVER_ARM**2:
        return acceleration
    tx, ty, tz = cross(angular_acceleration, arm)
    cx, cy, cz = cross(angular, cross(angular, arm))
    ax, ay, az = acceleration
    return ax + tx + cx, ay + ty + cy, az + tz + cz


def _rate(before: Triple, after: Triple, dt: float) -> Triple:
    return (after[0] - before[0]) / dt, (after[1] - before[1]) / dt, (after[2] - before[2]) / dt
