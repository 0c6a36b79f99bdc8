"""The mascot as a robot."""

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
        linear_damping=0.49,
        angular_damping=0.66,
    )
    hidden_box("morsy_bb", (0.786, 1.116, 1.682), (0, 0, 0.855), parent=root, physics_type="RIGID_BODY", mass=1.0)
    # the hull ends 14 mm above the origin; this shape supports the robot with the origin on the floor
    hidden_box("morsy_base_bb", (0.786, 1.116, 0.1), (0, 0, 0.05), parent=root, physics_type="RIGID_BODY", mass=1.0)
    parts = [part.moved(z=-0.744) for part in morsy_parts()]
    exact(
        "morsy_mesh",
        parts,
        (0.796, 1.12, 1.815),
        (0.011, 0, 0.1685),
        (0, 0, 0.744),
        parent=root,
        physics_type="NO_COLLISION",
    )
