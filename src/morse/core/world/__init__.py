"""What components may call of the world: the interface between components and the physics.

`morse.physics` implements these protocols; components do not import it.
"""

from morse.core.world.body import Bodies, Body, BodyNames, Joints, Pose, Wheel
from morse.core.world.world import (
    Fleet,
    Hanging,
    KinematicBodies,
    Linkage,
    PoseTable,
    RayBundle,
    Rays,
    Sight,
    Snapshot,
    Snapshots,
    World,
    WorldPoses,
)

__all__ = [
    "Bodies",
    "Body",
    "BodyNames",
    "Fleet",
    "Hanging",
    "Joints",
    "KinematicBodies",
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
