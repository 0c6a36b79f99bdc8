"""``bpy.data`` and ``bpy.context``: what the scene contains, and what is selected."""

from __future__ import annotations

from typing import Any

from morse.builder import bpymorse, workspace
from morse.builder.errors import checks
from morse.builder.objects import NamedList, SceneObject
from morse.plugins.legacy.blender import Facade, SharedMaterial, all_materials
from morse.plugins.legacy.bpy_scene import Lens, Objects, Scene, World
from morse.plugins.legacy.object_data import CameraData, LampData, MeshData, kind_of
from morse.scene import Camera, Light, Material, Node, NodeKind


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
