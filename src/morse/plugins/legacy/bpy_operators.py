"""``bpy.data`` and ``bpy.ops``: data of objects, and the operators that create, select, move and remove objects."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from morse.assets.solids import cone, cube, cylinder, ico_sphere, plane, sphere, torus
from morse.builder import bpymorse, workspace
from morse.builder.abstractcomponent import AbstractComponent
from morse.builder.errors import checks
from morse.builder.objects import NamedList, SceneObject, checked_property, timer
from morse.core.exceptions import MorseBuilderError
from morse.mathutils import Matrix, Vector
from morse.plugins.legacy.blender import Facade, SharedMaterial, all_materials
from morse.plugins.legacy.bpy_scene import Lens, Objects, Scene, World
from morse.plugins.legacy.object_data import CameraData, LampData, MeshData, kind_of
from morse.scene import Camera, Light, Material, Node, NodeKind

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.scene import Mesh


class _Blocks(NamedList[Any]):
    """The data of all objects of one type."""

    def __init__(self, kind: str, data: Any) -> None:
        objects = [SceneObject(node) for node in workspace.current().nodes() if kind_of(node) == kind]
        super().__init__([_Named(obj, data(obj.node)) for obj in objects], kind.lower())


class _Named:
    """Data of an object, with the name of the object."""

    def __init__(self, obj: SceneObject, data: object) -> None:
        object.__setattr__(self, "name", obj.name)
        object.__setattr__(self, "_data", data)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._data, name)

    def __setattr__(self, name: str, value: object) -> None:
        setattr(self._data, name, value)


class _Meshes(_Blocks):
    def __init__(self) -> None:
        super().__init__("MESH", MeshData)

    def new(self, name: str) -> MeshData:
        """An empty mesh, for ``from_pydata`` and ``bpy.data.objects.new``."""
        node = Node(checks.text(name, "bpy.data.meshes.new(name)"), kind=NodeKind.MESH)
        settle(node)
        return MeshData(node)


class _Lamps(_Blocks):
    def __init__(self) -> None:
        super().__init__("LAMP", LampData)

    def new(self, name: str, type: str = "POINT") -> LampData:
        """A lamp, for ``bpy.data.objects.new``."""
        return LampData(Node(checks.text(name, "bpy.data.lamps.new(name)"), kind=NodeKind.LIGHT, light=Light(type)))


class _Cameras(_Blocks):
    def __init__(self) -> None:
        super().__init__("CAMERA", CameraData)
        self.insert(0, Lens())

    def new(self, name: str) -> CameraData:
        """A camera, for ``bpy.data.objects.new``."""
        return CameraData(Node(checks.text(name, "bpy.data.cameras.new(name)"), kind=NodeKind.CAMERA, camera=Camera()))


class _Materials(NamedList[Any]):
    def __init__(self) -> None:
        super().__init__([SharedMaterial(material) for material in all_materials()], "material")

    def new(self, name: str) -> SharedMaterial:
        """A material, for ``object.active_material`` or ``object.data.materials.append``."""
        material = Material(checks.text(name or "Material", "bpy.data.materials.new(name)"))
        workspace.current().materials.append(material)
        return SharedMaterial(material)


class Data(Facade):
    """``bpy.data``."""

    _path = "bpy.data"

    @property
    def objects(self) -> Objects:
        """All objects."""
        return Objects()

    @property
    def meshes(self) -> _Meshes:
        """All meshes, by the names of their objects."""
        return _Meshes()

    @property
    def lamps(self) -> _Lamps:
        """All lamps, by the names of their objects."""
        return _Lamps()

    lights = lamps

    @property
    def cameras(self) -> _Cameras:
        """The camera of the view first, then those of the scene by the names of their objects."""
        return _Cameras()

    @property
    def materials(self) -> _Materials:
        """All materials."""
        return _Materials()

    @property
    def worlds(self) -> NamedList[Any]:
        """The one world."""
        return NamedList([World()], "world")

    @property
    def scenes(self) -> NamedList[Any]:
        """The one scene."""
        return NamedList([Scene()], "scene")

    @property
    def filepath(self) -> str:
        """Empty: the scene is not a file of Blender."""
        return ""


def settle(node: Node) -> None:
    """Give a mesh the physics of a new object in Blender's game engine: others collide with it."""
    from morse.scene import PhysicsType

    node.body.type = PhysicsType.STATIC


class Context(Facade):
    """``bpy.context``."""

    _path = "bpy.context"
    mode = "OBJECT"

    @property
    def scene(self) -> Scene:
        """The scene."""
        return Scene()

    @property
    def blend_data(self) -> Data:
        """``bpy.data``."""
        return Data()

    @property
    def object(self) -> SceneObject | None:
        """The active object: the last one that was created or made active."""
        return bpymorse.get_context_object()

    active_object = object

    @property
    def selected_objects(self) -> NamedList[SceneObject]:
        """The selected objects."""
        return NamedList([SceneObject(node) for node in workspace.current().selection], "object")

    selected_editable_objects = selected_objects


_FINISHED = {"FINISHED"}
_DEFAULTS: dict[str, object] = {"BOOL": False, "INT": 0, "FLOAT": 0.0, "STRING": "", "TIMER": timer(0.0)}
_ORIGIN = (0.0, 0.0, 0.0)


def _add(
    node: Node, location: object, rotation: object, scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
) -> set[str]:
    node.location[:] = checks.triple(location, "bpy.ops: location")
    node.rotation_euler[:] = checks.triple(rotation, "bpy.ops: rotation")
    node.scale[:] = scale
    scene = workspace.current()
    scene.add(node)
    scene.selection = [node]
    return _FINISHED


def _solid(name: str, mesh: Mesh, scale: tuple[float, float, float], location: object, rotation: object) -> set[str]:
    node = Node(name, kind=NodeKind.MESH, mesh=mesh, materials=[Material(name)])
    settle(node)
    return _add(node, location, rotation, scale)


def _active() -> SceneObject:
    obj = bpymorse.get_context_object()
    if obj is None:
        raise MorseBuilderError("bpy.ops: no object is active; create one, or set bpy.context.scene.objects.active")
    return obj


def _selected() -> list[Node]:
    scene = workspace.current()
    return list(scene.selection) or ([scene.selected] if scene.selected is not None else [])


class MeshOperators(Facade):
    """``bpy.ops.mesh``: solids with the sizes of Blender; ``radius`` and ``size`` are half the edge of a cube."""

    _path = "bpy.ops.mesh"

    def primitive_cube_add(
        self, radius: object = 1.0, location: object = _ORIGIN, rotation: object = _ORIGIN, **old: object
    ) -> set[str]:
        """Add a cube."""
        half = _half(radius, old)
        return _solid("Cube", cube(), (half, half, half), location, rotation)

    def primitive_plane_add(
        self, radius: object = 1.0, location: object = _ORIGIN, rotation: object = _ORIGIN, **old: object
    ) -> set[str]:
        """Add a square."""
        half = _half(radius, old)
        return _solid("Plane", plane(), (half, half, 1.0), location, rotation)

    primitive_grid_add = primitive_plane_add

    def primitive_cylinder_add(
        self,
        vertices: object = 32,
        radius: object = 1.0,
        depth: object = 2.0,
        location: object = _ORIGIN,
        rotation: object = _ORIGIN,
        **old: object,
    ) -> set[str]:
        """Add a cylinder along Z."""
        r, height = _half(radius, old), checks.number(depth, "depth", above=0.0)
        return _solid("Cylinder", cylinder(), (r, r, height / 2.0), location, rotation)

    def primitive_cone_add(
        self,
        vertices: object = 32,
        radius1: object = 1.0,
        radius2: object = 0.0,
        depth: object = 2.0,
        location: object = _ORIGIN,
        rotation: object = _ORIGIN,
        **old: object,
    ) -> set[str]:
        """Add a cone along Z."""
        r, height = _half(old.pop("radius", radius1), old), checks.number(depth, "depth", above=0.0)
        return _solid("Cone", cone(), (r, r, height / 2.0), location, rotation)

    def primitive_uv_sphere_add(
        self,
        segments: object = 32,
        ring_count: object = 16,
        size: object = 1.0,
        location: object = _ORIGIN,
        rotation: object = _ORIGIN,
        **old: object,
    ) -> set[str]:
        """Add a sphere."""
        r = _half(old.pop("radius", size), old)
        return _solid("Sphere", sphere(), (r, r, r), location, rotation)

    def primitive_ico_sphere_add(
        self,
        subdivisions: object = 2,
        size: object = 1.0,
        location: object = _ORIGIN,
        rotation: object = _ORIGIN,
        **old: object,
    ) -> set[str]:
        """Add a sphere of triangles."""
        r = _half(old.pop("radius", size), old)
        return _solid("Icosphere", ico_sphere(), (r, r, r), location, rotation)

    def primitive_torus_add(
        self,
        location: object = _ORIGIN,
        rotation: object = _ORIGIN,
        major_radius: object = 1.0,
        minor_radius: object = 0.25,
        **_old: object,
    ) -> set[str]:
        """Add a ring around Z."""
        r, tube = checks.number(major_radius, "major_radius", above=0.0), checks.number(minor_radius, "minor_radius")
        return _solid("Torus", torus(), (r, r, tube / 0.25), location, rotation)


def _half(radius: object, old: Mapping[str, object]) -> float:
    """Half the size: ``size`` of newer versions of Blender is the whole edge, ``radius`` of older ones is half."""
    if "size" in old:
        return checks.number(old["size"], "size", above=0.0) / 2.0
    return checks.number(radius, "radius", above=0.0)


class ObjectOperators(Facade):
    """``bpy.ops.object``."""

    _path = "bpy.ops.object"

    def select_all(self, action: str = "TOGGLE") -> set[str]:
        """Select or deselect all objects."""
        scene = workspace.current()
        some = bool(scene.selection)
        none = action == "DESELECT" or (action == "TOGGLE" and some)
        scene.selection = [] if none else list(scene.nodes())
        return _FINISHED

    def select_pattern(self, pattern: str = "*", extend: bool = True, **_: object) -> set[str]:
        """Select objects by their names, with ``*`` and ``?``."""
        from fnmatch import fnmatchcase

        scene = workspace.current()
        matches = [node for node in scene.nodes() if fnmatchcase(node.name, pattern)]
        scene.selection = list(dict.fromkeys([*(scene.selection if extend else []), *matches]))
        return _FINISHED

    def select_by_type(self, type: str = "MESH", **_: object) -> set[str]:
        """Select objects of one type."""
        workspace.current().selection = [node for node in workspace.current().nodes() if kind_of(node) == type]
        return _FINISHED

    def delete(self, **_: object) -> set[str]:
        """Remove the selected objects."""
        bpymorse.delete([SceneObject(node) for node in _selected()])
        return _FINISHED

    def duplicate(self, **_: object) -> set[str]:
        """Copy the selected objects, without those below them; the copies are selected."""
        scene = workspace.current()
        copies = [scene.duplicate(node) for node in _selected()]
        scene.selection = copies
        return _FINISHED

    def add(self, type: str = "EMPTY", location: object = _ORIGIN, rotation: object = _ORIGIN, **_: object) -> set[str]:
        """Add an object: EMPTY, LAMP or CAMERA."""
        if type == "LAMP":
            return self.lamp_add(location=location, rotation=rotation)
        if type == "CAMERA":
            return self.camera_add(location=location, rotation=rotation)
        return _add(Node("Empty"), location, rotation)

    def empty_add(
        self, type: str = "PLAIN_AXES", location: object = _ORIGIN, rotation: object = _ORIGIN, **_: object
    ) -> set[str]:
        """Add an empty object."""
        return _add(Node("Empty"), location, rotation)

    def lamp_add(
        self, type: str = "POINT", location: object = _ORIGIN, rotation: object = _ORIGIN, **_: object
    ) -> set[str]:
        """Add a lamp: POINT, SUN, SPOT, AREA or HEMI."""
        kind = checks.choice(type, ("POINT", "SUN", "SPOT", "AREA", "HEMI"), "bpy.ops.object.lamp_add(type)")
        return _add(Node(kind.capitalize(), kind=NodeKind.LIGHT, light=Light(kind)), location, rotation)

    def camera_add(self, location: object = _ORIGIN, rotation: object = _ORIGIN, **_: object) -> set[str]:
        """Add a camera."""
        return _add(Node("Camera", kind=NodeKind.CAMERA, camera=Camera()), location, rotation)

    def game_property_new(self, type: str = "FLOAT", name: str = "prop") -> set[str]:
        """Add a property to the active object."""
        kind = checks.choice(type, _DEFAULTS, "bpy.ops.object.game_property_new(type)")
        _active().node.properties[checks.text(name, "name")] = checked_property(name, _DEFAULTS[kind])
        return _FINISHED

    def parent_set(self, type: str = "OBJECT", **_: object) -> set[str]:
        """Make the active object the parent of the selected ones, which keep their places in the world."""
        above = _active().node
        for node in _selected():
            if node is not above:
                workspace.current().attach(above, node, keep_world_pose=True)
        return _FINISHED

    def parent_clear(self, type: str = "CLEAR") -> set[str]:
        """Remove the parents of the selected objects."""
        for node in _selected():
            world = node.world_matrix() if type != "CLEAR" else None
            workspace.current().detach(node)
            if world is not None:
                node.parent_inverse = world @ node.basis_matrix().inverted()
        return _FINISHED

    def _nothing(self, *_args: object, **_kwargs: object) -> set[str]:
        """Accepted for old scripts: it only matters in the window of Blender."""
        return _FINISHED

    transform_apply = origin_set = mode_set = shade_smooth = shade_flat = material_slot_add = editmode_toggle = _nothing
    move_to_layer = make_single_user = origin_clear = _nothing


class TransformOperators(Facade):
    """``bpy.ops.transform``: moves the selected objects, else the active one, along the axes of the world."""

    _path = "bpy.ops.transform"

    def translate(self, value: object = _ORIGIN, **_: object) -> set[str]:
        """Add to the location, m."""
        step = checks.triple(value, "bpy.ops.transform.translate(value)")
        for node in _selected():
            node.location[:] = [old + more for old, more in zip(node.location, step, strict=True)]
        return _FINISHED

    def rotate(self, value: object = 0.0, axis: object = (0.0, 0.0, 1.0), **_: object) -> set[str]:
        """Turn by an angle, rad, about an axis of the world through the origin of the object."""
        # a tuple up to Blender 2.65
        one = value[0] if isinstance(value, (tuple, list)) else value
        angle = checks.number(one, "bpy.ops.transform.rotate(value)")
        turn = Matrix.Rotation(angle, 3, Vector(checks.triple(axis, "bpy.ops.transform.rotate(axis)")))
        for node in _selected():
            before = Matrix(node.basis_matrix()).to_euler().to_matrix()
            node.rotation_euler[:] = list((turn @ before).to_euler())
        return _FINISHED

    def resize(self, value: object = (1.0, 1.0, 1.0), **_: object) -> set[str]:
        """Multiply the scale."""
        factors = checks.triple(value, "bpy.ops.transform.resize(value)")
        for node in _selected():
            node.scale[:] = [old * factor for old, factor in zip(node.scale, factors, strict=True)]
        return _FINISHED


class WindowOperators(Facade):
    """``bpy.ops.wm``: objects of other files."""

    _path = "bpy.ops.wm"

    def append(
        self, filepath: str = "", directory: str = "", filename: str = "", files: Any = (), **_: object
    ) -> set[str]:
        """Add objects of a file of Blender: ``directory='room.blend/Object/', filename='Table'``."""
        folder = directory or str(Path(filepath).parent)
        model, _suffix, _kind = folder.replace("\\", "/").partition(".blend")
        names = [item["name"] for item in files] or [filename or Path(filepath).name]
        roots = AbstractComponent(filename=f"{model}.blend").append_meshes(objects=names)
        workspace.current().selection = [root.node for root in roots]
        return _FINISHED

    link_append = append

    def link(self, **options: Any) -> set[str]:
        """Add objects of a file of Blender."""
        return self.append(**options)

    def collada_import(self, filepath: str = "", **_: object) -> set[str]:
        """Add the objects of a COLLADA file."""
        return _read(filepath)


class ImportOperators(Facade):
    """``bpy.ops.import_scene`` and ``bpy.ops.import_mesh``: mesh files."""

    _path = "bpy.ops.import_scene"

    def obj(self, filepath: str = "", **_: object) -> set[str]:
        """Add the objects of a mesh file."""
        return _read(filepath)

    stl = ply = gltf = obj


def _read(filepath: str) -> set[str]:
    roots = AbstractComponent(filename=checks.text(filepath, "bpy.ops: filepath")).append_scenes()
    for root in roots:
        for node in root.node.walk():
            if node.mesh is not None:
                settle(node)
    workspace.current().selection = [root.node for root in roots]
    return _FINISHED


class Operators(Facade):
    """``bpy.ops``."""

    _path = "bpy.ops"
    mesh = MeshOperators()
    object = ObjectOperators()
    transform = TransformOperators()
    wm = WindowOperators()
    import_scene = ImportOperators()
    import_mesh = ImportOperators()
