"""Bounds of simulation_interfaces: of entities, and as filters.

Source: simulation_interfaces, version 1: Bounds.msg, EntityFilters.msg.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.rosmsgs.parts import from_xyz, xyz
from morse.scene.extent import box_around

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.values import DecodedMessage, RosMessage
    from morse.core.world import World
    from morse.scene.node import Node

    Box = tuple[NDArray[np.float64], NDArray[np.float64]]

#: constants of Bounds
EMPTY, BOX, HULL, SPHERE = 0, 1, 2, 3


def box_of(world: World, root: Node) -> Box | None:
    """Return the lower and the upper corner (3,) in the world, m, of the shapes of an entity; None without shapes."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for node in root.walk():
        part = world.find_object(node) if node.shapes else None
        if part is None:
            continue
        position, rotation = part.world_pose()
        place, turn = np.array(position), np.reshape(rotation, (3, 3))
        for shape in node.shapes or ():
            lower, upper = box_around(shape, place, turn)
            low, high = np.minimum(low, lower), np.maximum(high, upper)
    return (low, high) if low[0] <= high[0] else None


def bounds(box: Box | None) -> RosMessage:
    """The message; the points of a box are its upper and its lower corner."""
    if box is None:
        return {"type": EMPTY, "points": []}
    return {"type": BOX, "points": [xyz(box[1].tolist()), xyz(box[0].tolist())]}


def mistake(message: DecodedMessage) -> str | None:
    """What is wrong with bounds that are a filter; they are a box or a sphere."""
    points = message["points"]
    if message["type"] not in (BOX, SPHERE):
        return "filters.bounds.type is 1 (box) or 3 (sphere)"
    if len(points) != 2:
        return f"filters.bounds.points has {len(points)} points; a box or a sphere has 2"
    numbers = [number for point in points for number in from_xyz(point)]
    if not all(math.isfinite(number) for number in numbers):
        return "filters.bounds.points has a number that is not finite"
    if message["type"] == SPHERE and numbers[3] < 0.0:
        return "filters.bounds.points[1].x, the radius of the sphere, is negative"
    return None


def overlap(box: Box, message: DecodedMessage) -> bool:
    """Whether a box has a point in common with the bounds of a filter without a `mistake`."""
    one, other = (np.array(from_xyz(point)) for point in message["points"])
    if message["type"] == SPHERE:
        return bool(math.dist(np.clip(one, *box).tolist(), one.tolist()) <= other[0])
    return bool((np.minimum(one, other) <= box[1]).all() and (np.maximum(one, other) >= box[0]).all())
