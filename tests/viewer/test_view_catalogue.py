"""Every component of the catalogue is added in the page, works at once, is saved, and is there after a load."""

from __future__ import annotations

import json
import sys
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest
from editor_desk import Desk
from view_pages import Client, fetch

import morse
from morse.assets import load
from morse.launch import model_pictures
from morse.launch.model_pictures import Model, models
from morse.scene import PhysicsType
from morse.viewer import catalog
from morse.viewer.catalog import Catalog
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from pathlib import Path

    from morse.core.interfaces import Component
    from morse.simulation.simulation import Simulation

SCENE = """from morse.builder import *

car = ATRV()
wheeled = Pioneer3DX()
wheeled.translate(0, 4)
person = Human()
person.translate(0, 8)

env = Environment("empty")
env.properties(latitude=45.0, longitude=5.0, altitude=200.0)
"""
ROBOTS = ("car", "wheeled", "person")
#: components that are parts of another one, need arguments or see too much for a client, and what the page says
ELSEWHERE = {
    "Armature": "needs an armature",
    "ArmaturePose": "append it to an armature",
    "PTUPosture": "append it to a pan-tilt unit",
    "VLP16_180": "the scene script may set more",
}
#: what stands in buildings and streets: several bodies each, some of which move freely
FACILITIES = {
    "Button",
    "Charger",
    "Conveyor",
    "Crowd",
    "Dispenser",
    "Door",
    "Forklift",
    "Gate",
    "Lift",
    "Stairs",
    "Traffic",
    "TrafficLight",
    "Turntable",
}
#: sensors that say something only now and then
SILENT = {"Collision"}
#: components that are added before the scene is saved; all cameras together would be more than the budget
TOGETHER = 4


def component_of(simulation: Simulation, name: str) -> Component:
    return simulation.context.components[name]


def added(desk: Desk, model: Model) -> str | None:
    """The name of a component on the first robot that can carry it."""
    answers = []
    for robot in ROBOTS:
        answers.append(answer := desk.ask("add_model", model=model.kind, robot=robot))
        if answer["ok"]:
            return str(answer["value"])
    assert ELSEWHERE.get(model.name, "unexpected") in answers[0]["error"], model.name
    return None


def test_other_words_find_it() -> None:
    words = {model.name: model.words.lower().split() for model in models()}
    for name, word in [
        ("Pose", "where"),
        ("GPS", "where"),
        ("MotionVW", "wheels"),
        ("Hokuyo", "lidar"),
        ("Waypoint", "goto"),
        ("Human", "walk"),
        ("Cube", "wall"),
        ("Sphere", "ball"),
        ("DVL", "velocity"),
    ]:
        assert word in words[name]
    # what a component is for stands before the names of its data
    assert words["MotionVW"][:2] == ["drive", "wheels"]


@pytest.mark.long
def test_every_component_works_at_once_is_saved_and_loaded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    catalogue = [model for model in models() if model.group in ("sensors", "actuators")]
    assert len(catalogue) > 115
    # those of plug-ins are in it
    assert {"Radar", "DVL", "PeopleTracker", "Whiskers"} <= {model.kind for model in catalogue}
    monkeypatch.setattr(Catalog, "open", lambda listing: listing._take([model._asdict() for model in catalogue]))
    script = tmp_path / "scene.py"
    script.write_text(SCENE)
    refused = set()
    with morse.load(script, view="web") as simulation, Client(simulation.view.url) as client:
        simulation.step(1)
        desk = Desk(simulation, client)
        desk.models()
        before = set(simulation.context.components)
        for begin in range(0, len(catalogue), TOGETHER):
            names = {}
            for model in catalogue[begin : begin + TOGETHER]:
                if (name := added(desk, model)) is None:
                    refused.add(model.name)
                else:
                    names[name] = model
            simulation.step(10, measure=[one for one, model in names.items() if model.group == "sensors"])
            for name, model in names.items():
                component = component_of(simulation, name)
                assert component.active
                if model.group == "sensors" and model.name not in SILENT:
                    assert component.local_data["timestamp"] == pytest.approx(simulation.clock.time, abs=0.02), name
            assert simulation.failures == ()
            desk.do("save_scene", write=True)
            with morse.load(script) as again:
                assert set(again.context.components) == set(simulation.context.components)
                for name in names:
                    here, there = component_of(simulation, name), component_of(again, name)
                    assert type(here) is type(there)
                    nodes = [one.scene.find(name) for one in (simulation, again)]
                    assert nodes[0] is not None
                    assert nodes[1] is not None
                    assert [*nodes[1].location] == pytest.approx([*nodes[0].location], abs=1e-4)
                    assert [*nodes[1].rotation_euler] == pytest.approx([*nodes[0].rotation_euler], abs=1e-3)
            for _ in names:
                desk.do("undo_change")
            assert set(simulation.context.components) == before
    assert refused == set(ELSEWHERE)


def _robots() -> list[object]:
    """Robots and facilities of the catalogue; those of MORSE itself are many, and alike."""
    return [
        pytest.param(model, id=model.name, marks=() if model.name in FACILITIES else pytest.mark.long)
        for model in models()
        if model.group == "robots"
    ]


@pytest.mark.parametrize("model", _robots())
def test_every_robot_and_facility_is_added_saved_and_loaded(
    model: Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Catalog, "open", lambda listing: listing._take([model._asdict()]))
    script = tmp_path / "scene.py"
    script.write_text('from morse.builder import *\n\nenv = Environment("empty")\n')
    with morse.load(script, view="web") as simulation, Client(simulation.view.url) as client:
        simulation.step(1)
        desk = Desk(simulation, client)
        desk.models()
        before = set(simulation.context.robots), {node.name for node in simulation.scene.roots}
        name = desk.do("add_model", model=model.kind)
        simulation.step(10)
        assert simulation.context.robots[name].active
        assert simulation.failures == ()
        desk.do("save_scene", write=True)
        with morse.load(script) as again:
            assert set(again.context.robots) == set(simulation.context.robots)
            assert type(again.context.robots[name]) is type(simulation.context.robots[name])
            nodes = [one.scene.find(name) for one in (simulation, again)]
            assert nodes[0] is not None
            assert nodes[1] is not None
            assert [*nodes[1].location] == pytest.approx([*nodes[0].location], abs=1e-4)
            # also the boxes of a dispenser have their names
            assert {root.name for root in again.scene.roots} == {root.name for root in simulation.scene.roots}
        desk.do("undo_change")
        assert (set(simulation.context.robots), {node.name for node in simulation.scene.roots}) == before


def test_the_boxes_of_a_dispenser_are_moved_for_the_run_and_go_with_it(tmp_path: Path) -> None:
    """A script cannot name what a dispenser places: its line for a box that was moved could not be loaded."""
    text = 'from morse.builder import *\n\nsource = Dispenser()\nenv = Environment("empty")\n'
    script = tmp_path / "scene.py"
    script.write_text(text)
    with morse.load(script, view="web") as simulation, Client(simulation.view.url) as client:
        simulation.step(1)
        desk = Desk(simulation, client)
        world = client.expect("world")
        described = json.loads(fetch(simulation.view.url + world["url"].lstrip("/"))[2])
        placed = {node["name"] for node in described["nodes"] if node["placed_by"] == "source"}
        assert {"source box 0", "source box 11", "source roof"} <= placed
        desk.do("teleport", node="source box 0", position=[2, 2, 0.5], quaternion=[1, 0, 0, 0], first=True)
        assert simulation.context.world.objects_by_name["source box 0"].worldPosition.x == pytest.approx(2.0)
        assert "comes with 'source'" in desk.ask("delete_object", node="source box 0")["error"]
        assert desk.do("save_scene", write=False)["difference"] == ""
        before = {root.name for root in simulation.scene.roots}
        desk.do("delete_object", node="source")
        assert {root.name for root in simulation.scene.roots} == before - placed - {"source"}
        desk.do("undo_change")
        assert {root.name for root in simulation.scene.roots} == before
        assert script.read_text() == text


def test_a_page_that_adds_without_end_has_a_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    model = Model("Pose", "Pose", "sensors")
    monkeypatch.setattr(Catalog, "open", lambda listing: listing._take([model._asdict()]))
    monkeypatch.setattr("morse.viewer.editor._MOST_CHANGES", 8)
    script = tmp_path / "scene.py"
    script.write_text(SCENE)
    with morse.load(script, view="web") as simulation, Client(simulation.view.url) as client:
        simulation.step(1)
        desk = Desk(simulation, client)
        desk.models()
        for _ in range(7):
            desk.do("add_model", model="Pose", robot="car")
        desk.do("configure", component="car.pose", method="frequency", values={"": 10})
        desk.do("add_model", model="Pose", robot="car")
        answer = desk.ask("add_model", model="Pose", robot="car")
        assert not answer["ok"]
        assert "save and reload" in answer["error"]
        assert len([one for one in simulation.context.components if one.startswith("car.")]) == 8


class Kept:
    """A cache in memory."""

    def __init__(self) -> None:
        self.entries: dict[str, bytes] = {}

    def get(self, key: str, _most: int) -> bytes | None:
        return self.entries.get(key)

    def put(self, key: str, value: bytes) -> None:
        self.entries[key] = value


def test_the_list_reads_files_of_models_only_once_whatever_is_in_its_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    kept, read = Kept(), []

    def counted(path: Path) -> object:
        read.append(path)
        return load(path)

    monkeypatch.setattr(model_pictures, "_cache", kept)
    monkeypatch.setattr(model_pictures, "load", counted)
    crates = model_pictures._objects("crates", "props")
    assert "props/crates#small_crate" in {model.kind for model in crates}
    assert model_pictures._objects("crates", "props") == crates
    assert len(read) == 1
    for damaged in (b"\xff", b"[[1]]", b'{"kind": "x"}', b"[" * 5000):
        kept.entries = dict.fromkeys(kept.entries, damaged)
        assert model_pictures._objects("crates", "props") == crates
    assert len(read) == 5


def test_the_list_of_the_last_time_is_shown_at_once_and_a_new_one_takes_its_place(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    kept, programs = Kept(), []
    monkeypatch.setattr(catalog, "_cache", kept)
    monkeypatch.setattr(catalog, "command", lambda *_: [sys.executable, "-c", programs[-1]])

    def lists(*lines: object, until: int) -> list[list[str]]:
        """The names in each list that a page gets from a program that writes these lines."""
        programs.append("".join(f"print({json.dumps(line)!r});" for line in lines))
        sent: list[Any] = []
        server: Any = SimpleNamespace(send=sent.append, offer=lambda *_: "/url")
        listing = Catalog(server, [])
        try:
            listing.open()
            wait_until(lambda: (listing.update(), len(sent) >= until)[1])
        finally:
            listing.close()
        return [[model.name for model in one.models] for one in sent]

    first, second = ({"kind": name, "name": name, "group": "robots"} for name in ("ATRV", "Morsy"))
    # at first: what needs no files, then all
    assert lists({"first": [first]}, [first, second], until=2) == [["ATRV"], ["ATRV", "Morsy"]]
    # then all, at once, also if the process has not yet written anything
    assert lists(until=1) == [["ATRV", "Morsy"]]
    assert lists({"first": [second]}, [second], until=2) == [["ATRV", "Morsy"], ["Morsy"]]
    for damaged in (b"\xff", b"[[1]]", b'[{"kind": 1}]', b"[" * 5000):
        kept.entries = dict.fromkeys(kept.entries, damaged)
        assert lists([first], until=1) == [["ATRV"]]


def test_people_and_doors_tell_who_puts_them_in_their_places(tmp_path: Path) -> None:
    """Nothing carries kinematic bodies: the page says that they follow a move of their component at the next start."""
    script = tmp_path / "scene.py"
    script.write_text(
        "from morse.builder import *\n\nrobot = ATRV()\npeople = Crowd(count=2)\npeople.translate(5, 0)\n"
        'door = Door()\ndoor.translate(-5, 0)\nenv = Environment("empty")\n'
    )
    with morse.load(script, view="web") as simulation, Client(simulation.view.url) as client:
        world = client.expect("world")
        nodes = json.loads(fetch(simulation.view.url + world["url"].lstrip("/"))[2])["nodes"]
        for owner in ("people", "door"):
            root = simulation.scene.find(owner)
            assert root is not None
            below = {node.name for node in root.walk() if node.body.type is PhysicsType.KINEMATIC}
            assert below
            assert {node["name"] for node in nodes if node["placed_by"] == owner} == below
        assert not [node["name"] for node in nodes if node["placed_by"] == "robot"]


@pytest.mark.parametrize("group", ["sensors", "actuators", "robots"])
def test_what_cannot_be_drawn_is_named_in_the_log(
    group: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(several: list[Model]) -> None:
        raise ValueError("there is no object 'left_eye'\n  File eyes.py, line 19\n    self.left_eye = ...")

    monkeypatch.setattr(model_pictures, "drawn", fail)
    monkeypatch.setattr(model_pictures._cache, "put", lambda key, content: None)
    model_pictures._draw([Model("parts.eyes:Eyes", "Eyes", group)], lambda content: None)
    lines = capsys.readouterr().err.splitlines()
    assert "parts.eyes:Eyes has no picture" in lines[0]
    assert "there is no object 'left_eye'" in lines[0]
    # an actuator that looks for a part of its own robot has no fault: its traceback would suggest one
    assert ("without a robot" in lines[0]) == (len(lines) == 1) == (group != "robots")
