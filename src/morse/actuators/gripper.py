"""Grasps and releases objects."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from morse.actuators.fingers import Fingers
from morse.core.actuator import Actuator
from morse.core.classes.builder_defaults import BuilderDefaults
from morse.core.services import service
from morse.helpers.components import add_data, add_kind, add_property, add_state

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

_TAG = "Graspable"


class Gripper(Actuator):
    """Grasps the nearest object with the property ``Graspable`` in a cone in front of its fingers.

    The cone opens along the Z axis of the gripper, in the direction of the fingers. The origin of an object has to be
    in the cone.

    An object is held as soon as it is grasped. The fingers then close at ``FingerSpeed`` until they meet the held
    object, or each other if the object is not between them. They open when the object is released.
    """

    _name = "Gripper"
    _short_desc = "Grasps and releases objects"
    _builder = BuilderDefaults(model="gripper")

    add_data("grab", False, "bool", "Grasp the nearest object; False releases it")
    add_kind("switch", on="grab")
    add_property("_angle", 60.0, "Angle", "float", "Full angle of the cone", unit="deg", low=0.0, high=360.0)
    add_property("_distance", 0.5, "Distance", "float", "Length of the cone", unit="m", low=0.0)

    add_property("_finger_speed", 1.0, "FingerSpeed", "float", "Speed of the fingers", unit="rad/s", low=0.0, high=1e3)

    add_state("_closing", list, "How far the fingers are closed", unit="rad")
    add_state("_goal", list, "Angles at which the fingers meet the held object", unit="rad")
    add_state("_held_name", str, "Name of the held object; empty for none")

    _angle: float
    _distance: float
    _finger_speed: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._held_name = ""
        self._fingers = Fingers(self.context.world, obj)
        #: how far the fingers are closed, rad
        self._closing = [0.0] * self._fingers.count
        #: the angles at which the fingers meet the held object
        self._goal = self._fingers.closed(None)

    @property
    def held(self) -> Any:
        """The held object, or None."""
        thing = self.context.world.objects_by_name.get(self._held_name) if self._held_name else None
        if thing is None or thing.parent is not self.bge_object:
            # the object was deleted, or the world was reset
            self._held_name = ""
            return None
        return thing

    @service
    def grab(self) -> str | None:
        """Grasp the nearest object.

        Returns:
            The name of the held object; None if no object is in reach.
        """
        obj = self.held or self._nearest()
        if obj is not None and not self._held_name:
            obj.setParent(self.bge_object)
            self._held_name = obj.name
            self._goal = self._fingers.closed(obj)
        self.local_data["grab"] = obj is not None
        return None if obj is None else str(obj.name)

    @service
    def release(self) -> bool:
        """Release the held object; return False if no object is held."""
        obj, self._held_name = self.held, ""
        self.local_data["grab"] = False
        if obj is None:
            return False
        obj.removeParent()
        return True

    def default_action(self) -> None:
        """Grasp or release as commanded."""
        if self.local_data["grab"]:
            if self.held is None:
                self.grab()
                # tried again in every tick
                self.local_data["grab"] = True
        elif self._held_name:
            self.release()
        if self._fingers.count:
            self._move_fingers()

    def _move_fingers(self) -> None:
        step = self._finger_speed / self.frequency
        goal = (
            (self._goal if self._held_name else self._fingers.closed(None)) if self.local_data["grab"] else [0.0, 0.0]
        )
        angles = [here + min(max(there - here, -step), step) for here, there in zip(self._closing, goal, strict=True)]
        if angles != self._closing:
            self._closing = angles
            self._fingers.turn(angles)

    def _nearest(self) -> Any:
        (x, y, z), r = self.bge_object.world_pose()
        cosine = math.cos(math.radians(0.5 * self._angle))
        nearest, reach = None, self._distance
        for thing in self.context.world.objects():
            if _TAG in thing.properties and thing.properties[_TAG] and self._is_loose(thing):
                px, py, pz = thing.world_pose()[0]
                dx, dy, dz = px - x, py - y, pz - z
                distance = math.sqrt(dx * dx + dy * dy + dz * dz)
                if distance <= reach and r[2] * dx + r[5] * dy + r[8] * dz >= cosine * distance:
                    nearest, reach = thing, distance
        return nearest

    def _is_loose(self, thing: Any) -> bool:
        """Whether an object can be grasped: it is not held, and is not a part of another object."""
        return thing.parent is None
