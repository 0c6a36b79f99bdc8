"""Assigns the nodes of a scene to the bodies of the physics, and to places in the arrays of the engine."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

from morse.scene import JointKind, PhysicsType, is_dynamic

if TYPE_CHECKING:
    from collections.abc import Container, Iterator

    from morse.physics.model.articulated import JointSlot
    from morse.scene import ComponentDeclaration, Node, Scene
    from morse.scene.frames import RigidFrame


class Motion(StrEnum):
    """How a frame moves."""

    FIXED = "fixed"
    FREE = "free"
    KINEMATIC = "kinematic"
    HINGE = "hinge"
    JOINT = "joint"
    VIRTUAL = "virtual"


@dataclass(eq=False, slots=True, weakref_slot=True)
class Frame:
    """A rigid group of nodes.

    Attributes:
        node: the first node, whose frame is the frame of the group.
        motion: free frames are dynamic; kinematic frames are moved by explicit calls and push others; hinge frames
            rotate about the local Z axis of their node; joint frames are moved by joints of an armature; virtual frames
            have no shape, or none that collides, and are moved by explicit calls.
        members: the node and the nodes below it that move with it.
        solid: the members with a shape that collides or is hit by rays.
        parent: the frame to which a hinge or joint frame is attached.
        robot: the declaration of the robot if the frame is a robot, else None.
        armature: the armature of a joint frame, else None.
        joints: indices of the bones of the armature whose joints move a joint frame, the innermost first; a bone that
            is fixed carries a frame whose load a sensor measures.
        carries: whether joint frames are attached to the frame.
    """

    node: Node
    motion: Motion
    members: list[Node] = field(default_factory=list)
    solid: list[Node] = field(default_factory=list)
    parent: Frame | None = None
    robot: ComponentDeclaration | None = None
    armature: Node | None = None
    joints: tuple[int, ...] = ()
    carries: bool = False

    @property
    def has_body(self) -> bool:
        """Whether the frame has a body in the engine."""
        has_part = bool(self.solid) or self.carries or bool(self.joints)
        is_of_file = _is_free_in_file(self.node) or _is_joined_in_file(self.node)
        return self.motion is not Motion.VIRTUAL and (has_part or is_of_file)

    @property
    def root(self) -> Frame:
        """The frame that this one is attached to, directly or not: the robot of a wheel or a link; else itself."""
        frame = self
        while frame.parent is not None:
            frame = frame.parent
        return frame


_WITH_SHAPES = (PhysicsType.STATIC, PhysicsType.SENSOR, PhysicsType.OCCLUDER, PhysicsType.KINEMATIC)


def has_shape(node: Node) -> bool:
    """Whether a node takes part in collisions, or only in contacts and rays."""
    return bool(node.shapes) and (node.body.moves or node.body.type in _WITH_SHAPES)


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
    measured = _measured_bones(scene)

    def visit(node: Node, frame: Frame | None) -> None:
        if node.flex is not None or (node.parent is not None and node.parent.flex is not None):
            # a deformable body and its vertices
            frame = Frame(node, Motion.VIRTUAL)
            frames.append(frame)
        elif node.name in wheels and frame is not None and frame.motion is Motion.FREE:
            frame = Frame(node, Motion.HINGE, parent=frame)
            frames.append(frame)
        elif (
            frame is None
            or (node in robots and frame.robot is None)
            or (node.body.type is PhysicsType.KINEMATIC and frame.motion in (Motion.FIXED, Motion.KINEMATIC))
        ):
            frame = Frame(node, _motion(node, node in robots), robot=robots.get(node))
            frames.append(frame)
        frame.members.append(node)
        if has_shape(node):
            frame.solid.append(node)
        hanging = _Hanging(node, measured.get(node, ())) if is_dynamic(node) else None
        for child in node.children:
            if hanging is None or child not in hanging.nodes:
                visit(child, frame)
        if hanging is not None:
            hang(hanging, -1, frame)

    def hang(hanging: _Hanging, bone: int, outer: Frame) -> None:
        """Add the frames of the bones below a bone, parents before their children."""
        for joints, nodes in hanging.below(bone):
            frame = Frame(nodes[0], Motion.JOINT, parent=outer, armature=hanging.armature, joints=joints)
            outer.carries = True
            frames.append(frame)
            for node in nodes:
                visit(node, frame)
            hang(hanging, joints[-1], frame)

    for root in scene.roots:
        visit(root, None)
    for frame in frames:
        if frame.carries and frame.motion is Motion.FIXED:
            frame.motion = Motion.KINEMATIC
        if frame.motion is Motion.KINEMATIC and not (frame.has_body and _touches(frame)):
            frame.motion = Motion.VIRTUAL
    return frames


def _touches(frame: Frame) -> bool:
    """Whether a frame that explicit calls move touches anything; the engine spends time on each body that it has."""
    if frame.node.body.type is not PhysicsType.KINEMATIC:
        return True
    return any(node.body.type is PhysicsType.SENSOR or node.body.collides for node in frame.solid)


def _measured_bones(scene: Scene) -> dict[Node, set[str]]:
    """Return the bones of armatures whose loads sensors measure."""
    measured: dict[Node, set[str]] = {}
    for declaration in scene.components:
        if declaration.measures_joint:
            for node in (declaration.node, *declaration.node.ancestors()):
                if node.bone and node.parent is not None and node.parent.bones:
                    measured.setdefault(node.parent, set()).add(node.bone)
                    break
    return measured


class _Hanging:
    """The nodes attached to the moving bones of an armature.

    Args:
        measured: names of bones that carry a body of their own although they may be fixed.

    Attributes:
        nodes: all nodes.
    """

    def __init__(self, armature: Node, measured: Container[str]) -> None:
        self.armature = armature
        bones = armature.bones
        index = {bone.name: i for i, bone in enumerate(bones)}
        moving: list[int] = []
        for i, bone in enumerate(bones):
            has_body = bone.kind is not JointKind.FIXED or bone.name in measured
            moving.append(i if has_body else moving[bone.parent] if bone.parent >= 0 else -1)
        self._on: dict[int, list[Node]] = {}
        for child in armature.children:
            if child.bone in index and moving[index[child.bone]] >= 0:
                self._on.setdefault(moving[index[child.bone]], []).append(child)
        # objects on the moving bone itself come first, and give the frame its name
        for i, nodes in self._on.items():
            nodes.sort(key=lambda node: node.bone != bones[i].name)
        self.nodes = {node for nodes in self._on.values() for node in nodes}
        self._children: dict[int, list[int]] = {}
        for i, bone in enumerate(bones):
            if moving[i] == i:
                self._children.setdefault(moving[bone.parent] if bone.parent >= 0 else -1, []).append(i)

    def below(self, bone: int) -> Iterator[tuple[tuple[int, ...], list[Node]]]:
        """Return for each body below a moving bone the bones that move it, and its nodes.

        Bones without attached objects move the next body; bones without a body at their end are skipped.
        """
        for child in self._children.get(bone, ()):
            path = [child]
            while path[-1] not in self._on and len(self._children.get(path[-1], ())) == 1:
                path.append(self._children[path[-1]][0])
            if path[-1] in self._on:
                yield tuple(path), self._on[path[-1]]


def _motion(node: Node, is_robot: bool) -> Motion:
    if node.body.moves and (_collides_somewhere(node) or _is_free_in_file(node)):
        return Motion.FREE
    if is_robot or node.body.moves or node.body.type is PhysicsType.KINEMATIC or _is_joined_in_file(node):
        return Motion.KINEMATIC
    return Motion.FIXED


def _is_free_in_file(node: Node) -> bool:
    """Whether a file declares a body that moves: of a URDF or SDF file by its masses, of an MJCF file by a free joint.

    What has no shapes that collide falls as well.
    """
    if node.articulation is None:
        return False
    return bool(node.articulation.model.base if node.articulation.model is not None else node.articulation.mass)


def _is_joined_in_file(node: Node) -> bool:
    """Whether a constraint joins a fixed part of a file with another part, or deformable bodies hang on it."""
    model = node.articulation.model if node.articulation is not None else None
    return model is not None and not model.base and (model.is_joined or bool(model.flexes))


def _collides_somewhere(node: Node) -> bool:
    return any(has_shape(member) for member in node.walk())


@dataclass(eq=False, slots=True)
class Slot:
    """The indices of a frame in the arrays of the engine; -1 or empty if the frame has no such item.

    Attributes:
        body: id of the MuJoCo body; 0 for static shapes that belong to the world, at their poses in it.
        qpos: address of the free joint (7 numbers) or hinge (1).
        dof: address of its velocity (6 or 1).
        mocap: mocap id.
        actuator: id of the wheel motor.
        geoms: geom ids by node, one for each shape of the node.
        feet: geom ids of the spheres on which a driven robot stands.
        joints: the joints of a joint frame, the innermost first; ``qpos`` and ``dof`` are those of the first one.
        soft: number of positions, and of velocities, of a deformable body.
    """

    frame: Frame
    pose: RigidFrame
    body: int = -1
    qpos: int = -1
    dof: int = -1
    mocap: int = -1
    actuator: int = -1
    geoms: dict[Node, list[int]] = field(default_factory=dict)
    feet: list[int] = field(default_factory=list)
    joints: list[JointSlot] = field(default_factory=list)
    soft: int = 0

    @property
    def numbers(self) -> tuple[int, int]:
        """Number of positions and velocities of the slot in the engine."""
        if self.qpos < 0:
            return 0, 0
        if self.frame.motion is Motion.FREE:
            return 7, 6
        if self.soft:
            return self.soft, self.soft
        return sum(joint.width for joint in self.joints) or 1, sum(joint.dofs for joint in self.joints) or 1
