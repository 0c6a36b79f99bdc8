"""Meshes, lamps and cameras of objects under the names of Blender: ``object.data``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.assets.solids import polyhedron
from morse.builder.blender.materials import ObjectMaterial, SharedMaterial, material_slots
from morse.builder.errors import checks
from morse.builder.legacy.ignored import Facade
from morse.mathutils import Vector
from morse.scene import Camera, NodeKind

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from morse.scene import Light, Node

_KINDS = {NodeKind.MESH: "MESH", NodeKind.LIGHT: "LAMP", NodeKind.CAMERA: "CAMERA", NodeKind.ARMATURE: "ARMATURE"}


def kind_of(node: Node) -> str:
    """The type of an object as Blender names it; the object of a camera sensor is a ``CAMERA``."""
    if "cam_far" in node.properties or "cam_focal" in node.properties or ".video_camera." in _classpath(node):
        return "CAMERA"
    return _KINDS.get(node.kind, "EMPTY")


def _classpath(node: Node) -> str:
    return str(node.properties.get("classpath", ""))


class _Materials(list[Any]):
    """The material slots of a mesh."""

    def __init__(self, node: Node) -> None:
        super().__init__(
            None if material is None else ObjectMaterial(node, index)
            for index, material in enumerate(material_slots(node))
        )
        self._node = node

    def _store(self) -> None:
        self._node.materials[:] = [None if item is None else item.read() for item in self]

    def append(self, material: object) -> None:
        _check(material)
        super().append(material)
        self._store()

    def __setitem__(self, key: Any, value: Any) -> None:
        for material in value if isinstance(key, slice) else [value]:
            _check(material)
        super().__setitem__(key, value)
        self._store()

    def clear(self, *_: object) -> None:
        super().clear()
        self._node.materials.clear()

    def pop(self, index: Any = -1, *_: Any) -> Any:
        material = super().pop(index)
        self._store()
        return material


def _check(material: object) -> None:
    if not isinstance(material, (ObjectMaterial, SharedMaterial)):
        raise TypeError(f"a material such as bpy.data.materials.new('Red') is expected, got {checks.shown(material)}")


class MeshData(Facade):
    """The mesh of an object."""

    _path = "mesh"

    def __init__(self, node: Node) -> None:
        self._node = node

    @property
    def name(self) -> str:
        """Its name."""
        return self._node.mesh.name if self._node.mesh is not None else self._node.name

    @name.setter
    def name(self, value: str) -> None:
        checks.text(value, "mesh.name")

    @property
    def materials(self) -> list[Any]:
        """The material slots."""
        return _Materials(self._node)

    @property
    def vertices(self) -> list[Vertex]:
        """The vertices; copies."""
        return [Vertex(point) for point in self._points()]

    def size(self) -> Vector:
        """The size along each axis of the object, with its scale, m."""
        points = self._points()
        if not points:
            return Vector((0.0, 0.0, 0.0))
        axes = zip(*points, strict=True)
        return Vector([(max(a) - min(a)) * scale for a, scale in zip(axes, self._node.scale, strict=True)])

    def corners(self) -> list[Vector]:
        """The corners of the box around it, without a scale, m."""
        axes = [(min(a), max(a)) for a in zip(*self._points(), strict=True)] or [(0.0, 0.0)] * 3
        return [Vector((x, y, z)) for x in axes[0] for y in axes[1] for z in axes[2]]

    def _points(self) -> list[list[float]]:
        mesh = self._node.mesh
        return [] if mesh is None else [[float(x) for x in point] for point in mesh.vertices]

    def from_pydata(
        self, vertices: Iterable[Sequence[float]], edges: Iterable[Sequence[int]], faces: Iterable[Sequence[int]]
    ) -> None:
        """Replace the mesh: points, m, and convex faces as indices of points; edges have no effect."""
        points = [checks.triple(point, "from_pydata(vertices)") for point in vertices]
        corners = [tuple(int(corner) for corner in face) for face in faces]
        if any(not 0 <= corner < len(points) for face in corners for corner in face):
            raise ValueError(f"from_pydata(faces) takes indices of the {len(points)} vertices")
        self._node.mesh = polyhedron(self.name, points, corners)

    def update(self, *_args: object, **_kwargs: object) -> None:
        """Accepted for old scripts: there is nothing to compute."""

    validate = update

    def copy(self) -> MeshData:
        """The mesh itself: what a script changes of an object does not change others."""
        return self


class Vertex:
    """A vertex of a mesh."""

    __slots__ = ("co",)

    def __init__(self, point: Sequence[float]) -> None:
        self.co = Vector(point)


class LampData(Facade):
    """The lamp of an object."""

    _path = "lamp"

    def __init__(self, node: Node) -> None:
        self._node = node

    def _lamp(self) -> Light:
        assert self._node.light is not None
        return self._node.light

    @property
    def type(self) -> str:
        """POINT, SUN, SPOT, AREA or HEMI."""
        return self._lamp().type

    @type.setter
    def type(self, value: str) -> None:
        self._lamp().type = checks.choice(value, ("POINT", "SUN", "SPOT", "AREA", "HEMI"), "lamp.type")

    @property
    def color(self) -> tuple[float, float, float]:
        """Linear RGB, 0..1."""
        return self._lamp().color

    @color.setter
    def color(self, value: Iterable[float]) -> None:
        self._lamp().color = checks.color(value, "lamp.color")

    @property
    def energy(self) -> float:
        """Brightness; 1 is a normal lamp."""
        return self._lamp().energy

    @energy.setter
    def energy(self, value: float) -> None:
        self._lamp().energy = checks.number(value, "lamp.energy", minimum=0.0)

    @property
    def distance(self) -> float:
        """Distance at which the intensity has fallen to half, m."""
        return self._lamp().distance

    @distance.setter
    def distance(self, value: float) -> None:
        self._lamp().distance = checks.number(value, "lamp.distance", above=0.0)

    @property
    def spot_size(self) -> float:
        """Full opening angle of a spot, rad."""
        return self._lamp().spot_size

    @spot_size.setter
    def spot_size(self, value: float) -> None:
        self._lamp().spot_size = checks.number(value, "lamp.spot_size", above=0.0)


class CameraData(Facade):
    """The lens of a camera in the scene, or of a camera sensor: its ``cam_near``, ``cam_far`` and ``cam_focal``."""

    _path = "camera"

    def __init__(self, node: Node) -> None:
        self._node = node

    def _get(self, field: str, name: str) -> float:
        lens = self._node.camera or Camera()
        value = self._node.properties.get(name, getattr(lens, field))
        return float(value) if isinstance(value, (int, float, str)) else float(getattr(lens, field))

    def _set(self, field: str, name: str, value: object) -> None:
        number = checks.number(value, f"camera.{field}", above=0.0)
        if self._node.camera is not None:
            setattr(self._node.camera, field, number)
        else:
            self._node.properties[name] = number

    @property
    def clip_start(self) -> float:
        """Distance of the near plane, m."""
        return self._get("clip_start", "cam_near")

    @clip_start.setter
    def clip_start(self, value: float) -> None:
        self._set("clip_start", "cam_near", value)

    @property
    def clip_end(self) -> float:
        """Distance of the far plane, m."""
        return self._get("clip_end", "cam_far")

    @clip_end.setter
    def clip_end(self, value: float) -> None:
        self._set("clip_end", "cam_far", value)

    @property
    def lens(self) -> float:
        """Focal length, mm, for a sensor 32 mm wide."""
        return self._get("focal_length", "cam_focal")

    @lens.setter
    def lens(self, value: float) -> None:
        self._set("focal_length", "cam_focal", value)


def take_data(node: Node, block: MeshData | CameraData | LampData) -> None:
    """Give a node the mesh, lamp or lens of ``object.data``."""
    if not isinstance(block, (MeshData, CameraData, LampData)):
        raise TypeError(f"object.data takes a mesh, lamp or camera of bpy.data, got {checks.shown(block)}")
    source = block._node
    if source is not node:
        node.kind, node.mesh, node.light, node.camera = source.kind, source.mesh, source.light, source.camera
        node.materials, node.shapes = list(source.materials), None


#: the class of ``object.data`` by the type of the object
DATA: dict[str, Callable[[Node], MeshData | CameraData | LampData]] = {
    "MESH": MeshData,
    "LAMP": LampData,
    "CAMERA": CameraData,
}
