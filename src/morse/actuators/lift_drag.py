"""Lift and drag of wings, rudders, sails and hydrofoils."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.helpers.components import add_property
from morse.helpers.joint_motors import JointMotors
from morse.mathutils import Vector
from morse.mathutils.rotations import turn

if TYPE_CHECKING:
    from morse.core.limits import Limits
    from morse.core.robot import Robot
    from morse.core.world import Body

#: speed below which there are no forces, m/s
_SLOWEST = 0.01
_SLOPE: Limits = {"low": -1e4, "high": 1e4}


class LiftDrag(Actuator):
    """Applies the lift and the drag of a thin wing to the link to which it is appended.

    The wing flies along the X axis of the component; its upper side is that of the Z axis. With the angle of attack a
    and the speed v in the plane of X and Z, the coefficient of lift is C a up to the stall, and changes by another
    slope beyond it; those of drag and of the moment are defined in the same way. Each force is c rho v^2 A / 2, at the
    origin of the component. A joint may be a flap that adds to the lift.

    Source: thin airfoils with stall, after the plugin LiftDrag of Gazebo and
    J. D. Anderson, Fundamentals of Aerodynamics, McGraw-Hill, chapter 4.
    """

    applies_forces = True
    _name = "Lift and drag"
    _short_desc = "Lift, drag and moment of a wing that moves through air or water"

    add_property("_area", 1.0, "Area", "float", "Area of the wing", unit="m^2", low=0.0, high=1e6)
    add_property("_density", 1.2041, "Density", "float", "Of the air or water", unit="kg/m^3", low=0.0, high=1e5)
    add_property("_zero", 0.0, "ZeroAngle", "float", "Angle of attack of the X axis", unit="rad", low=-1.6, high=1.6)
    add_property("_stall", 0.5 * math.pi, "StallAngle", "float", "Angle of the stall", unit="rad", low=0.0, high=1.6)
    add_property("_cl", 1.0, "LiftSlope", "float", "Coefficient of lift for 1 rad", **_SLOPE)
    add_property("_cd", 0.01, "DragSlope", "float", "Coefficient of drag for 1 rad", **_SLOPE)
    add_property("_cm", 0.0, "MomentSlope", "float", "Coefficient of the moment for 1 rad", **_SLOPE)
    add_property("_cl_stall", 0.0, "LiftSlopeStalled", "float", "Slope of the lift beyond the stall", **_SLOPE)
    add_property("_cd_stall", 1.0, "DragSlopeStalled", "float", "Slope of the drag beyond the stall", **_SLOPE)
    add_property("_cm_stall", 0.0, "MomentSlopeStalled", "float", "Slope of the moment beyond the stall", **_SLOPE)
    add_property("_joint", "", "Joint", "string", "Joint of a flap; empty for none")
    add_property("_flap", 0.0, "FlapLift", "float", "Coefficient of lift for 1 rad of the flap", **_SLOPE)

    _area: float
    _density: float
    _zero: float
    _stall: float
    _cl: float
    _cd: float
    _cm: float
    _cl_stall: float
    _cd_stall: float
    _cm_stall: float
    _joint: str
    _flap: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        body = self.robot_parent.bge_object
        self._motor = JointMotors(body, (self._joint,), None) if self._joint else None

    def default_action(self) -> None:
        """Apply the forces."""
        link = self.bge_object.parent or self.robot_parent.bge_object
        place, rotation = self.bge_object.world_pose()
        linear, angular = (Vector(value) for value in link.velocity())
        arm = Vector(place) - Vector(link.world_pose()[0])
        velocity = linear + angular.cross(arm)
        forward, upward = (Vector(turn(rotation, axis)) for axis in ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)))
        span = forward.cross(upward)
        speed = velocity.length
        if speed <= _SLOWEST or forward.dot(velocity) < 0.0:
            return
        sweep = min(max(span.dot(velocity) / speed, -1.0), 1.0)
        cosine = math.sqrt(1.0 - sweep * sweep)
        flow = velocity - span * span.dot(velocity)
        pressure = 0.5 * self._density * flow.length_squared * self._area
        along = flow.normalized()
        lift = span.cross(along)
        angle = self._zero + math.atan2(lift.dot(forward), lift.dot(upward))
        angle -= math.pi * round(angle / math.pi)
        c_lift = self._coefficient(angle, cosine, self._cl, self._cl_stall)
        if abs(angle) > self._stall and c_lift * angle < 0.0:
            c_lift = 0.0
        if self._motor is not None:
            c_lift += self._flap * self._motor.positions()[0]
        c_drag = abs(self._coefficient(angle, cosine, self._cd, self._cd_stall))
        c_moment = self._coefficient(angle, cosine, self._cm, self._cm_stall)
        force = (lift * c_lift - along * c_drag) * pressure
        link.wrench(tuple(force), tuple(arm.cross(force) + span * (c_moment * pressure)), False)

    def _coefficient(self, angle: float, cosine: float, slope: float, stall_slope: float) -> float:
        """The coefficient at an angle of attack, with the cosine of the sweep."""
        beyond = max(abs(angle) - self._stall, 0.0)
        return math.copysign(slope * min(abs(angle), self._stall) * cosine + stall_slope * beyond, angle)
