"""Flies a rotorcraft to a position."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.actuators.goal_motion import ARRIVED, STOP, TRANSIT, marker
from morse.actuators.rotorcraft import BankingRotorcraft
from morse.core import status
from morse.core.calls import of_distance
from morse.core.limits import ANGLE, LENGTH, POSITION, Angle, Length, Position
from morse.core.services import async_service, interruptible, service
from morse.helpers.components import add_data, add_kind, add_property, add_state, euler

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body


class RotorcraftWaypoint(BankingRotorcraft):
    """Flies a rotorcraft to a position and a heading by banking and thrust.

    The robot banks by kp (goal - position) - kd v. It has arrived as soon as its distance to the goal is within the
    tolerance, independent of its heading.
    """

    _name = "Rotorcraft waypoint motion controller"
    _short_desc = "Motion controller using force and torque to fly a rotorcraft to a position"

    add_data("x", 0.0, "float", "X of the goal; initially that of the robot", frame="world", **POSITION)
    add_data("y", 0.0, "float", "Y of the goal; initially that of the robot", frame="world", **POSITION)
    add_data("z", 0.0, "float", "Z of the goal; initially that of the robot", frame="world", **POSITION)
    add_data("yaw", 0.0, "float", "Heading; initially that of the robot", frame="world", **ANGLE)
    add_data("tolerance", 0.2, "float", "Distance at which the robot has arrived", **LENGTH)
    add_property("_h_pgain", math.radians(6.0), "HorizontalPgain", "float", "Bank angle per m", unit="rad/m", low=0.0)
    add_property(
        "_h_dgain", math.radians(8.0), "HorizontalDgain", "float", "Bank angle per m/s", unit="rad·s/m", low=0.0
    )
    add_property("_v_dgain", 8.0, "VerticalDgain", "float", "Thrust per vertical speed", unit="N·s/m", low=0.0)
    add_property("_yaw_dgain", 6.0, "YawDgain", "float", "Derivative gain of the yaw", unit="1/s", low=0.0)
    add_property(
        "_remain_at_destination",
        True,
        "RemainAtDestination",
        "bool",
        "Hold the goal position; otherwise the rotors stop on arrival",
    )
    add_property(
        "_target", "wp_target", "Target", "string", "Name of an object that is moved to the goal, if it exists"
    )
    add_kind("pose", position=("x", "y", "z"), orientation=euler(None, None, "yaw"), tolerance="tolerance")

    add_state("_called_off", tuple | None, "Position at which a motion was cancelled", unit="m")
    add_state("_marked", tuple | None, "Position of the target object", unit="m")

    _v_dgain: float
    _remain_at_destination: bool
    _target: str

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._aim_here()
        self._marked: tuple[float, float, float] | None = None
        #: position at which a motion was cancelled; being there does not count as an arrival
        self._called_off: tuple[float, float, float] | None = None

    def _aim_here(self) -> None:
        self.local_data.update(zip("xyz", map(float, self.robot_parent.bge_object.world_pose()[0]), strict=True))
        self.local_data["yaw"] = self._angles()[2]

    @service
    def setdest(self, x: Position, y: Position, z: Position, yaw: Angle, tolerance: Length = 0.2) -> None:
        """Fly to a position without waiting for the arrival.

        Args:
            x: metres.
            y: metres.
            z: metres.
            yaw: radians.
            tolerance: metres.
        """
        self.local_data.update(x=float(x), y=float(y), z=float(z), yaw=float(yaw), tolerance=float(tolerance))
        self._called_off = None
        self.robot_parent.move_status = TRANSIT

    @interruptible
    @async_service
    def goto(self, x: Position, y: Position, z: Position, yaw: Angle, tolerance: Length = 0.2) -> None:
        """Fly to a position; the service ends with ``Arrived``.

        Args:
            x: metres.
            y: metres.
            z: metres.
            yaw: radians.
            tolerance: metres.
        """
        self.setdest(x, y, z, yaw, tolerance)

    @service(changes=False)
    def get_status(self) -> str:
        """Return ``Transit``, ``Arrived`` or ``Stop``."""
        return str(self.robot_parent.move_status)

    def interrupt(self) -> None:
        """Hold the present position."""
        self._aim_here()
        self._called_off = self.local_data["x"], self.local_data["y"], self.local_data["z"]
        self.robot_parent.move_status = STOP
        super().interrupt()

    def progress(self) -> dict[str, object]:
        """Return the distance to the destination."""
        here = self.robot_parent.bge_object.world_pose()[0]
        return of_distance(math.dist(here, [self.local_data[name] for name in "xyz"]))

    def default_action(self) -> None:
        """Apply the thrust and the torques."""
        data = self.local_data
        place = data["x"], data["y"], data["z"]
        if place != self._marked:
            target_marker = marker(self, self._target)
            if target_marker is not None:
                target_marker.worldPosition = place
            self._marked = place
        body = self.robot_parent.bge_object
        position, velocity = body.world_pose()[0], self._velocity_of_mass()
        dx, dy, dz = place[0] - position[0], place[1] - position[1], place[2] - position[2]
        if math.sqrt(dx * dx + dy * dy + dz * dz) <= data["tolerance"]:
            if place != self._called_off:
                self._arrive()
            if not self._remain_at_destination:
                self._errors = None
                return
        elif place != self._called_off:
            self.robot_parent.move_status = TRANSIT
        kp, kd = self._h_pgain, self._h_dgain
        climb = self._v_pgain * dz - self._v_dgain * velocity[2]
        self._bank(kp * dx - kd * velocity[0], kp * dy - kd * velocity[1], climb, data["yaw"], self._angles())

    def _arrive(self) -> None:
        self.robot_parent.move_status = ARRIVED
        if self.on_completion is not None:
            self.completed(status.SUCCESS, ARRIVED)
