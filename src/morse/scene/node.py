"""A node of the scene graph: pose, appearance and collision."""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import TYPE_CHECKING
from weakref import WeakValueDictionary

from morse.mathutils import Euler, Matrix
from morse.scene.articulation import CONTROL, DYNAMIC, Articulation, Control
from morse.scene.body import BodySettings
from morse.scene.mesh import Image, Material

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy import int32
    from numpy.typing import NDArray

    from morse.scene.articulation import Bone, Inertial
    from morse.scene.body import CollisionShape
    from morse.scene.component import SourceLine
    from morse.scene.mesh import Camera, Light, Mesh


_COPY_SUFFIX = re.compile(r"[._]\d{3}$")


class NodeKind(StrEnum):
    """The fields of a node, apart from its position in the tree."""

    EMPTY = "EMPTY"
    MESH = "MESH"
    LIGHT = "LIGHT"
    CAMERA = "CAMERA"
    ARMATURE = "ARMATURE"


@dataclass(eq=False, slots=True, weakref_slot=True)
class Node:
    """One object of the scene.

    The pose is stored as in Blender, so that numbers in scene scripts have the same meaning: ``world = parent_world @
    parent_inverse @ T(location) @ R(rotation_euler) @ S(scale)``.

    Attributes:
        name: unique within a scene once the scene is built.
        location: metres, in the parent's frame.
        rotation_euler: radians, XYZ order (``R = Rz @ Ry @ Rx``).
        scale: factor for each axis.
        parent_inverse: 4x4 matrix that was recorded when the node was parented, or None for the identity.
        source_name: the name of the node in its file (None if it has no file).
        properties: typed properties that components and services read (``obj['name']``).
        debug: the properties that ``env.show_debug_properties()`` shows from the beginning.
        shapes: collision shapes in the rigid frame of the node, or None until they are computed
            (`morse.assets.collision`).
        color: RGBA that replaces the colour of every material, or None.
        image: texture that replaces those of all materials, or None.
        bones: bones of an armature, parents before their children.
        bone: name of the bone of the parent to which the node is attached; empty for the parent itself.
        inertial: mass of a link whose joint the physics moves, or None.
        articulation: joints of an armature whose joints the physics moves, or of the robot to which it belongs; or
            None.
        where: the line of the script that created it, or None if that is the line of the parent.
    """

    name: str
    kind: NodeKind = NodeKind.EMPTY
    location: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    rotation_euler: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    scale: list[float] = field(default_factory=lambda: [1.0, 1.0, 1.0])
    parent: Node | None = None
    children: list[Node] = field(default_factory=list)
    parent_inverse: Matrix | None = None
    mesh: Mesh | None = None
    materials: list[Material | None] = field(default_factory=list)
    light: Light | None = None
    camera: Camera | None = None
    body: BodySettings = field(default_factory=BodySettings)
    properties: dict[str, object] = field(default_factory=dict)
    debug: tuple[str, ...] = ()
    visible: bool = True
    color: tuple[float, float, float, float] | None = None
    image: Image | None = None
    source_name: str | None = None
    shapes: list[CollisionShape] | None = None
    bones: tuple[Bone, ...] = ()
    bone: str = ""
    inertial: Inertial | None = None
    articulation: Articulation | None = None
    where: SourceLine | None = None

    @property
    def plain_name(self) -> str:
        """The name in the source file without a copy suffix (``left_eye`` for ``left_eye.001``)."""
        return _COPY_SUFFIX.sub("", self.source_name or self.name)

    @property
    def flex(self) -> NDArray[int32] | None:
        """Which child each vertex of its mesh follows, (V,), if it is a deformable body; see `Mesh.follows`."""
        return None if self.mesh is None else self.mesh.follows

    @property
    def line(self) -> SourceLine | None:
        """The line of the script that created it, or the nearest node above it; None for the world itself."""
        return next((node.where for node in (self, *self.ancestors()) if node.where is not None), None)

    def attach(self, child: Node, *, keep_world_pose: bool = False) -> None:
        """Make ``child`` a child of this node; its local pose is kept unless ``keep_world_pose``.

        Raises:
            ValueError: the node would become its own ancestor.
        """
        if child is self or any(a is child for a in self.ancestors()):
            raise ValueError(f"'{child.name}' cannot be attached to '{self.name}', which is part of it")
        world = child.world_matrix() if keep_world_pose else None
        child.detach()
        child.parent = self
        self.children.append(child)
        if world is not None:
            # as in Blender's "set parent", the pose values for scripts do not change
            child.parent_inverse = self.world_matrix().inverted() @ world @ child.basis_matrix().inverted()

    def detach(self) -> None:
        """Remove the node from its parent; its local pose values are unchanged."""
        if self.parent is not None:
            self.parent.children.remove(self)
            self.parent = None
        self.parent_inverse = None

    def ancestors(self) -> Iterator[Node]:
        """The parent, the parent of the parent, and so on."""
        node = self.parent
        while node is not None:
            yield node
            node = node.parent

    def walk(self) -> Iterator[Node]:
        """This node and all nodes below it, parents first."""
        stack = [self]
        while stack:
            node = stack.pop()
            yield node
            stack.extend(reversed(node.children))

    def basis_matrix(self) -> Matrix:
        """4x4 matrix of location, rotation and scale."""
        rotation = Euler(self.rotation_euler).to_matrix()
        sx, sy, sz = self.scale
        x, y, z = self.location
        (a, b, c), (d, e, f), (g, h, i) = (tuple(row) for row in rotation)
        return Matrix(
            (
                (a * sx, b * sy, c * sz, x),
                (d * sx, e * sy, f * sz, y),
                (g * sx, h * sy, i * sz, z),
                (0.0, 0.0, 0.0, 1.0),
            )
        )

    def local_matrix(self) -> Matrix:
        """4x4 matrix from the frame of this node to that of its parent."""
        basis = self.basis_matrix()
        return basis if self.parent_inverse is None else self.parent_inverse @ basis

    def world_matrix(self) -> Matrix:
        """4x4 matrix from the frame of this node to the world."""
        local = self.local_matrix()
        return local if self.parent is None else self.parent.world_matrix() @ local


def is_dynamic(armature: Node) -> bool:
    """Whether the physics moves the joints of a node: if its file has masses, or if a script asks for it."""
    return bool(armature.bones) and bool(armature.properties.get(DYNAMIC, armature.articulation is not None))


def controls_of(armature: Node) -> dict[str, Control]:
    """Return the control mode of the motor of each joint of an armature."""
    settings = armature.articulation or Articulation()
    word = armature.properties.get(CONTROL)
    common = Control(word) if isinstance(word, str) and word in list(Control) else None
    control = dict(settings.control)
    controls = {}
    for bone in armature.bones:
        own = bone.dynamics.control if bone.dynamics is not None else None
        controls[bone.name] = control.get(bone.name) or common or own or Control.POSITION
    return controls


_PLAIN = Material("")
#: the same images of all simulations, so that they are decoded once
_IMAGES: WeakValueDictionary[bytes, Image] = WeakValueDictionary()


def slot_materials(node: Node, mesh: Mesh) -> list[Material]:
    """The material of every slot that a mesh uses: that of the node, otherwise that of the mesh."""
    slot_count = int(mesh.material_index.max(initial=0)) + 1
    slots = []
    for slot in range(slot_count):
        own = node.materials[slot] if slot < len(node.materials) else None
        default = mesh.materials[slot] if slot < len(mesh.materials) else None
        slots.append(own or default or _PLAIN)
    return slots if node.image is None else [replace(material, image=node.image) for material in slots]


def shared_image(name: str, data: bytes, mime: str) -> Image:
    """Return an image; the same object for the same bytes."""
    key = hashlib.blake2b(data, digest_size=16).digest()
    image = _IMAGES.get(key)
    if image is None:
        image = _IMAGES[key] = Image(name, data, mime)
    return image


def is_shown(node: Node, visible: bool) -> bool:
    """Whether a node is visible.

    Args:
        visible: whether its object is visible; the property ``visible`` can also hide it.
    """
    return visible and node.properties.get("visible", True) not in (0, "0", "false", "False")
