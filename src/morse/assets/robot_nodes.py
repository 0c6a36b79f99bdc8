"""The nodes of a robot: a body, and below it an armature that moves the links."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from morse.assets import solids
from morse.assets.description import WORLD
from morse.assets.errors import AssetError
from morse.assets.meshfiles.reader import MeshError, mesh_nodes
from morse.assets.nearby_files import FileRefusedError, find_near
from morse.assets.triangle_limit import check_parts
from morse.mathutils import Matrix, Vector
from morse.mathutils.rotations import nine
from morse.scene import (
    Articulation,
    BodySettings,
    Bone,
    Bounds,
    JointKind,
    Library,
    Material,
    Node,
    NodeKind,
    PhysicsType,
    ShapeKind,
)
from morse.scene.articulation import Couplings, start_frames

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from morse.assets.description import Joint, Link, RobotDescription, Shape
    from morse.scene import JointDynamics

_KINDS = {
    "revolute": JointKind.REVOLUTE,
    "continuous": JointKind.REVOLUTE,
    "prismatic": JointKind.PRISMATIC,
    "planar": JointKind.PLANAR,
    "floating": JointKind.FLOATING,
    "spherical": JointKind.BALL,
}
_BOUNDS = {
    "box": Bounds.BOX,
    "sphere": Bounds.SPHERE,
    "cylinder": Bounds.CYLINDER,
    "capsule": Bounds.CAPSULE,
    "mesh": Bounds.CONVEX_HULL,
}
_GREY = (0.7, 0.7, 0.7, 1.0)


def joint_bone(
    name: str,
    parent: int,
    frame: Matrix,
    kind: JointKind,
    limits: tuple[float, float],
    value: float,
    dynamics: JointDynamics,
) -> Bone:
    """Return the bone of a joint, which turns about the Z axis of the bone or slides along it.

    Args:
        parent: index of the bone above, -1 for none.
        frame: 4x4 in the frame of the bone above, at joint value 0.
        limits: smallest and largest value, rad or m.
        value: initial value.
    """
    x, y, z = frame.translation
    low, high = limits
    free = (False, False, kind is JointKind.REVOLUTE)
    rotation = nine(list(frame.to_3x3()))
    return Bone(name, parent, (x, y, z), rotation, 0.0, kind, 2, free, low, high, value, dynamics=dynamics)


def robot_node(name: str, body: BodySettings, bones: Sequence[Bone]) -> tuple[Node, Node]:
    """Return the node of a robot, and the armature ``<name>_joints`` below it."""
    root = Node(name, body=body, source_name=name)
    armature = Node(f"{name}_joints", NodeKind.ARMATURE, source_name=f"{name}_joints")
    armature.bones = tuple(bones)
    root.attach(armature)
    return root, armature


def attach_links(armature: Node, links: Iterable[tuple[Node, int, Matrix]]) -> None:
    """Attach links to an armature, where its joints have their initial values.

    Args:
        links: link, the index of the bone that carries it (-1 for none), and its 4x4 in the frame of this bone.
    """
    frames = []
    for position, r in start_frames(armature.bones):
        frames.append(Matrix((r[:3], r[3:6], r[6:])).to_4x4())
        frames[-1].translation = position
    for link, bone, local in links:
        place = local if bone < 0 else frames[bone] @ local
        link.bone = armature.bones[bone].name if bone >= 0 else ""
        link.location, link.rotation_euler = list(place.translation), list(place.to_euler())
        armature.attach(link)


def robot_library(path: Path, document: RobotDescription) -> Library:
    """Return the nodes of a robot."""
    return _RobotNodes(path, document).library()


class _RobotNodes:
    def __init__(self, path: Path, document: RobotDescription) -> None:
        self.path = path
        self.document = document
        self.warnings = list(document.warnings)
        self._libraries: dict[Path, Library] = {}
        self._warnings: set[str] = set()
        self._parts = 0

    def library(self) -> Library:
        document = self.document
        links = document.links.values()
        mass = sum(link.inertial.mass for link in links if link.inertial is not None)
        body = BodySettings(
            type=PhysicsType.STATIC if self._is_fixed(mass) else PhysicsType.RIGID_BODY,
            compound=True,
            mass=mass or 1.0,
        )
        root, armature = robot_node(document.name, body, self._bones())
        root.articulation = Articulation(mass=mass, description=document.text, meshes=tuple(document.files.items()))
        couplings = Couplings(constraints=document.constraints)
        armature.articulation = Articulation(mass=mass, self_collision=document.self_collision, couplings=couplings)
        carriers = {joint.child: (index, _turn(joint).inverted()) for index, joint in enumerate(document.joints)}
        nowhere = (-1, Matrix.Identity(4))
        attach_links(armature, [(self._link(link), *carriers.get(link.name, nowhere)) for link in links])
        return Library(
            str(self.path), roots=[root], sensors=document.sensors, actuators=document.actuators, warnings=self.warnings
        )

    def _is_fixed(self, mass: float) -> bool:
        """Whether the robot is fixed to the world: the links that move with the first one have no mass."""
        document = self.document
        if document.fixed is not None:
            return document.fixed
        if document.root == WORLD:
            return True
        if not any(link.inertial is not None for link in document.links.values()):
            return False
        if not mass:
            return True
        rigid = {document.root}
        for joint in document.joints:
            if joint.kind not in _KINDS and joint.parent in rigid:
                rigid.add(joint.child)
        return not any(i.mass for name in rigid if (i := document.links[name].inertial) is not None)

    # -- joints ----------------------------------------------------------------------------

    def _bones(self) -> list[Bone]:
        joints = self.document.joints
        index = {joint.name: i for i, joint in enumerate(joints)}
        above = {joint.child: i for i, joint in enumerate(joints)}
        bones = []
        for joint in joints:
            parent = above.get(joint.parent, -1)
            local = joint.origin @ _turn(joint)
            if parent >= 0:
                # from the frame of the parent link to the frame of its bone
                local = _turn(joints[parent]).inverted() @ local
            kind = _KINDS.get(joint.kind, JointKind.FIXED)
            leader, factor, offset = joint.mimic or ("", 1.0, 0.0)
            start = min(max(0.0, joint.low), joint.high) if joint.start is None else joint.start
            bone = joint_bone(joint.name, parent, local, kind, (joint.low, joint.high), start, joint.dynamics)
            bones.append(replace(bone, leader=index[leader] if leader else -1, factor=factor, offset=offset))
        return bones

    # -- links -----------------------------------------------------------------------------

    def _link(self, link: Link) -> Node:
        node = Node(link.name, source_name=link.name, inertial=link.inertial)
        for number, shape in enumerate(link.visuals, 1):
            self._add(node, f"{link.name}_visual{number}", shape, is_solid=False)
        for number, shape in enumerate(link.collisions, 1):
            self._add(node, f"{link.name}_collision{number}", shape, is_solid=True)
        if link.friction is not None:
            for part in node.walk():
                part.body.friction = link.friction
        for part in link.parts:
            node.attach(part)
        return node

    def _add(self, link: Node, name: str, shape: Shape, *, is_solid: bool) -> None:
        node = Node(name, source_name=name, location=list(shape.origin.translation))
        node.rotation_euler = list(shape.origin.to_euler())
        if shape.kind == "mesh":
            for part in self._mesh(shape):
                node.attach(part)
            self._parts += sum(1 for _ in node.walk())
            check_parts(self.path, self._parts, "nodes of meshes in its links")
            node.scale = list(shape.size)
        else:
            node.kind = NodeKind.MESH
            node.mesh, scale = solids.primitive(ShapeKind(shape.kind), shape.size)
            node.scale = list(scale)
            node.materials = [Material(name, shape.color or _GREY)]
        for part in node.walk():
            part.visible = not is_solid
            part.body = BodySettings()
            if is_solid and part.mesh is not None:
                part.body = BodySettings(type=PhysicsType.STATIC, bounds=_BOUNDS[shape.kind])
            if shape.color is not None and part.mesh is not None:
                part.color = shape.color
        link.attach(node)

    def _mesh(self, shape: Shape) -> list[Node]:
        """The nodes of a mesh file; if it cannot be read, an empty list and a warning."""
        try:
            # the makers of such files, and the viewers of ROS, do not turn glTF
            return mesh_nodes(find_near(shape.file, self.path), libraries=self._libraries, keeps_axes=True)
        except (AssetError, FileRefusedError, MeshError, OSError) as error:
            if shape.file not in self._warnings:
                self._warnings.add(shape.file)
                reason = error.message if isinstance(error, AssetError) else str(error)
                self.warnings.append(f"the mesh '{shape.file:.200}' is left out: {reason}")
            return []


def _turn(joint: Joint) -> Matrix:
    """4x4 pose of a bone, which rotates about its Z axis here, in the frame of the child of its joint."""
    anchor = joint.anchor or Matrix.Identity(4)
    if not joint.has_value and joint.kind != "planar":
        return anchor
    rotation: Matrix = Vector((0.0, 0.0, 1.0)).rotation_difference(joint.axis).to_matrix().to_4x4()
    return anchor @ rotation
