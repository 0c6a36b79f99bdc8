"""Assigns the nodes of a scene to the bodies of the physics."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

from morse.scene import PhysicsType

if TYPE_CHECKING:
    from morse.scene import ComponentDeclaration, Node, Scene


class Motion(StrEnum):
    """How a frame moves."""

    FIXED = "fixed"
    FREE = "free"
    KINEMATIC = "kinematic"
    HINGE = "hinge"
    VIRTUAL = "virtual"


@dataclass(eq=False, slots=True)
class Frame:
    """A rigid group of nodes.

    Attributes:
        node: the node whose frame it is.
        motion: free frames are dynamic; kinematic frames are moved by explicit calls and push others; hinge frames
            rotate about the local Z axis of their node; virtual frames have no shape.
        members: the node and the nodes below it that move with it.
        solid: the members with a shape that collides or is hit by rays.
        parent: the frame to which a hinge is attached.
        robot: the declaration of the robot if the frame is a robot, else None.
    """

    node: Node
    motion: Motion
    members: list[Node] = field(default_factory=list)
    solid: list[Node] = field(default_factory=list)
    parent: Frame | None = None
    robot: ComponentDeclaration | None = None


def has_shape(node: Node) -> bool:
    """Whether a node takes part in collisions, or only in contacts and rays."""
    return bool(node.shapes) and (
        node.body.moves or node.body.type in (PhysicsType.STATIC, PhysicsType.SENSOR, PhysicsType.OCCLUDER)
    )


def driven_wheels(robot: ComponentDeclaration | None) -> list[str]:
    """Return the names of the driven wheels of a robot."""
    names = () if robot is None else robot.options.get("wheels", ())
    assert isinstance(names, (list, tuple))
    return [str(name) for name in names]


def frames_of(scene: Scene) -> list[Frame]:
    """Return the frames of a scene, in the order of its nodes."""
    robots = {c.node: c for c in scene.components if c.kind in ("robot", "external_robot")}
    wheels: dict[str, ComponentDeclaration] = {}
    for declaration in robots.values():
        wheels.update(dict.fromkeys(driven_wheels(declaration), declaration))
    frames: list[Frame] = []

    def visit(node: Node, frame: Frame | None) -> None:
        if node.name in wheels and frame is not None and frame.motion is Motion.FREE:
            frame = Frame(node, Motion.HINGE, parent=frame)
            frames.append(frame)
        elif frame is None or (node in robots and frame.robot is None):
            frame = Frame(node, _motion(node, node in robots), robot=robots.get(node))
            frames.append(frame)
        frame.members.append(node)
        if has_shape(node):
            frame.solid.append(node)
        for child in node.children:
            visit(child, frame)

    for root in scene.roots:
        visit(root, None)
    for frame in frames:
        if frame.motion is Motion.KINEMATIC and not frame.solid:
            frame.motion = Motion.VIRTUAL
    return frames


def _motion(node: Node, is_robot: bool) -> Motion:
    if node.body.moves and _collides_somewhere(node):
        return Motion.FREE
    if is_robot or node.body.moves:
        return Motion.KINEMATIC
    return Motion.FIXED


def _collides_somewhere(node: Node) -> bool:
    return any(has_shape(member) for member in node.walk())
