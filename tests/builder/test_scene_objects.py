"""The nodes of a scene under the names of Blender's objects."""

import math
from typing import Any

import pytest

from morse.builder import (
    Cube,
    Environment,
    FakeRobot,
    MorseBuilderError,
    MorseBuilderNoComponentError,
    Morsy,
    PassiveObject,
    Plane,
    Pose,
    bpymorse,
    workspace,
)
from morse.builder.objects import SceneObject
from morse.scene import Bounds, PhysicsType


def test_objects_are_views_of_nodes() -> None:
    robot = Morsy()
    obj = robot._bpy_object
    obj.location = (1, 2, 3)
    obj.rotation_euler[2] = 0.5
    assert list(robot.location) == [1.0, 2.0, 3.0]
    assert robot.rotation_euler.z == 0.5
    assert obj == bpymorse.get_object("morsy")
    assert len({obj, bpymorse.get_object("morsy")}) == 1
    assert obj != bpymorse.get_object("morsy_mesh")
    assert obj != "morsy"


def test_names_are_unique() -> None:
    first, second = Cube("box")._bpy_object, Cube()._bpy_object
    second.name = "box"
    assert (first.name, second.name) == ("box", "box.001")
    second.name = "box.001"
    assert second.name == "box.001"
    third = Cube("box")._bpy_object
    assert third.name == "box.002"
    for bad in ("", None, 3):
        with pytest.raises((TypeError, ValueError)):
            first.name = bad  # type: ignore[assignment]


def test_parents_and_children() -> None:
    outer, inner = Cube("outer")._bpy_object, Cube("inner")._bpy_object
    inner.parent = outer
    assert inner.parent == outer
    assert outer.children == [inner]
    assert inner.node not in workspace.current().roots
    inner.parent = None
    assert outer.children == []
    assert inner.node in workspace.current().roots
    with pytest.raises(ValueError, match="part of it"):
        outer.parent = outer
    with pytest.raises(TypeError, match="object of the scene"):
        outer.parent = "inner"  # type: ignore[assignment]


def test_physics_by_the_names_of_the_game_engine() -> None:
    cube = Cube()
    game = cube._bpy_object.game
    body = cube.scene_node.body
    game.mass = 12
    game.radius = 0.3
    game.physics_type = "RIGID_BODY"
    game.use_actor = False
    game.use_ghost = True
    game.use_collision_bounds = True
    game.collision_bounds_type = "SPHERE"
    game.use_collision_compound = True
    game.damping = 0.2
    game.rotation_damping = 0.3
    game.lock_location_x = game.lock_location_z = True
    game.lock_rotation_y = True
    assert (body.mass, body.radius, body.type, body.actor, body.ghost) == (
        12.0,
        0.3,
        PhysicsType.RIGID_BODY,
        False,
        True,
    )
    assert (body.bounds, body.compound) == (Bounds.SPHERE, True)
    assert (body.linear_damping, body.angular_damping) == (0.2, 0.3)
    assert body.lock_location == (True, False, True)
    assert body.lock_rotation == (False, True, False)
    assert game.mass == 12.0
    assert game.lock_location_x
    assert not game.lock_location_y
    assert game.physics_type == "RIGID_BODY"
    assert game.collision_bounds_type == "SPHERE"
    game.use_collision_bounds = False
    assert body.bounds is None
    assert not game.use_collision_bounds


@pytest.mark.parametrize(("name", "bad"), [
    ("mass", 0), ("mass", -1), ("mass", math.nan), ("mass", "heavy"), ("mass", None), ("radius", math.inf),
    ("damping", 1.5), ("damping", -0.1), ("physics_type", "RIGID"), ("physics_type", 3), ("physics_type", "AUTO"),
    ("use_actor", None), ("use_ghost", []), ("collision_bounds_type", "PYRAMID"), ("lock_location_x", None),
    ("use_collision_bounds", ["box"]),
])  # fmt: skip
def test_bad_physics(name: str, bad: Any) -> None:
    game = Cube()._bpy_object.game
    before = getattr(game, name)
    with pytest.raises((TypeError, ValueError), match=name):
        setattr(game, name, bad)
    assert getattr(game, name) == before


def test_misspelt_names() -> None:
    cube = Cube()._bpy_object
    for owner, typo, meant in (
        (cube, "locaton", "location"),
        (cube.game, "phisics_type", "physics_type"),
        (cube.material_slots[0].material, "diffuse_colour", "diffuse_color"),
    ):
        with pytest.raises(AttributeError, match=f"did you mean '{meant}'"):
            getattr(owner, typo)
        with pytest.raises(AttributeError):
            setattr(owner, typo, 1)
    with pytest.raises(KeyError, match="no property 'Label'"):
        cube.game.properties["Label"]
    assert "Label" not in cube.game.properties


def test_materials() -> None:
    first, second = PassiveObject("props/crates", "small_crate"), PassiveObject("props/crates", "small_crate")
    slot = first.get_child("small_crate_mesh").material_slots[0]  # type: ignore[union-attr]
    other = second.get_child("small_crate_mesh").material_slots[0]  # type: ignore[union-attr]
    before = other.material.diffuse_color
    slot.material.diffuse_color = (0.25, 0.5, 0.75)
    slot.material.alpha = 0.5
    assert slot.material.diffuse_color == (0.25, 0.5, 0.75)
    assert slot.material.alpha == 0.5
    assert slot.name == slot.material.name
    assert other.material.diffuse_color == before
    for bad in ((2, 0, 0), "red", (1, 1), None):
        with pytest.raises((TypeError, ValueError)):
            slot.material.diffuse_color = bad  # type: ignore[assignment]


# --- bpymorse ------------------------------------------------------------------------------------


def test_objects_by_name() -> None:
    Environment("indoors-1/boxes")
    assert bpymorse.get_object("RedBox").game.properties["Object"].value
    with pytest.raises(MorseBuilderNoComponentError, match="did you mean 'RedBox'"):
        bpymorse.get_object("ReadBox")
    assert bpymorse.get_object("BlueBox") in bpymorse.get_objects()


def test_properties_of_objects() -> None:
    plane = Plane("floor")
    bpymorse.properties(bpymorse.get_object("floor"), Label="floor", Walkable=True)
    assert plane.property_value("Walkable") is True
    assert bpymorse.get_properties(plane._bpy_object) == {"Label": "floor", "Walkable": True}
    for bad in (plane, "floor", None):
        with pytest.raises(TypeError, match="object of the scene"):
            bpymorse.properties(bad, Label="x")  # type: ignore[arg-type]


def test_selection() -> None:
    a, b = Cube("a"), Cube("b")
    assert bpymorse.get_context_object() == b._bpy_object, "as in Blender, a new object is active"
    a.select()
    assert bpymorse.get_context_object() == a._bpy_object
    bpymorse.select_only(b._bpy_object)
    assert bpymorse.get_context_object() == b._bpy_object


def test_materials_by_name() -> None:
    Cube("red_box").color(1.0, 0.0, 0.0)
    bpymorse.get_material("red_box").diffuse_color = (0.0, 1.0, 0.0)
    assert bpymorse.get_material("red_box").diffuse_color == (0.0, 1.0, 0.0)
    with pytest.raises(MorseBuilderNoComponentError, match="did you mean 'red_box'"):
        bpymorse.get_material("redbox")


def test_deleting_keeps_the_children_in_place() -> None:
    table, vase = Cube("table"), PassiveObject("props/crates", "small_crate")
    table.append(vase)
    table.translate(1.0, 2.0, 3.0)
    crate = vase.get_child("small_crate_mesh")
    assert crate is not None
    world = crate.node.world_matrix()
    bodiless = SceneObject(vase.scene_node.children[0])
    bpymorse.delete(bodiless)
    bpymorse.delete([])
    assert workspace.current().find(bodiless.name) is None
    assert crate.node.world_matrix() == world
    with pytest.raises(MorseBuilderNoComponentError):
        bpymorse.delete("vase")
    # the body of what was appended goes with everything on it
    bpymorse.delete(vase._bpy_object)
    assert workspace.current().find("small_crate_mesh") is None
    assert vase not in table.children


def test_deleting_something_of_the_environment() -> None:
    Environment("indoors-1/boxes")
    bpymorse.delete(["RedBox", bpymorse.get_object("BlueBox")])
    assert workspace.current().find("RedBox") is None
    assert "BlueBox" not in {node.name for node in workspace.current().nodes()}


def test_settings_of_the_environment() -> None:
    for call in (bpymorse.fullscreen, bpymorse.set_viewport):
        with pytest.raises(MorseBuilderError, match="after the Environment is created"):
            call()
    env = Environment("empty")
    bpymorse.set_speed(120, 5, 5)
    bpymorse.fullscreen()
    bpymorse.set_viewport("SOLID")
    assert env.settings.frequency == 120.0
    assert env.settings.view.fullscreen
    assert env.settings.view.viewport == "SOLID"


def test_configuration_tells_what_was_said() -> None:
    from morse.builder import Configuration

    robot, pose = FakeRobot("r"), Pose("eye")
    robot.append(pose)
    pose.add_stream("socket", port=61000)
    pose.add_service("socket")
    pose.alter(classpath="my_sim.mods.Drift", rate=1)
    pose.add_overlay("socket", "my_sim.overlays.Eye")
    socket = "morse.middleware.socket_datastream.SocketDatastreamManager"
    requests = "morse.middleware.socket_request_manager.SocketRequestManager"
    publisher = "morse.middleware.socket_datastream.SocketPublisher"
    assert Configuration.datastreams() == {"eye": [(socket, publisher, "OUT", {"port": 61000})]}
    assert Configuration.services() == {"eye": [requests]}
    assert Configuration.modifiers() == {"eye": [("my_sim.mods.Drift", {"rate": 1})]}
    assert Configuration.overlays() == {"eye": [(requests, "my_sim.overlays.Eye", {})]}
