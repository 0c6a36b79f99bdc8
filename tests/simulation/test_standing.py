"""Bodies stand where a scene puts them; those that overlap part slowly."""

import json
import logging
import socket
import threading
import time
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest
import trimesh

import morse
from morse.builder import PassiveObject
from morse.simulation.simulation import Simulation
from pymorse import Morse

DATA = Path(morse.__file__).parent / "data"
WORLDS = sorted(
    path.relative_to(DATA / "environments").with_suffix("").as_posix()
    for path in (DATA / "environments").rglob("*.blend")
)
PROPS = sorted(f"props/{path.stem}" for path in (DATA / "props").glob("*.blend"))
#: m that a body may settle, in addition to its overlap
SETTLES = 0.05
#: largest height of an object above the ground in the files of 1.4, m
HOVERS = 1.0
#: distance at which a body may stand on another, m
NEAR = 1.5
#: objects that are meant to roll down the hills of a world
ROLLS = "Ball"


def scene(tmp_path: Path, text: str) -> Path:
    (tmp_path / "scene.py").write_text(f"from morse.builder import *\n{text}\n")
    return tmp_path / "scene.py"


def excursions(script: Path, seconds: float) -> Mapping[str, tuple[float, float, float]]:
    """How far each body leaves its place to a side or upwards, and how far it falls, m; and the overlap near it."""
    with morse.load(script) as sim:
        world = sim.world
        start = np.array(world.positions, dtype=float)
        away, low, depth = np.zeros(len(start)), np.zeros(len(start)), np.zeros(len(start))
        contact = world.data.contact
        for pair, distance in zip(contact.geom.tolist(), contact.dist.tolist(), strict=True):
            for geom in pair:
                slot = world.slot_of[world.geom_node[geom]]
                # what stands on a body rises with it
                near = np.linalg.norm(start - start[slot], axis=1) < NEAR
                depth[near] = np.maximum(depth[near], -distance)
        for _ in range(round(60 * seconds)):
            sim.step(1)
            offset = np.array(world.positions, dtype=float) - start
            away = np.maximum(away, np.hypot(np.linalg.norm(offset[:, :2], axis=1), np.maximum(offset[:, 2], 0.0)))
            low = np.maximum(low, -offset[:, 2])
        names = [slot.frame.node.name for slot in world.slots]
        return {name: values for name, *values in zip(names, away.tolist(), low.tolist(), depth.tolist(), strict=True)}


def leaving(
    moves: Mapping[str, tuple[float, float, float]], reach: float = 1.0
) -> dict[str, tuple[float, float, float]]:
    """The bodies that leave their places by more than the overlaps explain; those that hover in the file may fall.

    Args:
        reach: distance for each metre of overlap; 2 for objects that topple once they are out of the floor.
    """
    return {
        name: (away, low, depth)
        for name, (away, low, depth) in moves.items()
        if not name.startswith(ROLLS) and (away > reach * depth + SETTLES + low / 2.0 or low > HOVERS)
    }


def in_world(tmp_path: Path, world: str, seconds: float) -> dict[str, tuple[float, float]]:
    return leaving(excursions(scene(tmp_path, f"env = Environment('{world}', fastmode=True)"), seconds))


@pytest.mark.parametrize("world", ["outdoors", "tum_kitchen/tum_kitchen", "indoors-1/boxes"])
def test_a_world_stands(tmp_path: Path, world: str) -> None:
    assert in_world(tmp_path, world, 2.0) == {}


@pytest.mark.slow
@pytest.mark.parametrize("world", WORLDS)
def test_every_world_stands_for_ten_seconds(tmp_path: Path, world: str) -> None:
    assert in_world(tmp_path, world, 10.0) == {}


@pytest.mark.slow
@pytest.mark.parametrize("prop", PROPS)
def test_every_prop_stands_for_ten_seconds(tmp_path: Path, prop: str) -> None:
    text = f"prop = PassiveObject('{prop}')\nenv = Environment('empty', fastmode=True)"
    assert leaving(excursions(scene(tmp_path, text), 10.0), reach=2.0) == {}


def boxes(tmp_path: Path, **places: tuple[float, float, float]) -> Path:
    """A scene of cubes of 0.4 m."""
    trimesh.creation.box((0.4, 0.4, 0.4)).export(tmp_path / "box.obj")
    lines = [
        f"{name} = PassiveObject({str(tmp_path / 'box.obj')!r})\n{name}.translate{at}" for name, at in places.items()
    ]
    return scene(tmp_path, "\n".join([*lines, "env = Environment('empty', fastmode=True)"]))


@pytest.mark.parametrize("depth", [0.02, 0.05, 0.2])
def test_a_body_in_the_floor_comes_up_without_a_leap(tmp_path: Path, depth: float) -> None:
    with morse.load(boxes(tmp_path, crate=(2.0, 0.0, 0.2 - depth))) as sim:
        crate = sim.world.game_object("crate")
        assert crate.world_pose()[0][2] == pytest.approx(0.2 - depth, abs=1e-6)
        heights = []
        for _ in range(60 * 5):
            sim.step(1)
            heights.append(crate.world_pose()[0][2])
    assert max(heights) < 0.21
    assert heights[-1] == pytest.approx(0.2, abs=0.006)
    assert np.abs(np.diff(heights)).max() * 60.0 < 1.5 * depth + 0.3


def test_bodies_that_overlap_each_other_part_slowly(tmp_path: Path) -> None:
    moves = excursions(boxes(tmp_path, one=(2.0, 0.0, 0.2), other=(2.3, 0.05, 0.2)), 5.0)
    assert leaving(moves) == {}
    assert moves["one"][0] + moves["other"][0] > 0.08


def test_a_body_that_has_parted_bounces_and_stops_as_others(tmp_path: Path) -> None:
    """The softness ends: a crate on the one that has come up sinks in no deeper than on any other."""
    with morse.load(boxes(tmp_path, low=(2.0, 0.0, 0.05), top=(2.0, 0.0, 0.45))) as sim:
        sim.step(60 * 8)
        heights = [sim.world.game_object(name).world_pose()[0][2] for name in ("low", "top")]
        assert sim.world.separation.names() == []
    assert heights == pytest.approx([0.2, 0.6], abs=0.002)


def test_a_spawned_body_parts_slowly_and_leaves_others_as_they_are(tmp_path: Path) -> None:
    with morse.load(boxes(tmp_path, low=(2.0, 0.0, 0.2), far=(5.0, 0.0, 0.2))) as sim:
        sim.step(30)
        sim.spawn("new", lambda: PassiveObject(str(tmp_path / "box.obj")), position=(2.0, 0.0, 0.3))
        assert sorted(sim.world.separation.names()) == ["low", "new"]


def test_a_restored_state_continues_softly(tmp_path: Path) -> None:
    script = boxes(tmp_path, crate=(2.0, 0.0, 0.0))
    with morse.load(script) as sim, morse.load(script) as other:
        sim.step(20)
        other.world.set_state(sim.world.get_state())
        sim.step(60)
        other.step(60)
        assert other.world.game_object("crate").world_pose() == sim.world.game_object("crate").world_pose()
        sim.world.reset()
        sim.step(80)
        assert sim.world.game_object("crate").world_pose() == other.world.game_object("crate").world_pose()


def test_overlaps_are_named_with_their_depths(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    with (
        caplog.at_level(logging.INFO, "morse.main"),
        morse.load(boxes(tmp_path, one=(2.0, 0.0, 0.2), other=(2.3, 0.0, 0.15))),
    ):
        pass
    text = "\n".join(record.getMessage() for record in caplog.records if "overlap at the start" in record.getMessage())
    assert text.count("'other'") == 2
    assert "by 0.1 m" in text
    assert "by 0.05 m" in text


@pytest.mark.parametrize("robot", ["ATRV", "RMax", "Pioneer3DX"])
def test_a_robot_below_the_floor_is_named(tmp_path: Path, caplog: pytest.LogCaptureFixture, robot: str) -> None:
    text = f"low = {robot}()\nlow.translate(2, 0, -8)\nhigh = {robot}()\nhigh.translate(5, 0, 8)\n"
    with (
        caplog.at_level(logging.WARNING),
        morse.load(scene(tmp_path, text + "env = Environment('sandbox', fastmode=True)")),
    ):
        pass
    (message,) = [record.getMessage() for record in caplog.records if "below" in record.getMessage()]
    assert "'low'" in message
    assert "'high'" not in message


@pytest.mark.parametrize(
    ("robot", "more", "falls"),
    [
        ("ATRV", "", True),
        ("Pioneer3DX", "", True),
        ("RMax", "", False),
        ("ATRV", "one.properties(NoGravity=True)", False),
    ],
)
def test_a_world_without_a_floor_says_so(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, robot: str, more: str, falls: bool
) -> None:
    size = "<geometry><box><size>1 1 1</size></box></geometry>"
    (tmp_path / "shelf.sdf").write_text(
        '<sdf version="1.6"><world name="w"><model name="shelf"><static>true</static><pose>9 0 3 0 0 0</pose>'
        f'<link name="l"><collision name="c">{size}</collision><visual name="v">{size}</visual></link></model>'
        "</world></sdf>"
    )
    path = scene(tmp_path, f"one = {robot}()\none.translate(2, 0, 1)\n{more}\nEnvironment('shelf.sdf', fastmode=True)")
    with caplog.at_level(logging.WARNING), morse.load(path):
        pass
    told = [record.getMessage() for record in caplog.records if "no floor" in record.getMessage()]
    assert [text.partition(": ")[2] for text in told] == (
        ["the world has no floor below its robots, which fall: 'one'"] if falls else []
    )


# -- a robot that the script placed above the floor is at rest in the first message of a run -------

SCENE = """
robot = SegwayRMP400()
robot.translate(z=0.1)
pose = Pose()
robot.append(pose)
robot.add_default_interface("socket")
env = Environment("empty", fastmode=True)
"""


def test_the_first_message_of_a_client_that_waits_before_the_start(load: Callable[..., Simulation]) -> None:
    simulation = load(SCENE)
    (manager,) = (m for m in simulation.context.stream_managers.values() if hasattr(m, "_ports"))
    with socket.create_connection(("127.0.0.1", manager._ports["robot.pose"]), timeout=60.0) as client:
        limit = time.monotonic() + 60.0
        while not manager._servers["robot.pose"].connected and time.monotonic() < limit:
            time.sleep(0.01)
        simulation.run(1.0)
        first = json.loads(client.makefile().readline())
    assert first["z"] == pytest.approx(0.20, abs=0.02)


def test_steps_send_every_message(load: Callable[..., Simulation]) -> None:
    simulation = load(SCENE)
    simulation.pause()
    thread = threading.Thread(target=simulation.run)
    thread.start()
    try:
        (manager,) = simulation.context.services.request_managers().values()
        with Morse("127.0.0.1", manager.port) as simu:
            pose = simu.robot.pose
            simu.step(1)
            assert pose.last()["timestamp"] == pytest.approx(1 / 60)
    finally:
        simulation.stop()
        simulation.context.wake()
        thread.join(60.0)
