"""Casters of wheeled robots.

A robot with two driven wheels and rigid casters stands on three points. Casters that reach a millimetre too low lift a
driven wheel, and the robot turns on the spot or does not move. Real casters have springs. The casters in the simulation
end slightly higher than the wheels, so that the wheels always carry a load.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.physics.model.inertia import bounding_box
from morse.physics.model.layout import driven_wheels
from morse.physics.model.wheel_shapes import wheel_axis, wheel_size
from morse.physics.poses.poses import relative_pose

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from morse.physics.model.layout import Frame
    from morse.scene import CollisionShape, Node
    from morse.scene.frames import RigidFrame

#: distance between the lowest points of casters and wheels, m
_CLEARANCE = 0.001


def is_caster(node: Node) -> bool:
    """Whether a part is a caster."""
    return "caster" in node.plain_name.lower()


def caster_floor(frame: Frame, pose: RigidFrame) -> float | None:
    """Return the lowest height of casters in the frame of the robot, m; None if it has no driven wheels."""
    names = driven_wheels(frame.robot)
    bottoms = []
    for node in frame.node.walk():
        if node.name in names:
            radius, _, _ = wheel_size(node, wheel_axis(node, frame.node))
            bottoms.append(float(relative_pose(node, pose)[0][2]) - radius)
    return max(bottoms) + _CLEARANCE if bottoms else None


def rise(
    shape: CollisionShape, position: NDArray[np.float64], rotation: NDArray[np.float64], floor: float | None
) -> float:
    """Return the distance by which a shape of a caster has to be raised to end above a floor, m."""
    if floor is None:
        return 0.0
    low, _ = bounding_box(shape, position, rotation)
    return max(0.0, floor - float(low[2]))
