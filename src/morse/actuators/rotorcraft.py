"""The base classes of rotorcraft controllers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.core.limits import FORCE, TORQUE
from morse.helpers import air
from morse.helpers.components import add_property, add_state
from morse.helpers.transformation import euler_angles

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

_ORIGIN = (0.0, 0.0, 0.0)
#: m/s^2
GRAVITY = 9.81

_MOST_FORCE: float = FORCE["high"]
_MOST_TORQUE: float = TORQUE["high"]

_Three = tuple[float, float, float]


class Rotorcraft(Actuator):
    """Controls a robot by torques and a thrust along its Z axis.

    The torque about each axis of the robot is

        I (kp e + kd de/dt) s

    with the moment of inertia I about that axis, the error e of its angle, and the factor s, a share of the thrust.
    """

    applies_forces = True

    add_state(
        "_errors",
        tuple | None,
        "Errors of roll, pitch and yaw at the last action, None if inactive",
        unit="rad",
    )

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        x, y, z = self.robot_parent.bge_object.localInertia
        self._inertia: _Three = x, y, z
        #: errors of roll, pitch and yaw in the previous tick; None after an inactive tick
        self._errors: _Three | None = None

    def _angles(self) -> _Three:
        """Roll, pitch and yaw of the robot, rad."""
        return euler_angles(self.robot_parent.bge_object.world_pose()[1])

    def _torque(self, errors: _Three, kp: _Three, kd: _Three, share: float) -> _Three:
        """Torque about each axis, N m, in the axes of the errors."""
        before = errors if self._errors is None else self._errors
        self._errors = errors
        rate = self.frequency
        (x, y, z), (was_x, was_y, was_z), (i_x, i_y, i_z) = errors, before, self._inertia
        (p_x, p_y, p_z), (d_x, d_y, d_z) = kp, kd
        return (
            i_x * (p_x * x + d_x * math.remainder(x - was_x, math.tau) * rate) * share,
            i_y * (p_y * y + d_y * math.remainder(y - was_y, math.tau) * rate) * share,
            i_z * (p_z * z + d_z * math.remainder(z - was_z, math.tau) * rate) * share,
        )

    def _push(self, thrust: float, torque: _Three) -> None:
        """Apply a thrust along Z, N, and a torque, N m, both in the axes of the robot."""
        x, y, z = torque
        # comparisons with NaN are false
        if not (abs(x) <= _MOST_TORQUE and abs(y) <= _MOST_TORQUE and abs(z) <= _MOST_TORQUE):
            x, y, z = _limited(x, _MOST_TORQUE), _limited(y, _MOST_TORQUE), _limited(z, _MOST_TORQUE)
        if not abs(thrust) <= _MOST_FORCE:
            thrust = _limited(thrust, _MOST_FORCE)
        body = self.robot_parent.bge_object
        body.wrench((0.0, 0.0, thrust * air.thrust(self.context, body)), (x, y, z), True)


def _limited(value: float, most: float) -> float:
    """Limit a force or torque to the range of the physics engine, because clients may set any gains."""
    return 0.0 if math.isnan(value) else max(-most, min(value, most))


class BankingRotorcraft(Rotorcraft):
    """Accelerates horizontally by banking."""

    add_property(
        "_h_pgain",
        0.2,
        "HorizontalPgain",
        "float",
        "Bank angle per horizontal error, rad per m or m/s",
        low=0.0,
    )
    add_property("_h_dgain", 0.8, "HorizontalDgain", "float", "Bank angle per rate of change of the error", low=0.0)
    add_property("_v_pgain", 8.0, "VerticalPgain", "float", "Thrust per vertical error, N per m or m/s", low=0.0)
    add_property("_yaw_pgain", 12.0, "YawPgain", "float", "Proportional gain of the yaw", unit="1/s^2", low=0.0)
    add_property("_rp_pgain", 9.7, "RollPitchPgain", "float", "Proportional gain of roll, pitch", unit="1/s^2", low=0.0)
    add_property("_rp_dgain", 2.0, "RollPitchDgain", "float", "Derivative gain of roll and pitch", unit="1/s", low=0.0)
    add_property(
        "_max_bank_angle",
        math.radians(30.0),
        "MaxBankAngle",
        "float",
        "Largest roll and pitch",
        unit="rad",
        low=0.0,
        high=math.radians(80.0),
    )

    _h_pgain: float
    _h_dgain: float
    _v_pgain: float
    _yaw_pgain: float
    _yaw_dgain: float
    _rp_pgain: float
    _rp_dgain: float
    _max_bank_angle: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        own = self.robot_parent.name()
        centres = (centre for name, _, centre in self.context.world.mass_centres() if name == own)
        self._centre: _Three = next(centres, (0.0, 0.0, 0.0))

    def _velocity_of_mass(self) -> _Three:
        """Velocity of the centre of mass in the world, m/s; the velocity of the origin varies with the bank angle."""
        body = self.robot_parent.bge_object
        (vx, vy, vz), (wx, wy, wz) = body.velocity()
        if self._centre == _ORIGIN:
            return vx, vy, vz
        r, (a, b, c) = body.world_pose()[1], self._centre
        x, y, z = r[0] * a + r[1] * b + r[2] * c, r[3] * a + r[4] * b + r[5] * c, r[6] * a + r[7] * b + r[8] * c
        return vx + wy * z - wz * y, vy + wz * x - wx * z, vz + wx * y - wy * x

    def _bank(self, command_x: float, command_y: float, climb: float, yaw_wanted: float, angles: _Three) -> None:
        """Bank towards a world direction, and control the height.

        Args:
            command_x: bank towards X of the world, rad.
            command_y: bank towards Y of the world, rad.
            climb: thrust in addition to the weight of the robot, N.
            yaw_wanted: yaw setpoint, rad.
            angles: present roll, pitch and yaw, rad.
        """
        roll, pitch, yaw = angles
        c, s, most = math.cos(yaw), math.sin(yaw), self._max_bank_angle
        roll_wanted = min(max(s * command_x - c * command_y, -most), most)
        pitch_wanted = min(max(c * command_x + s * command_y, -most), most)
        carrying = self.robot_parent.bge_object.mass * GRAVITY
        # the thrust is increased with the bank angle to keep the height, up to the thrust for the largest bank angle
        upright = max(math.cos(most) ** 2, math.cos(roll) * math.cos(pitch))
        thrust = max(carrying / upright + climb, 0.0)
        errors = (roll_wanted - roll, pitch_wanted - pitch, math.remainder(yaw_wanted - yaw, 2.0 * math.pi))
        kp = (self._rp_pgain, self._rp_pgain, self._yaw_pgain)
        kd = (self._rp_dgain, self._rp_dgain, self._yaw_dgain)
        self._push(thrust, self._torque(errors, kp, kd, thrust / carrying if carrying else 0.0))
