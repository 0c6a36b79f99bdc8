"""What a scene script can say about a scene, and where the page says it: no method of the builder is forgotten."""

from __future__ import annotations

import inspect

import pytest

from morse import builder
from morse.builder.assembly.spawning import OBJECT_CALLS
from morse.builder.creator import ActuatorCreator, SensorCreator
from morse.viewer.editor import _METHODS
from morse.viewer.world_settings import METHODS

COMPONENT = {*_METHODS, "properties"}
#: what the page does without a form
OTHERWISE = {
    "append": "by the list of models, or by a drop on the robot",
    "translate": "by handles",
    "rotate": "by handles",
    "set_time_scale": "by the speed in the bar",
    "enable_mist": "by set_mist_settings",
    "place_camera": "by set_camera_location",
    "aim_camera": "by set_camera_rotation",
    "set_rigid_body": "by set_physics_type",
    "set_dynamic": "by set_physics_type",
    "set_no_collision": "by set_physics_type",
    "static": "by set_physics_type",
    "set_color": "by color, of solids",
    "show": "by the menus of the view, for each who looks on",
    "fullscreen": "by the browser",
    "select_display_camera": "by the panel of the camera",
    "add_interface": "by add_stream: this is its form with services",
}
#: of programs that describe scenes, and what is accepted for scripts of MORSE 1.4 and does nothing
NOT_OF_A_SCENE = {
    *("append_collada", "append_meshes", "append_model", "append_scenes", "close_context", "component_class"),
    *("get_child", "is_exportable", "is_morseable", "mark_unexportable", "morseable", "own_nodes", "profile"),
    *("property_value", "select", "set_blender_object", "suggest_name", "create", "save", "when_complete"),
    *("set_animation_record", "set_background_scene", "set_debug", "set_material_mode", "set_stereo"),
    *("use_internal_syncer", "use_vsync", "set_use_record_animation", "set_collision_bounds"),
}
#: what only the text of the script says, also in the page: its form would need more than values of one object
IN_THE_SCRIPT = {
    "Environment": {
        *("add_service", "add_stream", "configure_service", "configure_stream_manager", "configure_multinode"),
        *("cameras_on", "set_camera_clip", "set_log_level", "set_viewport"),
    },
    "Mesh": {"add_service", "add_stream", "add_overlay", "alter", "frequency", "level", "properties"},
    "PassiveObject": {
        *("add_service", "add_stream", "add_overlay", "alter", "frequency", "level", "properties", "setgraspable"),
    },
    # the mass of a robot is that of its model
    "Robot": {
        *("add_default_interface", "add_service", "add_stream", "add_overlay", "alter", "frequency", "level"),
        *("make_external", "make_ghost", "make_grasper"),
        *("set_damping", "set_friction", "set_mass", "set_physics_type", "set_restitution"),
    },
    "SensorCreator": {"add_service", "add_overlay"},
    "ActuatorCreator": {"add_service", "add_overlay"},
    "Armature": {"add_service", "add_overlay", "control", "create_ik_targets", "gains"},
}


def methods(cls: type) -> set[str]:
    return {name for name, _ in inspect.getmembers(cls, inspect.isfunction) if not name.startswith("_")}


@pytest.mark.parametrize(
    ("cls", "forms"),
    [
        (builder.Environment, {*METHODS}),
        (builder.Mesh, {*OBJECT_CALLS}),
        (builder.PassiveObject, {*OBJECT_CALLS}),
        (builder.Robot, {"properties"}),
        (SensorCreator, COMPONENT),
        (ActuatorCreator, COMPONENT),
        (builder.Armature, COMPONENT),
    ],
    ids=lambda value: value.__name__ if isinstance(value, type) else "",
)
def test_each_method_of_the_builder_has_a_form_or_a_reason(cls: type, forms: set[str]) -> None:
    script = IN_THE_SCRIPT[cls.__name__]
    assert methods(cls) - forms - OTHERWISE.keys() - NOT_OF_A_SCENE == script
    assert not forms & script
