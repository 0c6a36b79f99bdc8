"""Named poses of simulation_interfaces: the zones of the scene.

Source: simulation_interfaces, version 1: NamedPose.msg, GetNamedPoses.srv, GetNamedPoseBounds.srv.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.middleware.ros2.entity_bounds import bounds
from morse.middleware.ros2.entity_tags import chosen
from morse.rosmsgs.parts import quaternion, xyz

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.values import RosMessage
    from morse.scene.scene import Zone


def named_poses(zones: Sequence[Zone], tags: RosMessage) -> list[RosMessage]:
    """The centres of the zones whose type passes a TagsFilter; the tag of a zone is its type."""
    return [
        {
            "name": zone.node.name,
            "description": f"zone of the type {zone.type}",
            "tags": [zone.type],
            "pose": {"position": xyz(zone.node.location), "orientation": quaternion((1.0, 0.0, 0.0, 0.0))},
        }
        for zone in zones
        if chosen([zone.type], tags)
    ]


def pose_bounds(zones: Sequence[Zone], name: str) -> RosMessage | None:
    """The bounds of a zone in the world; None if there is none of that name."""
    for zone in zones:
        if zone.node.name == name:
            centre, half = np.array(zone.node.location), np.abs(zone.node.scale)
            return bounds((centre - half, centre + half))
    return None
