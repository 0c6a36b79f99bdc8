"""Functions of ``bpymorse`` in MORSE 1.4 that pass a call on to ``bpy``."""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING

from morse.builder.legacy.bpy import stand_in
from morse.builder.legacy.ignored import Ignored

if TYPE_CHECKING:
    from collections.abc import Mapping

#: a function of ``bpymorse``, and the operator or method of ``bpy``
_CALLS: Mapping[str, str] = {
    "add_camera": "ops.object.camera_add",
    "add_empty": "ops.object.empty_add",
    "add_lamp": "ops.object.lamp_add",
    "add_mesh_cone": "ops.mesh.primitive_cone_add",
    "add_mesh_cube": "ops.mesh.primitive_cube_add",
    "add_mesh_cylinder": "ops.mesh.primitive_cylinder_add",
    "add_mesh_icosphere": "ops.mesh.primitive_ico_sphere_add",
    "add_mesh_plane": "ops.mesh.primitive_plane_add",
    "add_mesh_torus": "ops.mesh.primitive_torus_add",
    "add_mesh_uv_sphere": "ops.mesh.primitive_uv_sphere_add",
    "append": "ops.wm.append",
    "apply_transform": "ops.object.transform_apply",
    "collada_import": "ops.wm.collada_import",
    "link_append": "ops.wm.append",
    "new_game_property": "ops.object.game_property_new",
    "new_material": "data.materials.new",
    "new_mesh": "data.meshes.new",
    "new_object": "data.objects.new",
    "select_all": "ops.object.select_all",
}

#: a function of ``bpymorse`` that returns a value of ``bpy``
_VALUES: Mapping[str, str] = {
    "get_cameras": "data.cameras",
    "get_context_scene": "context.scene",
    "get_lamps": "data.lamps",
    "get_materials": "data.materials",
    "get_meshes": "data.meshes",
    "get_scenes": "data.scenes",
    "get_selected_objects": "context.selected_objects",
}

#: functions of ``bpymorse`` for what MORSE does not have
_IGNORED = (
    "add_controller", "add_sensor", "get_armatures", "get_context_window", "get_texts", "link_controller",
    "new_text", "set_viewport_perspective",
)  # fmt: skip

NAMES = (*_CALLS, *_VALUES, *_IGNORED, "deselect_all")


def wrapper(name: str) -> object:
    """The function of that name, one of `NAMES`."""
    bpy = stand_in()
    if name == "deselect_all":
        return lambda: bpy.ops.object.select_all(action="DESELECT")
    if name in _IGNORED:
        return Ignored(f"bpymorse.{name}")
    if name in _VALUES:
        return lambda: operator.attrgetter(_VALUES[name])(bpy)
    function = operator.attrgetter(_CALLS[name])(bpy)
    return (lambda name="Material": function(name)) if name == "new_material" else function
