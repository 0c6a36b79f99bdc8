"""Wooden crates, each a body with its shapes in its own collection, standing over the origin."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from common.materials import material
from common.objects import collection, empty, exact, hidden_box
from common.shapes import box
from common.wood import Carpenter, planked, wooden

if TYPE_CHECKING:
    import bpy

    from common.parts import Part


def crate_woods() -> tuple[bpy.types.Material, bpy.types.Material, bpy.types.Material, bpy.types.Material]:
    """Planks, frames, the wall of the small crate, and iron."""
    return (
        wooden("Planks", "#9a6a3a", "#d8a868", 3),
        wooden("Frame", "#7a4e28", "#b98550", 8),
        planked("Crate Wall", "#9a6a3a", "#d8a868", 5, boards=5),
        material("Iron", "#4a4e54", 0.5, 0.8),
    )


def small_crate(name: str, planks, frame) -> bpy.types.Collection:
    """A closed cube of 1 m: the core is one box with a clean quad on each side, the diagonal boards are loose."""
    group = collection(name)
    root = empty(name, within=group, physics_type="RIGID_BODY", compound=1, mass=20.0)
    hidden_box(f"{name}_bb", (1, 1, 1), (0.01, -0.009, 0.512), parent=root, physics_type="RIGID_BODY", mass=1.0)
    saw = Carpenter(1)
    core, thick = 0.93, 0.035
    outer = core + 2 * thick
    parts = [box(core, core, core).mapped(core, offset=(0.5, 0.5)).painted(planks)]
    for turns, width, height in (
        (((0, 0, 0), (0, 0, 180)), outer, core),
        (((0, 0, 90), (0, 0, 270)), core, core),
        (((0, 90, 0), (0, -90, 0)), outer, outer),
    ):
        parts += [part.turned(*turn) for turn in turns for part in framed_side(saw, frame, core, thick, width, height)]
    at = (1.37, 1.75, -0.028)
    exact(f"{name}_mesh", parts, (1, 1, 1), (-1.37, -1.75, 0.531), at, parent=root, physics_type="NO_COLLISION")
    return group


def framed_side(saw: Carpenter, frame, core: float, thick: float, width: float, height: float) -> list[Part]:
    """The boards on the +X side of a cube: four along the edges and, a little lower, one diagonal."""
    x, inner = (core + thick) / 2, core - 0.24
    beam, post = (height - inner) / 2, (width - inner) / 2
    boards = [saw.board(thick, width, beam, frame).moved(x, 0, s * (inner + beam) / 2) for s in (1, -1)]
    boards += [saw.board(thick, post, inner, frame).moved(x, s * (inner + post) / 2, 0) for s in (1, -1)]
    diagonal = saw.board(thick * 0.8, inner * np.sqrt(2) + 0.02, 0.115, frame)
    return [*boards, diagonal.turned(x=45).moved(core / 2 + thick * 0.4, 0, 0)]


def wall(
    saw: Carpenter, planks, frame, length: float, height: float, thick: float, count: int, posts: int
) -> list[Part]:
    """Horizontal planks with upright posts outside (+Y), standing on z=0, middle of the inner face at the origin."""
    inner, gap = thick * 0.45, 0.012
    pitch = height / count
    parts = [saw.board(length, inner, pitch - gap, planks).moved(0, inner / 2, pitch * (i + 0.5)) for i in range(count)]
    reach = (length - 0.14) / 2
    parts += [
        saw.board(0.14, thick - inner, height, frame).moved(p, (thick + inner) / 2, height / 2)
        for p in np.linspace(-reach, reach, posts)
    ]
    return parts


def large_crate(name: str, planks, frame, iron) -> bpy.types.Collection:
    """An open box of 4 x 2 x 2 m on runners, and its lid."""
    group = collection(name)
    root = empty(name, within=group, physics_type="RIGID_BODY", compound=1, mass=80.0)
    for number, size, at in (
        ("01", (4.01, 0.114, 2.0), (0.012, -0.957, 0.996)),
        ("02", (4.01, 0.114, 2.0), (0.012, 0.949, 0.996)),
        ("03", (0.114, 2.0, 2.0), (-1.95, -0.01, 0.996)),
        ("04", (0.114, 2.0, 2.0), (1.95, -0.01, 0.996)),
        ("05", (3.91, 2.0, 0.278), (-0.003, -0.01, 0.14)),
    ):
        hidden_box(f"{name}_bb_{number}", size, at, parent=root, physics_type="RIGID_BODY", mass=1.0)
    saw = Carpenter(2, metres=1.1)
    parts = [p.moved(0, 0.886, 0.12) for p in wall(saw, planks, frame, 3.99, 1.88, 0.114, 8, 5)]
    parts += [
        p.turned(z=180) for p in [q.moved(0, 0.886, 0.12) for q in wall(saw, planks, frame, 3.99, 1.88, 0.114, 8, 5)]
    ]
    for turn in (90, -90):
        parts += [p.moved(0, 1.886, 0.12).turned(z=turn) for p in wall(saw, planks, frame, 1.77, 1.88, 0.114, 8, 3)]
    parts += [saw.board(3.78, 0.285, 0.04, planks).moved(0, y, 0.26) for y in np.linspace(-0.74, 0.74, 6)]
    parts += [saw.board(3.9, 0.2, 0.24, frame).moved(0, y, 0.12) for y in (-0.78, 0.0, 0.78)]
    parts += [box(0.16, 0.16, 0.1, 0.01).moved(x, y, 1.9).painted(iron) for x in (-1.92, 1.92) for y in (-0.92, 0.92)]
    exact(f"{name}_mesh", parts, (4, 2, 2), (-0.006, -0.003, 0.994), parent=root, physics_type="NO_COLLISION")
    return group


def lid(name: str, planks, frame) -> None:
    """The lid of a large crate, above it."""
    saw = Carpenter(6, metres=1.1)
    boards = [saw.board(3.88, 0.235, 0.05, planks).moved(0, y, -0.0165) for y in np.linspace(-0.85, 0.85, 8)]
    boards += [saw.board(0.16, 1.94, 0.033, frame).moved(x, 0, 0.025) for x in (-1.5, 0.0, 1.5)]
    exact(
        name,
        boards,
        (3.88, 1.94, 0.083),
        (-0.001, 0, 0.009),
        (0, 0.004, 2.29),
        physics_type="RIGID_BODY",
        collision="box",
        mass=1.0,
    )


def transport_box(name: str, planks, frame, iron) -> bpy.types.Collection:
    """A shallow open box of 2 x 1.3 x 0.9 m."""
    group = collection(name)
    root = empty(name, within=group, physics_type="RIGID_BODY", compound=1, mass=20.0)
    for number, size, at in (
        ("01", (2.05, 0.032, 0.871), (-0.001, -0.641, 0.444)),
        ("02", (0.032, 1.3, 0.871), (-1.04, -0.01, 0.444)),
        ("03", (0.032, 1.3, 0.871), (1.03, -0.01, 0.444)),
        ("04", (2.05, 1.25, 0.047), (-0.001, 0.0, 0.025)),
    ):
        hidden_box(f"{name}_bb_{number}", size, at, parent=root, physics_type="RIGID_BODY", mass=1.0)
    saw = Carpenter(4)
    parts = [p.moved(0, 0.606, 0).turned(z=180) for p in wall(saw, planks, frame, 2.05, 0.877, 0.034, 4, 3)]
    # the fourth side is open, so that things can be pushed in
    for turn in (90, -90):
        parts += [p.moved(0, 1.011, 0).turned(z=turn) for p in wall(saw, planks, frame, 1.28, 0.877, 0.034, 4, 2)]
    parts += [saw.board(2.03, 0.235, 0.046, planks).moved(0, y, 0.024) for y in np.linspace(-0.5, 0.5, 5)]
    parts += [box(0.05, 0.05, 0.06, 0.006).moved(x, y, 0.83).painted(iron) for x in (-1.0, 1.0) for y in (-0.6,)]
    exact(
        f"{name}_mesh",
        parts,
        (2.09, 1.28, 0.877),
        (0.001, 0.001, 0.438),
        (-0.006, -0.005, 0.008),
        parent=root,
        physics_type="NO_COLLISION",
    )
    return group
