"""Colour and physics of objects that were added in the page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from editor_desk import Desk

import morse
from morse import builder
from morse.builder.components.matter import Matter
from morse.core.exceptions import MorseError
from morse.scene import PhysicsType
from morse.viewer.object_settings import settings_of_object, whole_call


def settings(desk: Desk, component: str) -> dict[str, list[dict[str, Any]]]:
    """The arguments of each method that the page shows."""
    desk._client.send("list_settings", component=component)
    shown = desk._wait("component_settings", component=component)["settings"]
    return {one["method"]: one["arguments"] for one in shown}


def test_a_solid_gets_a_colour_and_falls_is_saved_and_loaded(desk: Desk, tmp_path: Path) -> None:
    def put(method: str, remove: bool = False, **values: object) -> None:
        named = {name.rstrip("_"): value for name, value in values.items()}
        desk.do("configure", component="cube", method=method, values=named, remove=remove)

    desk.do("add_model", model="Cube", position=[8, 1, 5])
    shown = settings(desk, "cube")
    assert [one["name"] for one in shown["color"]] == ["r", "g", "b", "alpha"]
    assert {"RIGID_BODY", "STATIC"} <= {*shown["set_physics_type"][0]["choices"]}
    assert shown["set_mass"][0]["unit"] == "kg"

    put("color", r=1.0, g=0.0, b=0.0)
    # what is not given stays as it is
    put("color", b=0.5, alpha=0.25)
    put("set_mass", _=2.5)
    put("set_friction", _=0.3)
    put("set_damping", linear=0.0)
    cube = desk.simulation.world.objects_by_name["cube"]
    before = cube.position[2]
    desk.simulation.step(30)
    assert cube.position[2] == before, "it is only to be seen"
    put("set_physics_type", _="RIGID_BODY")
    cube = desk.simulation.world.objects_by_name["cube"]
    assert cube.mass == pytest.approx(2.5)
    height, time = cube.position[2], desk.simulation.clock.time
    desk.simulation.step(30)
    seconds = desk.simulation.clock.time - time
    assert height - cube.position[2] > 0.5 * 9.81 * seconds**2 * 0.8
    put("set_friction", remove=True)
    desk.do("undo_change")
    desk.do("save_scene", write=True)
    lines = (tmp_path / "scene.py").read_text().splitlines()
    assert "cube.color(r=1.0, g=0.0, b=0.5, alpha=0.25)" in lines
    assert "cube.set_mass(2.5)" in lines
    with morse.load(tmp_path / "scene.py") as again:
        node = again.scene.find("cube")
        assert node is not None
        assert node.materials[0].color == (1.0, 0.0, 0.5, 0.25)
        body = node.body
        assert (body.type, body.mass, body.friction) == (PhysicsType.RIGID_BODY, 2.5, 0.3)
        assert (body.linear_damping, body.angular_damping) == (0.0, 0.1)
    desk.simulation.start_anew()
    desk.simulation.step(2)
    assert desk.simulation.world.objects_by_name["cube"].mass == pytest.approx(2.5)


OBJECTS = [
    name for name in builder.__all__ if isinstance(one := getattr(builder, name), type) and issubclass(one, Matter)
]


@pytest.mark.parametrize("name", OBJECTS)
def test_every_setting_of_every_object_has_a_value(name: str) -> None:
    cls = getattr(builder, name)
    found = settings_of_object("one", cls, cls().scene_node, [])
    for setting in found.settings if found else []:
        given = whole_call(cls, cls().scene_node, setting.method, {})
        assert given is not None
        assert [*given.values()] == [one.value for one in setting.arguments]


def test_the_fields_that_can_have_noise_can_be_chosen(desk: Desk) -> None:
    desk.do("add_model", model="IMU", robot="robot")
    field = next(one for one in settings(desk, "robot.imu")["noise"] if one["name"] == "field")
    assert {"", "angular_velocity", "linear_acceleration"} <= {*field["choices"]}
    assert "timestamp" not in field["choices"]


def test_a_prop_has_no_colour_of_its_own_and_a_lamp_no_body(desk: Desk) -> None:
    desk.do("add_model", model="props/crates#small_crate", position=[3, 1, 0])
    desk.do("add_model", model="Spot", position=[3, 1, 0])
    assert "set_mass" in settings(desk, "small_crate")
    assert "color" not in settings(desk, "small_crate")
    answer = desk.ask("configure", component="spot", method="set_mass", values={"": 1.0})
    assert "'set_mass' is not a setting of Spot" in answer["error"]


@pytest.mark.parametrize(
    ("method", "values"),
    [
        ("set_mass", {"": 0.0}),
        ("set_mass", {"": "heavy"}),
        ("set_mass", {"": None}),
        ("set_restitution", {"": 1.1}),
        ("set_damping", {"linear": -1}),
        ("set_damping", {"sideways": 1}),
        ("color", {"r": 2.0}),
        ("color", {"r": "red"}),
        ("set_physics_type", {"": "SOFT_BODY"}),
        ("set_physics_type", {"": ["STATIC"]}),
        ("set_blender_object", {"": 1}),
        ("color", {"x y": 1}),
    ],
)
def test_a_value_that_is_refused_leaves_the_object_as_it_is(desk: Desk, method: str, values: object) -> None:
    desk.do("add_model", model="Cube", position=[3, 1, 0])
    before = desk.do("save_scene", write=False)["difference"]
    answer = desk.ask("configure", component="cube", method=method, values=values)
    assert not answer["ok"]
    assert answer["error"]
    assert desk.do("save_scene", write=False)["difference"] == before
    assert desk.simulation.scene.find("cube") is not None


def test_a_client_spawns_an_object_with_its_settings(desk: Desk) -> None:
    simulation = desk.simulation
    simulation.spawn(
        "ball", "Sphere\nscale(0.5, 0.5, 0.5)\nset_physics_type('RIGID_BODY')\nset_mass(3.0)", (9.0, 0.0, 3.0)
    )
    assert simulation.world.objects_by_name["ball"].mass == pytest.approx(3.0)
    for line in ("set_blender_object(1)", "frequency(3)", "set_physics_type('KINEMATIC')", "set_mass(-1)"):
        with pytest.raises(MorseError, match=line.partition("(")[0]):
            simulation.spawn("other", f"Cube\n{line}", (0.0, 0.0, 0.0))
    assert simulation.scene.find("other") is None
