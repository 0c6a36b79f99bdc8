"""A recorded run is shown from its records: poses, appearance, robots that come and go; nothing is simulated."""

import contextlib
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import morse
from morse.launch.load import start
from morse.launch.playing import playing
from morse.launch.recorded_run import inputs_of, shown_scene
from morse.recording.recording import RecordedWorld, Recording
from morse.simulation.recordings.timeline import RecordedTimeline, Timeline
from morse.simulation.simulation import Simulation

SCRIPT = """
from morse.builder import *

robot = Pioneer3DX()
robot.translate(x=-2.0)
motion, lamp = MotionVWDiff(), Light()
for part in (motion, lamp):
    robot.append(part)
ball = Cube()
ball.properties(Object=True)
ball.translate(2.0, 0.0, 3.0)
box = Cube("box")
box.translate(4.0, 4.0, 0.5)
Environment("empty", fastmode=True)
"""


def world_of(sim: Simulation) -> dict[str, Any]:
    """Pose and appearance of every object, by name."""
    return {
        obj.name: (
            np.array([*obj.world_pose()[0], *obj.world_pose()[1]]),
            (obj.visible, obj.node.color, obj.node.light and (obj.node.light.energy, obj.node.light.color)),
        )
        for obj in sim.world.objects()
    }


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[dict[str, Any]]]:
    """A recording, and the world after each tick."""
    folder = tmp_path_factory.mktemp("shown")
    script, path = folder / "scene.py", folder / "run.mcap"
    script.write_text(SCRIPT)
    with morse.load(script, seed=4) as sim:
        sim.step(3)
        found = [world_of(sim)]

        def step(ticks: int) -> None:
            for _ in range(ticks):
                sim.step()
                found.append(world_of(sim))

        with sim.record(path):
            sim.robot.motion.publish({"v": 1.0, "w": 1.0})
            step(15)
            sim.robot.lamp.publish({"emit": True})
            sim.call("simulation", "set_object_visibility", "box", False, False)
            step(5)
            sim.spawn("guest", "Morsy", [-3.0, 3.0, 0.2])
            step(5)
            sim.restart(9)
            step(6)
            sim.spawn("guest", "Morsy", [3.0, 3.0, 0.2])
            sim.world.game_object("box").worldPosition = (5.0, 5.0, 1.0)
            step(5)
            sim.delete("guest")
            assert tuple(sim.world.game_object("box").worldPosition) == (5.0, 5.0, 1.0)
            step(4)
    return path, found


@pytest.fixture(params=["", "scene.py"], ids=["from the recording", "from the script"])
def shown(run: tuple[Path, list[dict[str, Any]]], request: pytest.FixtureRequest) -> Any:
    import contextlib as context

    with context.ExitStack() as stack:
        recording = stack.enter_context(Recording(run[0]))
        yield opened(recording, stack, request.param and str(run[0].with_name(request.param)))


def opened(recording: Recording, stack: contextlib.ExitStack, scene: str) -> tuple[Simulation, RecordedTimeline]:
    inputs = inputs_of(recording)
    shown = shown_scene(recording, inputs, scene, False, stack, print)
    assert shown.is_described == (not scene)
    simulation = stack.enter_context(start(shown.scene, shown.options))
    assert RecordedTimeline.is_possible(recording, inputs)
    return simulation, RecordedTimeline(simulation, recording, inputs, described=shown.is_described)


def assert_same(sim: Simulation, wanted: dict[str, Any], where: str) -> None:
    found = world_of(sim)
    assert found.keys() == wanted.keys(), where
    for name, (pose, look) in wanted.items():
        np.testing.assert_allclose(found[name][0], pose, atol=1e-9, err_msg=f"{name} {where}")
        assert found[name][1] == look, f"{name} {where}"


def test_the_world_is_that_of_the_run_at_every_tick(shown: Any, run: tuple[Path, list[dict[str, Any]]]) -> None:
    sim, timeline = shown
    truth = run[1]
    assert timeline.length == len(truth) - 1 == 40
    for position in range(1, 41):
        timeline.forward()
        assert timeline.position == position
        assert_same(sim, truth[position], f"after {position} ticks")
    assert timeline.at_end
    places = [38, 17, 18, 3, 30, 26, 25, 24, 40, 0, 33]
    random.Random(2).shuffle(places)
    # just before the object was moved, which stands still otherwise
    for position in [*places, 40, 31]:
        assert timeline.approach(position)
        assert_same(sim, truth[position], f"after a jump to {position}")


def test_nothing_is_simulated(shown: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    sim, timeline = shown
    monkeypatch.setattr(type(sim._ticker), "tick", lambda *_: pytest.fail("a tick"))
    monkeypatch.setattr(type(sim.world), "step", lambda *_: pytest.fail("a step of the physics"))
    for position in (40, 10, 30):
        timeline.approach(position)
    assert sim.clock.tick == 5  # 25 ticks after the beginning, the run was restarted


def test_the_page_gets_the_recorded_poses(shown: Any, run: tuple[Path, list[dict[str, Any]]]) -> None:
    sim, timeline = shown
    timeline.approach(20)
    nodes = [node.name for node, frame in sim.world.moving_nodes() if frame == "world"]
    poses = timeline.poses()
    for row, name in enumerate(nodes):
        np.testing.assert_allclose(poses[row, :3], run[1][20][name][0][:3], rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(poses[:, 3:], axis=1), 1.0, rtol=1e-6)


def test_a_recording_without_poses_is_simulated_again(tmp_path: Path) -> None:
    script, path = tmp_path / "scene.py", tmp_path / "run.mcap"
    script.write_text(SCRIPT)
    with morse.load(script) as sim, sim.record(path, sensors=[]):
        sim.step(5)
    with Recording(path) as recording:
        assert not RecordedWorld.is_in(recording)
        with playing(recording, port=0, browser=False) as view:
            assert isinstance(view._timeline, Timeline)


def test_the_page_gets_the_pose_of_a_static_object_that_was_moved(shown: Any) -> None:
    sim, timeline = shown
    for position, wanted in ((40, (5.0, 5.0, 1.0)), (31, None), (39, (5.0, 5.0, 1.0))):
        timeline.approach(position)
        rows = {node.name: row for (node, _), row in zip(sim.world.moving_nodes(), timeline.poses(), strict=True)}
        assert ("box" in rows) == (wanted is not None), position
        if wanted is not None:
            assert rows["box"][:3] == pytest.approx(wanted)
