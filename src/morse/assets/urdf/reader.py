"""URDF files as libraries of nodes: a body, and below it an armature that moves the links."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets import solids
from morse.assets.errors import AssetError
from morse.assets.meshfiles.reader import MeshError, mesh_nodes
from morse.assets.nearby_files import FileRefusedError, find_near
from morse.assets.triangle_limit import check_parts
from morse.assets.urdf.document import WORLD, parse
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
)
from morse.scene.articulation import Couplings

if TYPE_CHECKING:
    from morse.assets.urdf.structure import Document, Joint, Link, Shape
    from morse.scene import Mesh

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


def read_urdf(path: str | Path) -> Library:
    """Read a robot.

    Its links become nodes with the same names below the armature ``<robot>_joints``, whose bones are the joints.

    Raises:
        AssetError: the file is broken or contradicts itself.
        OSError: it cannot be opened.
    """
    path = Path(path)
    return robot_library(path, parse(path))


def robot_library(path: Path, document: Document) -> Library:
    """Return the nodes of a robot."""
    return _Reader(path, document).library()


class _Reader:
    def __init__(self, path: Path, document: Document) -> None:
        self.path = path
        self.document = document
        self.warnings = list(document.warnings)
        self._libraries: dict[Path, Library] = {}
        self._warnings: set[str] = set()
        self._parts = 0

    def library(self) -> Library:
        document = self.document
        mass = sum(link.inertial.mass for link in document.links.values() if link.inertial is not None)
        body = BodySettings(
            type=PhysicsType.STATIC if self._is_fixed(mass) else PhysicsType.RIGID_BODY,
            compound=True,
            mass=mass or 1.0,
        )
        root = Node(document.name, body=body, source_name=document.name)
        armature = Node(f"{document.name}_joints", NodeKind.ARMATURE, source_name=f"{document.name}_joints")
        armature.bones = tuple(self._bones())
        root.articulation = Articulation(mass=mass, description=document.text, meshes=tuple(document.files.items()))
        couplings = Couplings(constraints=document.constraints)
        armature.articulation = Articulation(mass=mass, self_collision=document.self_collision, couplings=couplings)
        root.attach(armature)
        frames, rotations = self._start(armature.bones), {joint.child: _turn(joint) for joint in document.joints}
        joint_names = {joint.child: joint.name for joint in document.joints}
        for link in document.links.values():
            node = self._link(link)
            if link.name in joint_names:
                node.bone = joint_names[link.name]
                frame = frames[node.bone] @ rotations[link.name].inverted()
                node.location, node.rotation_euler = list(frame.translation), list(frame.to_euler())
            armature.attach(node)
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
            x, y, z = local.translation
            turns = kind is JointKind.REVOLUTE
            bones.append(
                Bone(
                    joint.name,
                    parent,
                    (x, y, z),
                    nine(list(local.to_3x3())),
                    0.0,
                    kind,
                    axis=2,
                    free=(False, False, turns),
                    low=joint.low,
                    high=joint.high,
                    value=min(max(0.0, joint.low), joint.high) if joint.start is None else joint.start,
                    leader=index[leader] if leader else -1,
                    factor=factor,
                    offset=offset,
                    dynamics=joint.dynamics,
                )
            )
        return bones

    def _start(self, bones: tuple[Bone, ...]) -> dict[str, Matrix]:
        """The initial frame of each bone in the frame of the armature."""
        frames: list[Matrix] = []
        for bone in bones:
            frame = Matrix((bone.rotation[:3], bone.rotation[3:6], bone.rotation[6:])).to_4x4()
            frame.translation = bone.position
            value = bone.value if bone.leader < 0 else bone.factor * bones[bone.leader].value + bone.offset
            if bone.kind is JointKind.REVOLUTE:
                frame = frame @ Matrix.Rotation(value, 4, "Z")
            elif bone.kind is JointKind.PRISMATIC:
                frame = frame @ Matrix.Translation((0.0, 0.0, value))
            frames.append(frame if bone.parent < 0 else frames[bone.parent] @ frame)
        return {bone.name: frame for bone, frame in zip(bones, frames, strict=True)}

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
            node.mesh, scale = _primitive(shape)
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


def _primitive(shape: Shape) -> tuple[Mesh, tuple[float, ...]]:
    """A mesh, and its scale."""
    if shape.kind == "box":
        x, y, z = shape.size
        return solids.cube(), (0.5 * x, 0.5 * y, 0.5 * z)
    if shape.kind == "cylinder":
        radius, length = shape.size
        return solids.round_cylinder(radius), (radius, radius, 0.5 * length)
    if shape.kind == "capsule":
        radius, length = shape.size
        return solids.capsule(radius, 0.5 * length), (1.0, 1.0, 1.0)
    return solids.ball(shape.size[0]), (shape.size[0],) * 3


def _turn(joint: Joint) -> Matrix:
    """4x4 pose of a bone, which rotates about its Z axis here, in the frame of the child of its joint."""
    anchor = joint.anchor or Matrix.Identity(4)
    if not joint.has_value and joint.kind != "planar":
        return anchor
    rotation: Matrix = Vector((0.0, 0.0, 1.0)).rotation_difference(joint.axis).to_matrix().to_4x4()
    return anchor @ rotation
