"""The options of MJCF files in a scene.

The time step of the engine is at most that of each file. In a scene whose robots all come from files, it may be as long
as there, the options of the first file apply, and the objects of the scene have the contact parameters of its floor.
Beside robots of other kinds, whose drives are tuned for the options of MORSE, those of files do not apply.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco

from morse.physics.model.file_models import model_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.physics.model.file_models import Part
    from morse.physics.model.layout import Frame
    from morse.scene.mjcf import MjcfModel

#: options that the scene determines
_OF_SCENE = ("timestep", "gravity", "jacobian", "enableflags")
#: largest number of iterations of a solver
_MOST_ITERATIONS = 1000
_USUAL_GRAVITY = 9.81
#: depth of floors that stand for height 0, and their smallest half length, m
_NEARLY_LEVEL, _WIDE = 1e-4, 5.0
_FIELDS = (("friction", 3), ("solref", 2), ("solimp", 5), ("solmix", 1), ("margin", 1), ("gap", 1), ("condim", 1),
           ("priority", 1))  # fmt: skip


def models_of(frames: Sequence[Frame]) -> list[MjcfModel]:
    """Return the models of all robots and objects of a scene that the engine reads from files."""
    return [model for frame in frames if (model := model_of(frame)) is not None]


def are_all_from_files(frames: Sequence[Frame]) -> bool:
    """Whether a scene has robots, and all of them come from MJCF files."""
    robots = [frame for frame in frames if frame.robot is not None and frame.has_body]
    return bool(robots) and all(model_of(frame) is not None for frame in robots)


def set_ground(spec: mujoco.MjSpec, ground: Sequence[float]) -> None:
    """Set the contact parameters of the objects of a scene; see `MjcfModel.ground`."""
    geom, place = spec.default.geom, 0
    for name, count in _FIELDS:
        values = ground[place : place + count]
        place += count
        value = values[0] if count == 1 else list(values)
        setattr(geom, name, int(values[0]) if name in ("condim", "priority") else value)


def set_options(spec: mujoco.MjSpec, part: Part) -> None:
    """Set the options of a file."""
    option = spec.option
    for name, value in part.option.items():
        if name not in _OF_SCENE:
            setattr(option, name, min(value, _MOST_ITERATIONS) if "iterations" in name else value)
    # what sleeps does not creep: in such a scene, bodies sleep only if the file says so
    option.enableflags = int(part.option["enableflags"])
    if option.gravity[2] == -_USUAL_GRAVITY:
        option.gravity = part.option["gravity"]
    if option.integrator == mujoco.mjtIntegrator.mjINT_RK4:
        option.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)


def level(geom: mujoco.MjsGeom, height: float = 0.0) -> None:
    """Replace a wide floor at a height, or a little below it as in the worlds of MORSE 1.4, by a plane at that height.

    Robots of files are compared with those in other programs, whose floors are planes there.
    """
    is_level = geom.type == mujoco.mjtGeom.mjGEOM_BOX and abs(geom.quat[0]) > 1.0 - 1e-12
    top = geom.pos[2] + geom.size[2] - height
    if is_level and -_NEARLY_LEVEL <= top <= 1e-9 and (height or min(geom.size[:2]) >= _WIDE):
        geom.type = mujoco.mjtGeom.mjGEOM_PLANE
        geom.pos = [geom.pos[0], geom.pos[1], height]
        geom.size = [geom.size[0], geom.size[1], 1.0]
