"""``bpy.context``: what is active and selected."""

from __future__ import annotations

from morse.builder import bpymorse, workspace
from morse.builder.blender.named import NamedList
from morse.builder.blender.objects import SceneObject
from morse.builder.legacy.bpy.data import Data
from morse.builder.legacy.bpy.scene import Scene
from morse.builder.legacy.ignored import Facade


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
