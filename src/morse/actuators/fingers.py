"""The fingers of a gripper."""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING, Any

from morse.mathutils.rotations import turn, turn_back
from morse.scene import Bone, JointKind
from morse.scene.extent import extent

if TYPE_CHECKING:
    from collections.abc import Sequence

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

    def __init__(self, world: World, gripper: Any) -> None:
        self._gripper = gripper
        parts = {part.node.plain_name: part for part in gripper.childrenRecursive}
        finger_parts = [parts[name] for name in _NAMES if name in parts]
        bones, hanging = [], []
        for number, part in enumerate(finger_parts):
            position, rotation = part.local_pose()
            hinge = [a + b for a, b in zip(position, turn(rotation, _HINGE), strict=True)]
            bones.append(Bone(part.name, -1, tuple(hinge), tuple(rotation), 0.0, JointKind.REVOLUTE, 0))
            back = tuple(-value for value in _HINGE)
            hanging.append((part, number, back, (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)))
        self._linkage = world.linkage(gripper, bones, hanging)
        #: number of fingers
        self.count = len(finger_parts) if len(finger_parts) == len(_NAMES) else 0

    def turn(self, angles: Sequence[float]) -> None:
        """Turn the fingers inward from their open positions, rad, left and right."""
        self._linkage.move([-angle for angle in angles])

    def closed(self, obj: Any) -> list[float]:
        """The angles at which the fingers meet the held object, or each other, rad, left and right."""
        return [_angle_at(distance) for distance in self._sides(obj)]

    def _sides(self, obj: Body) -> tuple[float, float]:
        """How far an object extends to the left and to the right between the pads, m; 0 if it is not between them."""
        corners = None if obj is None else extent(obj.node.walk(), obj.node)
        if corners is None:
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
