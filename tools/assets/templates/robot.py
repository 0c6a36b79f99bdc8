"""The initial body of a new robot of a user's project: the mascot."""

from __future__ import annotations

from common.mascot import morsy_parts
from common.objects import empty, exact, hidden_box


def build() -> None:
    root = empty(
        "morsy",
        physics_type="RIGID_BODY",
        collision="convex",
        compound=1,
        mass=15.0,
        linear_damping=0.2,
        angular_damping=0.4,
    )
    hidden_box("morsy_bb", (0.818, 1.182, 1.574), (0, 0, 0.826), parent=root, physics_type="RIGID_BODY", mass=1.0)
    exact("morsy_mesh", morsy_parts(), (0.796, 1.12, 1.78), (0.011, 0, 0.929), parent=root, physics_type="NO_COLLISION")
