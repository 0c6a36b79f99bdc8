"""What components may call of the world: the interface between components and the physics.

`morse.physics` implements these protocols; components do not import it.
"""

from morse.core.world.body import Bodies, Body, Pose, Wheel
from morse.core.world.body_names import BodyNames
from morse.core.world.joints import Joints
from morse.core.world.linkage import Hanging, Linkage
from morse.core.world.poses import WorldPoses
from morse.core.world.rays import RayBundle, Rays, Sight
from morse.core.world.snapshots import Fleet, PoseTable, Snapshot, Snapshots
from morse.core.world.world import World

__all__ = [
    "Bodies",
    "Body",
    "BodyNames",
    "Fleet",
    "Hanging",
    "Joints",
    "Linkage",
    "Pose",
    "PoseTable",
    "RayBundle",
    "Rays",
    "Sight",
    "Snapshot",
    "Snapshots",
    "Wheel",
    "World",
    "WorldPoses",
]
