"""``bpy.data.objects`` and ``bpy.context.scene.objects``: the objects of the scene that is being described."""

from __future__ import annotations

from typing import Any

from morse.builder import bpymorse, workspace
from morse.builder.blender.datablocks import CameraData, LampData, MeshData, take_data
from morse.builder.blender.named import NamedList
from morse.builder.blender.objects import SceneObject
from morse.builder.errors import checks
from morse.builder.legacy.bpy.viewpoint import NAME, Viewpoint
from morse.scene import Node

_Data = MeshData | LampData | CameraData | None


class Objects(NamedList[Any]):
    """All objects of the scene, and the camera of the view."""

    def __init__(self) -> None:
        objects: list[Any] = list(bpymorse.get_objects())
        if all(item.name != NAME for item in objects):
            objects.append(Viewpoint())
        super().__init__(objects, "object")

    @property
    def active(self) -> SceneObject | None:
        """The object that operators change."""
        return bpymorse.get_context_object()

    @active.setter
    def active(self, obj: SceneObject | None) -> None:
        workspace.current().selected = None if obj is None else obj.node

    def new(self, name: str, object_data: _Data = None) -> SceneObject:
        """Create an object; it is part of the scene at once.

        Args:
            name: its name.
            object_data: a mesh, lamp or camera of ``bpy.data``, or None for an empty object.
        """
        node = Node(checks.text(name, "bpy.data.objects.new(name)"))
        if object_data is not None:
            node.body.type = object_data._node.body.type
            take_data(node, object_data)
            # the data belong to the object from now on
            object_data._node = node
        workspace.current().add(node)
        return SceneObject(node)

    def link(self, obj: SceneObject) -> None:
        """Accepted for old scripts: objects are part of the scene from the beginning."""

    def unlink(self, obj: SceneObject) -> None:
        """Remove an object from the scene."""
        bpymorse.delete(obj)

    def remove(self, obj: Any, *_: Any, **__: Any) -> None:
        """Remove an object from the scene."""
        bpymorse.delete(obj)
