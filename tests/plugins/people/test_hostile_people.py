"""What scripts, clients and saved states may say of people that makes no sense: errors with reasons, or counts."""

import copy
import logging
import math

import numpy as np
import pytest

import morse
from morse.core.state import StateError

SCENE = """
from morse.builder import *
crowd = Crowd("people", {count})
{lines}
{world}
env = Environment("empty")
"""
BOX = "crowd.start([(0, 0), (6, 6)])"
#: a room without a door around the goal
ROOM = """
for x, y, w, h in ((14, 9, 2, 0.1), (14, 13, 2, 0.1), (12, 11, 0.1, 2), (16, 11, 0.1, 2)):
    wall = Cube(f"wall{x}{y}")
    wall.scale = (w, h, 1.5)
    wall.translate(x, y, 1.5)
    wall.static()
"""


def _scene(folder, lines, count=5, world=""):
    path = folder / "scene.py"
    path.write_text(SCENE.format(count=count, lines=lines, world=world), "utf-8")
    return path


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("crowd.start([(0, 0), (1, 1)])", r"scene\.py:4: .*20 people do not fit into 1 m²: at most 6"),
        ("crowd.start([(0, 0), (1, 0), (2, 0)])", r"scene\.py:4: .*has no area"),
        ("crowd.start([(0, 0)])", r"scene\.py:4: .*at least 3 corners, got 1"),
        ("crowd.start([(0, 0), (float('nan'), 1)])", r"scene\.py:4: .*nan"),
        ("crowd.start([(0, 0), (1e9, 1e9)])", r"scene\.py:4: .*100000 m from the origin"),
        ("crowd.start('hall')", r"scene\.py:4: .*corners of a polygon, got 'hall'"),
        ("crowd.start()", r"scene\.py:4: .*an area or places"),
        ("crowd.start([(0, 0), (9, 9)], 21)", r"scene\.py:4: .*the crowd has 20 people"),
        ("crowd.start(places=[(0, 0), (3, 0), (0.1, 0.1)])", r"scene\.py:4: .*overlap: bodies are 0\.4 m broad"),
        ("crowd.start([(0, 0), (9, 9)], over=float('inf'))", r"scene\.py:4: .*inf"),
        ("crowd.goals([])", r"scene\.py:4: .*at least one goal"),
        ("crowd.goals('exit')", r"scene\.py:4: .*list of points, areas or names"),
        ("crowd.goals([(1, 2)], then='vanish')", r"scene\.py:4: .*vanish"),
        ("crowd.goals([(1, 2)], wait=-1)", r"scene\.py:4: .*-1"),
        ("crowd.goals([5])", r"scene\.py:4: .*points \(x, y\), areas or names, got 5"),
        ("crowd.avoids(7)", r"scene\.py:4: .*a robot or its name, got 7"),
        ("crowd.avoids('robot', 1.5)", r"scene\.py:4: .*1\.5"),
    ],
)
def test_a_script_is_told_the_line(tmp_path, lines, message):
    with pytest.raises(Exception, match=message):
        morse.load(_scene(tmp_path, lines, 20))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("0", "at least 1|1 or more|0"),
        ("5001", "at most 5000"),
        ("10, model='boids'", "boids"),
        ("10, speed=0", "0"),
        ("10, speed=float('nan')", "nan"),
        ("10, radius=9", "9"),
        ("10, children=0.7, wheelchairs=0.6", "1.3 together"),
        ("10, groups=2", "2"),
    ],
)
def test_a_crowd_of_impossible_people_is_refused(tmp_path, arguments, message):
    path = tmp_path / "scene.py"
    path.write_text(
        f"from morse.builder import *\ncrowd = Crowd('people', {arguments})\nEnvironment('empty')\n", "utf-8"
    )
    with pytest.raises(Exception, match=rf"scene\.py:2: .*({message})"):
        morse.load(path)


@pytest.mark.parametrize(
    ("lines", "world", "message"),
    [
        (
            BOX + "\ncrowd.goals(['exit_dor'])",
            "Cube('exit_door')",
            r"no object 'exit_dor' to go to.*did you mean 'exit_door'",
        ),
        (BOX + "\ncrowd.goals([(14, 11)])", ROOM, r"nobody can reach .*walls are between"),
        (
            BOX + "\ncrowd.goals([[(-3, -3), (-2, -3), (-2, -2)]])",
            "w = Cube('w')\nw.scale = (3, 3, 2)\nw.translate(-4, -4)\nw.static()",
            "nobody can stand at the goal",
        ),
    ],
)
def test_what_nobody_can_do_is_an_error_of_the_scene(tmp_path, lines, world, message):
    with pytest.raises(Exception, match=message):
        morse.load(_scene(tmp_path, lines, world=world))


def test_those_for_whom_there_is_no_room_are_counted(tmp_path, caplog):
    """The area is large enough, but most of it is a wall."""
    world = "w = Cube('w')\nw.scale = (1.6, 3, 2)\nw.translate(1.6, 3)\nw.static()"
    with (
        caplog.at_level(logging.WARNING),
        morse.load(_scene(tmp_path, "crowd.start([(0, 0), (4, 4)])", 30, world)) as sim,
    ):
        present = sim.people.data["present"]
        left_out = int((~present).sum())
        assert 0 < left_out < 30
        assert f"{left_out} of 30 people are left out" in caplog.text
        assert sim.people.ask(int(np.flatnonzero(~present)[0])).result()["state"] == "left out"
        assert np.isfinite(sim.people.data["positions"]).all()
        sim.step(30)


def test_those_who_alone_cannot_reach_a_goal_stay(tmp_path, caplog):
    with caplog.at_level(logging.WARNING):
        for seed in range(12):
            caplog.clear()
            with morse.load(
                _scene(tmp_path, "crowd.start([(0, 0), (15.5, 12.5)])\ncrowd.goals([(6, 8)])", 40, ROOM), seed=seed
            ) as sim:
                inside = (np.abs(sim.people.data["positions"][:, :2] - (14, 11)) < (1.9, 1.9)).all(axis=1)
                if not inside.any():
                    continue
                assert f"{inside.sum()} people cannot reach a goal, and stay" in caplog.text
                before = sim.people.data["positions"][inside]
                sim.step(60)
                assert np.abs(sim.people.data["positions"][inside] - before).max() < 1.0
                return
    pytest.fail("no seed has put anybody into the room")


@pytest.mark.parametrize(
    ("service", "arguments"),
    [
        ("send", (99, 1.0, 1.0)),
        ("send", (-1, 1.0, 1.0)),
        ("send", (0, 1e6, 0.0)),
        ("send", (0, math.nan, 0.0)),
        ("send", (0, 1e300, 0.0)),
        ("send", (0, "x", 0.0)),
        ("send", (0,)),
        ("send", (10**30, 1.0, 1.0)),
        ("send", (0, 14.0, 11.0)),
        ("call", (1e5, 1e5)),
        ("call", (3.0, 3.0, -4)),
        ("call", (3.0, 3.0, 10**12)),
        ("stop", (77,)),
        ("stop", ("all",)),
        ("resume", (5,)),
        ("ask", (5,)),
        ("ask", (-3,)),
        ("ask", ([],)),
    ],
)
def test_clients_get_errors_and_nobody_is_disturbed(tmp_path, service, arguments):
    with morse.load(_scene(tmp_path, BOX + "\ncrowd.goals([(6, 8)])", world=ROOM)) as sim:
        before = sim.state_hash()
        with pytest.raises(Exception, match=r".+"):
            getattr(sim.people, service)(*arguments).result()
        assert sim.state_hash() == before
        sim.step(5)


def test_a_thousand_places_of_clients_keep_few_ways(tmp_path):
    with morse.load(_scene(tmp_path, BOX)) as sim:
        for number in range(150):
            sim.people.send(number % 5, 0.04 * number, 3.0).result()
        assert len(sim.people.component.plan.ways) <= 64
        sim.step(5)


@pytest.mark.parametrize(
    "spoil",
    [
        lambda people: people.pop("mode"),
        lambda people: people.update(extra=np.zeros(3)),
        lambda people: people.update(position=np.zeros((3, 2))),
        lambda people: people.update(position=np.full((5, 2), np.nan)),
        lambda people: people.update(position=np.full((5, 2), 1e9)),
        lambda people: people.update(position=[[0, 0]] * 5),
        lambda people: people.update(mode=np.full(5, 99)),
        lambda people: people.update(flow=np.full(5, 7)),
        lambda people: people.update(stage=np.full(5, -2)),
        lambda people: people.update(stage=np.full(5, 50)),
        lambda people: people.update(lag="soon"),
        lambda people: people.update(lag=math.nan),
        lambda people: people.update(group=np.full(5, 10**9)),
        lambda people: people.update(rank=np.full(5, 10**12)),
        lambda people: people.update(heading=np.zeros((5, 2))),
        lambda people: people.update(stride=np.zeros(5)),
        lambda people: people.update(free_speed=np.full(5, -1.0)),
    ],
)
def test_a_damaged_state_is_refused(tmp_path, spoil):
    with morse.load(_scene(tmp_path, BOX + "\ncrowd.goals([(6, 8)])")) as sim:
        sim.step(3)
        crowd = sim.people.component
        state = copy.deepcopy(crowd.get_state())
        spoil(state["people"])
        before = sim.state_hash()
        with pytest.raises(StateError, match="people of people"):
            crowd.set_state(state)
        for touching in ([], {"0 crate": 3.0}, {"0 crate": (0.0, "a", 1.0)}, {"0 crate": (0.0, math.nan, 1.0)}):
            with pytest.raises(StateError, match="people of people"):
                crowd.set_state(crowd.get_state() | {"_touching": touching})
        assert sim.state_hash() == before
        sim.step(3)


def test_a_client_cannot_change_what_the_script_wrote(tmp_path):
    world = "robot = FakeRobot('robot')\ncube = Cube('cube')"
    with morse.load(_scene(tmp_path, BOX + "\ncrowd.goals([(6, 8)])", world=world)) as sim:
        for name in ("Plan", "Heights", "Attention", "Rides"):
            with pytest.raises(Exception, match=rf"'{name}' of people is written by Crowd"):
                sim.people.set_property(name, "[").result()
        sim.step(10)
        # robots are looked at again
        sim.delete("robot")
        sim.step(30)
        assert sim.failures == ()
        assert np.linalg.norm(sim.people.data["velocities"], axis=1).max() > 0.3


@pytest.mark.parametrize(
    "properties",
    ["Plan='['", "Plan='[]'", "Heights='[1.7]'", "Heights='{}'", "Heights='['"],
)
def test_a_script_that_writes_these_properties_itself_gets_an_error(tmp_path, properties):
    with pytest.raises(Exception, match=r"people.*(Plan|Heights|Attention|heights)"):
        morse.load(_scene(tmp_path, f"{BOX}\ncrowd.scene_node.properties.update({properties})"))
