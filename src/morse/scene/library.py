"""The content of one model file, as returned by a reader."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.scene.component import DeclaredSensor
    from morse.scene.mesh import Image
    from morse.scene.node import Node


@dataclass(frozen=True, slots=True)
class Keyframe:
    """A pose of a robot that its file names.

    Attributes:
        joints: joint to its value, rad or m; four values, a quaternion w, x, y, z, for a ball.
        place: position (m) and quaternion of a free robot, or None.
    """

    joints: dict[str, tuple[float, ...]]
    place: tuple[tuple[float, ...], tuple[float, ...]] | None = None


@dataclass(eq=False, slots=True)
class Library:
    """The nodes of one file, in the order in which the file lists them.

    Attributes:
        path: the file.
        roots: the nodes without a parent.
        collections: name to the names of the nodes in it (Blender's groups and collections).
        world: properties of the world the file describes: ``horizon_color`` (linear RGB), ``ambient_color``,
            ``gravity`` (m/s^2), ``mist``, ``properties`` (of the environment); only those that the file contains.
        outside_scene: names of nodes that are in the file but not in its scene: templates, which are shown only by
            instances of their collection.
        images: images by name, for textures that no material uses.
        sensors: the sensors that the file declares.
        walkers: actuators that move an object of a world, which its ``link`` names.
        actuators: actuators that plugins of the file stand for.
        robot: name of the root that is the robot if a robot is loaded from the file of a world; empty if all objects of
            the file belong to one robot.
        has_free_joints: whether joints move freely until a robot drives them.
        keyframes: poses of the robot by name.
        warnings: warnings for the user about what could not be read, one sentence each.
    """

    path: str
    roots: list[Node] = field(default_factory=list)
    collections: dict[str, list[str]] = field(default_factory=dict)
    world: dict[str, object] = field(default_factory=dict)
    outside_scene: set[str] = field(default_factory=set)
    images: dict[str, Image] = field(default_factory=dict)
    sensors: list[DeclaredSensor] = field(default_factory=list)
    actuators: list[DeclaredSensor] = field(default_factory=list)
    walkers: list[DeclaredSensor] = field(default_factory=list)
    robot: str = ""
    has_free_joints: bool = False
    keyframes: dict[str, Keyframe] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)

    def nodes(self) -> list[Node]:
        """Every node, parents before their children."""
        return [node for root in self.roots for node in root.walk()]
