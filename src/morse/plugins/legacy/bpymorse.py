"""Functions of ``bpymorse`` that only scripts of MORSE 1.4 call."""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING, Any

from morse.builder import workspace
from morse.builder.errors import checks
from morse.builder.objects import material_slots
from morse.builder.workspace import notice
from morse.core.exceptions import MorseBuilderError, MorseBuilderNoComponentError
from morse.plugins.legacy.blender import Ignored, ObjectMaterial
from morse.plugins.legacy.bpy import stand_in

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

_OWN = ("deselect_all", "fullscreen", "get_material", "set_speed", "set_viewport")
#: those that ``from morse.builder.bpymorse import *`` gives
PUBLIC = ("fullscreen", "get_material", "set_speed", "set_viewport")
NAMES = (*_CALLS, *_VALUES, *_IGNORED, *_OWN)


def wrapper(name: str) -> object:
    """The function of that name, one of `NAMES`."""
    if name in PUBLIC:
        return globals()[name]
    bpy = stand_in()
    if name == "deselect_all":
        return lambda: bpy.ops.object.select_all(action="DESELECT")
    if name in _IGNORED:
        return Ignored(f"bpymorse.{name}")
    if name in _VALUES:
        return lambda: operator.attrgetter(_VALUES[name])(bpy)
    function = operator.attrgetter(_CALLS[name])(bpy)
    return (lambda name="Material": function(name)) if name == "new_material" else function


def get_material(name: str) -> ObjectMaterial:
    """Return the material of that name from the first object that uses it.

    Raises:
        MorseBuilderNoComponentError: there is no such material.
    """
    names = set()
    for node in workspace.current().nodes():
        for index, material in enumerate(material_slots(node)):
            if material is not None:
                if material.name == name:
                    return ObjectMaterial(node, index)
                names.add(material.name)
    raise MorseBuilderNoComponentError(f"there is no material '{name}'{checks.suggestion(name, names)}")


def set_speed(fps: int = 0, logic_step_max: int = 0, physics_step_max: int = 0) -> None:
    """Set the frequency of the simulation: old name of ``env.simulator_frequency``, also valid before it exists."""
    notice("bpymorse.set_speed is an old name, write env.simulator_frequency")
    set_frequency(fps or 60, logic_step_max or 20, physics_step_max or 20)


def set_frequency(frequency: float, logic_step_max: int = 20, physics_step_max: int = 20) -> None:
    """Set the frequency of the simulation, Hz, whether the environment exists already or not."""
    scene = workspace.current()
    if scene.environment is None:
        scene.speed = (frequency, logic_step_max, physics_step_max)
    else:
        _environment("set_speed").simulator_frequency(frequency, logic_step_max, physics_step_max)


def fullscreen(fullscreen: bool = True) -> None:
    """Use the full screen for the view (``env.fullscreen``)."""
    _environment("fullscreen").fullscreen(fullscreen)


def set_viewport(viewport_shade: str = "WIREFRAME", clip_end: float = 1000.0) -> None:
    """Set the rendering mode (``env.set_viewport``)."""
    _environment("set_viewport").set_viewport(viewport_shade, clip_end)


def _environment(function: str) -> Any:
    environment = workspace.current().environment
    if environment is None:
        raise MorseBuilderError(
            f"bpymorse.{function} has to be called after the Environment is created: write env.{function}(...)"
        )
    return environment
