"""A kinematic model of a quadrotor with autopilot."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.actuators.goal_motion import PoseHolding
from morse.core.limits import ANGLE, POSITION, Angle, Position
from morse.core.services import service
from morse.helpers.components import add_data, add_state
from morse.mathutils.rotations import rotation_from_euler

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

#: natural frequency, rad/s, and damping of the filters of the angles
_FREQUENCY, _DAMPING = 10.0, 0.7
#: downward acceleration, equal to the upward acceleration at the commanded height, m/s^2
_LIFT = 10.0
#: gains of the height: 1/s^2 and 1/s (2 * 0.7 * 3)
_HEIGHT_GAIN, _CLIMB_GAIN = 9.0, 4.2


class StabilizedQuadrotor(PoseHolding):
    """Moves a quadrotor with autopilot: attitude and height follow the command, and the position is computed from them.

    Pitch and roll follow by a second-order filter of 10 rad/s with a damping of 0.7. ``psi_c`` acts as a yaw rate: the
    input of the filter is psi - psi_c, so that the yaw changes by -psi_c 10 / 1.4 rad/s. The acceleration is 10 + 9
    (h_c - h) - 4.2 v_z m/s^2 along Z of the robot, and 10 m/s^2 downward. The resulting pose is set independent of
    forces.
    """

    _name = "Stabilized quadrotor"
    _short_desc = "Motion controller which moves a quadrotor with an autopilot, without forces"

    add_data("theta_c", 0.0, "float", "Pitch", frame="world", **ANGLE)
    add_data("phi_c", 0.0, "float", "Roll", frame="world", **ANGLE)
    add_data("psi_c", 0.0, "float", "Acts as a yaw rate to the right", frame="world", **ANGLE)
    add_data("h_c", 0.0, "float", "Height", frame="world", **POSITION)

    add_state("_angles", list, "Filtered roll, pitch and yaw", unit="rad")
    add_state("_rates", list, "Rates of the filtered angles", unit="rad/s")
    add_state("_velocity", list, "Velocity in the world", unit="m/s")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        here = self.robot_parent.position_3d
        *_, yaw, pitch, roll = here.numbers()
        self._velocity = [0.0, 0.0, 0.0]
        #: roll, pitch and yaw, rad, and their rates, rad/s
        self._angles = [roll, pitch, yaw]
        self._rates = [0.0, 0.0, 0.0]

    @service
    def set_cons(self, phi: Angle, theta: Angle, psi: Angle, h: Position) -> None:
        """Set the command.

        Args:
            phi: roll, radians.
            theta: pitch, radians.
            psi: acts as a yaw rate to the right.
            h: height, metres.
        """
        self.local_data.update(phi_c=float(phi), theta_c=float(theta), psi_c=float(psi), h_c=float(h))

    @service
    def stop(self) -> None:
        """Level the robot, and hold the present height."""
        self.set_cons(0.0, 0.0, 0.0, self.robot_parent.bge_object.world_pose()[0][2])

    def default_action(self) -> None:
        """Move by one tick."""
        data, angles, rates = self.local_data, self._angles, self._rates
        dt = 1.0 / self.frequency
        for i, error in enumerate((data["phi_c"], data["theta_c"], angles[2] - data["psi_c"])):
            rates[i] += dt * _FREQUENCY * (_FREQUENCY * (error - angles[i]) - 2.0 * _DAMPING * rates[i])
            angles[i] += dt * rates[i]
        rotation = rotation_from_euler(angles, "XYZ")
        place = list(self.robot_parent.bge_object.world_pose()[0])
        lift = _LIFT + _HEIGHT_GAIN * (data["h_c"] - place[2]) - _CLIMB_GAIN * self._velocity[2]
        for i, pull in enumerate((0.0, 0.0, _LIFT)):
            self._velocity[i] += dt * (rotation[3 * i + 2] * lift - pull)
            place[i] += dt * self._velocity[i]
        body = self.robot_parent.bge_object
        body.set_pose(place, rotation)
        # a suspended body has no velocity
        body.suspendDynamics()
