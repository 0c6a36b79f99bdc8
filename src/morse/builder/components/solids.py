"""Simple visual objects: solids, lamps, cameras. By default they do not collide."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets import solids
from morse.builder import workspace
from morse.builder.abstractcomponent import AbstractComponent
from morse.builder.components.matter import Matter
from morse.builder.errors import checks
from morse.builder.objects import SceneObject
from morse.scene import Camera as CameraLens
from morse.scene import Light, Material, Node, NodeKind

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.scene import Mesh as MeshData

# scripts import all names of this module; `Light` of the scene would hide the actuator of that name
__all__ = [
    "BlenderObject",
    "Camera",
    "Cone",
    "Coordsys",
    "Cube",
    "Cylinder",
    "Empty",
    "IcoSphere",
    "Mesh",
    "Plane",
    "Sphere",
    "Spot",
    "Torus",
]

_LAMPS = ("POINT", "SUN", "SPOT", "AREA", "HEMI")


class BlenderObject(AbstractComponent):
    """An object without behaviour.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
    """

    _node_kind = NodeKind.EMPTY

    def __init__(self, name: str | None = None) -> None:
        super().__init__()
        node = Node(type(self).__name__, kind=self._node_kind)
        self._furnish(node)
        workspace.current().add(node)
        self.set_blender_object(SceneObject(node))
        if name is not None:
            self.name = name

    def _furnish(self, node: Node) -> None:
        """Set up the node for this kind of object."""


class Empty(BlenderObject):
    """A frame without a body."""


class Mesh(BlenderObject, Matter):
    """A solid: a mesh of one colour. `static` lets other bodies collide with it, `set_rigid_body` lets it move."""

    _node_kind = NodeKind.MESH

    def _furnish(self, node: Node) -> None:
        node.mesh = self._mesh()
        node.materials = [Material(type(self).__name__)]

    def _mesh(self) -> MeshData:
        return solids.cube()

    def _solid_nodes(self) -> Iterator[Node]:
        yield self.scene_node

    def color(self, r: float = 0.0, g: float = 0.0, b: float = 0.0, alpha: float = 1.0) -> None:
        """Set its colour: red, green, blue, and the opacity, such as 0.3 for glass; all 0..1."""
        rgb = checks.color((r, g, b), f"{type(self).__name__}.color")
        opacity = checks.share(alpha, f"{type(self).__name__}.color(alpha)")
        self.scene_node.materials = [Material(self.name, (*rgb, opacity))]


class Cube(Mesh):
    """A cube of 2 x 2 x 2 m."""


class Plane(Mesh):
    """A square of 2 x 2 m that faces Z."""

    def _mesh(self) -> MeshData:
        return solids.plane()


class Cylinder(Mesh):
    """A cylinder of radius 1 m, 2 m high."""

    def _mesh(self) -> MeshData:
        return solids.cylinder()


class Cone(Mesh):
    """A cone of radius 1 m, 2 m high."""

    def _mesh(self) -> MeshData:
        return solids.cone()


class Sphere(Mesh):
    """A sphere of radius 1 m."""

    def _mesh(self) -> MeshData:
        return solids.sphere()


class IcoSphere(Mesh):
    """A sphere of radius 1 m, of triangles of nearly equal size."""

    def _mesh(self) -> MeshData:
        return solids.ico_sphere()


class Torus(Mesh):
    """A ring of radius 1 m, its tube of radius 0.25 m."""

    def _mesh(self) -> MeshData:
        return solids.torus()


class Coordsys(BlenderObject):
    """Three arrows of 1 m: X red, Y green, Z blue."""

    def _furnish(self, node: Node) -> None:
        half = 1.5707963267948966
        for axis, rotation, color in (
            ("x", [0.0, half, 0.0], (1.0, 0.0, 0.0, 1.0)),
            ("y", [-half, 0.0, 0.0], (0.0, 1.0, 0.0, 1.0)),
            ("z", [0.0, 0.0, 0.0], (0.0, 0.0, 1.0, 1.0)),
        ):
            arrow = Node(f"{node.name}_{axis}", rotation_euler=rotation)
            shaft = Node(f"{node.name}_{axis}_shaft", kind=NodeKind.MESH, mesh=solids.cylinder())
            shaft.location, shaft.scale = [0.0, 0.0, 0.4], [0.02, 0.02, 0.4]
            tip = Node(f"{node.name}_{axis}_tip", kind=NodeKind.MESH, mesh=solids.cone())
            tip.location, tip.scale = [0.0, 0.0, 0.9], [0.05, 0.05, 0.1]
            for part in (shaft, tip):
                part.materials = [Material(f"{node.name}_{axis}", color, shadeless=True)]
                arrow.attach(part)
            node.attach(arrow)


class Spot(BlenderObject):
    """A lamp that shines along its -Z axis.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        lamp_type: ``SPOT``, ``POINT``, ``SUN``, ``AREA`` or ``HEMI``.
    """

    _node_kind = NodeKind.LIGHT

    def __init__(self, name: str | None = None, lamp_type: str = "SPOT") -> None:
        self._lamp_type = checks.choice(lamp_type, _LAMPS, "Spot(lamp_type)")
        super().__init__(name)

    def _furnish(self, node: Node) -> None:
        node.light = Light(self._lamp_type)


class Camera(BlenderObject):
    """A viewpoint that looks along its -Z axis."""

    _node_kind = NodeKind.CAMERA

    def _furnish(self, node: Node) -> None:
        node.camera = CameraLens()
