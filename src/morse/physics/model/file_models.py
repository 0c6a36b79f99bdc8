"""Which robots and objects of a scene the engine reads from MJCF files."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from morse.physics.model.layout import Motion
from morse.scene import is_dynamic

if TYPE_CHECKING:
    from collections.abc import Iterator

    import mujoco

    from morse.core.values import Options
    from morse.physics.model.layout import Frame
    from morse.scene import Node
    from morse.scene.mjcf import MjcfModel


@dataclass(eq=False, slots=True)
class Part:
    """What a root of the scene has of a file.

    Attributes:
        root: the frame of the robot or object.
        prefix: of the names in the engine.
        bodies, geoms: all of them, as elements of the model.
        option: options of the file.
    """

    root: Frame
    model: MjcfModel
    prefix: str
    option: Options
    bodies: list[mujoco.MjsBody] = field(default_factory=list)
    geoms: list[mujoco.MjsGeom] = field(default_factory=list)


def model_of(frame: Frame) -> MjcfModel | None:
    """Return the model of a frame whose bodies the engine reads from a file."""
    node, pose = frame.node, frame.motion
    settings = node.articulation
    if frame.parent is not None or settings is None or settings.model is None or pose is Motion.FIXED:
        return None
    if not settings.model.links or any(abs(value - 1.0) > 1e-9 for value in _scales(node)):
        return None
    armatures = [member for member in frame.members if member.bones]
    return settings.model if all(is_dynamic(armature) for armature in armatures) else None


def _scales(node: Node) -> Iterator[float]:
    one: Node | None = node
    while one is not None:
        yield from one.scale
        one = one.parent
