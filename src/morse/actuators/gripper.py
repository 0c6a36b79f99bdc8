"""Grasps and releases objects."""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.core.classes.builder_defaults import BuilderDefaults
from morse.core.services import service
from morse.helpers.components import add_data, add_kind, add_property, add_state
from morse.mathutils.rotations import rotation_of, turn, turn_back
from morse.scene import Bone, JointKind
from morse.scene.extent import extent

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.robot import Robot
    from morse.core.world import Body, World


#: parts of the model: the fingers on the left and the right side
_NAMES = ("finger1", "finger2")
#: position of the hinge in the frame of a finger, which turns about its X axis, m
_HINGE = (0.0, -0.003, 0.056)
#: centre of a pad relative to the hinge: outward and forward, m; half its thickness, m
_OUT, _AHEAD, _PAD = 0.020, 0.059, 0.0025
#: extent of the pads along the axes of the gripper: half width across, start and end forward, m
_ACROSS, _FROM, _TO = 0.03, 0.08, 0.13


class Fingers:
    """Two fingers that turn about hinges until they meet the held object, or each other.

    Models without parts ``finger1`` and ``finger2`` have no fingers that move.

    Args:
        world: the world that contains the gripper.
        gripper: the object of the gripper.
    """

    is_apparatus = True

    def __init__(self, world: World, gripper: Body) -> None:
        self._gripper = gripper
        parts = {part.node.plain_name: part for part in gripper.childrenRecursive}
        finger_parts = [parts[name] for name in _NAMES if name in parts]
        bones, hanging = [], []
        for number, part in enumerate(finger_parts):
            position, rotation = part.local_pose()
            x, y, z = [a + b for a, b in zip(position, turn(rotation, _HINGE), strict=True)]
            bones.append(Bone(part.name, -1, (x, y, z), rotation_of(rotation), 0.0, JointKind.REVOLUTE, 0))
            back = tuple(-value for value in _HINGE)
            hanging.append((part, number, back, (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)))
        self._linkage = world.linkage(gripper, bones, hanging)
        #: number of fingers
        self.count = len(finger_parts) if len(finger_parts) == len(_NAMES) else 0

    def turn(self, angles: Sequence[float]) -> None:
        """Turn the fingers inward from their open positions, rad, left and right."""
        self._linkage.move([-angle for angle in angles])

    def closed(self, obj: Body | None) -> list[float]:
        """The angles at which the fingers meet the held object, or each other, rad, left and right."""
        return [_angle_at(distance) for distance in self._sides(obj)]

    def _sides(self, obj: Body | None) -> tuple[float, float]:
        """How far an object extends to the left and to the right between the pads, m; 0 if it is not between them."""
        corners = None if obj is None else extent(obj.node.walk(), obj.node)
        if obj is None or corners is None:
            return 0.0, 0.0
        (ox, oy, oz), r = self._gripper.world_pose()
        (px, py, pz), q = obj.world_pose()
        extents = []
        for corner in product(*zip(*(side.tolist() for side in corners), strict=True)):
            x, y, z = turn(q, corner)
            extents.append(turn_back(r, (px + x - ox, py + y - oy, pz + z - oz)))
        (x0, x1), (y0, y1), (z0, z1) = ((min(values), max(values)) for values in zip(*extents, strict=True))
        between = x0 < _ACROSS and x1 > -_ACROSS and z0 < _TO and z1 > _FROM
        return (max(y1, 0.0), max(-y0, 0.0)) if between else (0.0, 0.0)


def _angle_at(distance: float) -> float:
    """The angle at which the inner side of a pad has a distance from the centre line, rad; at least 0 (open)."""
    reach = math.hypot(_OUT, _AHEAD)
    sine = (_PAD - _HINGE[1] - 2.0 * _PAD - distance) / reach
    return max(math.atan2(_OUT, _AHEAD) + math.asin(max(sine, -1.0)), 0.0)


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
    def held(self) -> Body | None:
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

    def _nearest(self) -> Body | None:
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

    def _is_loose(self, thing: Body) -> bool:
        """Whether an object can be grasped: it is not held, and is not a part of another object."""
        return thing.parent is None
