"""Parts of a robot that rotate or slide relative to the rest of the robot."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.world import Body

CONTINUOUS, REVOLUTE, PRISMATIC = "continuous", "revolute", "prismatic"
FIXED, FLOATING = "fixed", "floating"


class MovingPart(NamedTuple):
    """A part that a joint moves.

    Attributes:
        joint: name of the joint; messages of the kind ``joints`` use the same one.
        object: the part in the world.
        parent: the object relative to which it moves; None for the body of the robot.
        axis: (3,) unit vector along or about which it moves, in the frame of the part.
        position: function that returns the present joint value, rad or m.
        type: type of the joint in URDF: ``continuous``, ``revolute`` or ``prismatic``; ``fixed``; or ``floating`` for
            any other motion.
        low, high: limits, rad or m.
        frame: name of the part in its file; empty for a part that is named after its joint.
        offset: (3,) m, origin of the frame of the part, which is on its joint, in the frame of its object.
        mimic: the joint that this one follows, factor and offset; or None.
    """

    joint: str
    object: Body
    parent: Body | None
    axis: tuple[float, float, float]
    position: Callable[[], float]
    type: str = CONTINUOUS
    low: float = -math.pi
    high: float = math.pi
    frame: str = ""
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    mimic: tuple[str, float, float] | None = None
