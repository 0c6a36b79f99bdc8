"""Components are added to robots, set up anew and deleted while the simulation runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import morse
from morse.builder import ATRV, Environment, MotionVW, Pose, VideoCamera
from morse.core.exceptions import MorseError
from morse.launch.playing import playing
from morse.recording.recording import Recording
from morse.verification.resimulation import resimulate
from pymorse.errors import MorseServiceFailed

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from morse.simulation.simulation import Simulation


def scene() -> None:
    robot, other = ATRV(), ATRV()
    other.translate(0.0, 5.0)
    pose, camera = Pose(), VideoCamera()
    camera.properties(cam_width=64, cam_height=32)
    camera.frequency(10)
    robot.append(pose)
    robot.append(camera)
    Environment("empty")


@pytest.fixture
def sim() -> Iterator[Simulation]:
    with morse.load(scene) as simulation:
        simulation.step(20)
        yield simulation


def furnish(sim: Simulation) -> None:
    """Change what is on the robots in all ways."""
    sim.spawn("robot.gyro", "Gyroscope\nfrequency(20)\nalter('Noise', rot_std=0.1)", (0.1, 0.0, 1.0))
    sim.spawn("robot.motion", "MotionVW")
    sim.spawn("morsy", "Morsy", (0.0, -4.0, 0.1))
    sim.spawn("morsy.pose", "Pose", (0.0, 0.0, 0.3))
    sim.delete("robot.camera")
    sim.spawn("robot.camera", "\nfrequency(30)", (0.3, 0.0, 1.0))
    sim.delete("robot.pose")
    sim.robot.motion.publish({"v": 1.0, "w": 0.3})
    sim.step(30)


def components(sim: Simulation) -> list[str]:
    return [*sim.context.components]


def place_of(sim: Simulation, robot: str) -> tuple[float, float, float]:
    x, y, z = sim.context.robots[robot].bge_object.worldPosition
    return x, y, z


def test_time_and_state_go_on(sim: Simulation) -> None:
    place, tick = place_of(sim, "robot"), sim.ticks
    sim.spawn("robot.motion", "MotionVW")
    assert (place_of(sim, "robot"), sim.ticks) == (place, tick)
    sim.robot.motion.publish({"v": 2.0, "w": 0.0})
    sim.step(60)
    assert place_of(sim, "robot")[0] == pytest.approx(place[0] + 2.0, abs=0.05)
    # who does not touch it notices nothing
    with morse.load(scene) as undisturbed:
        undisturbed.step(80)
        assert place_of(undisturbed, "other") == place_of(sim, "other")


def test_the_bits_are_those_of_a_scene_with_the_component() -> None:
    def complete() -> None:
        robot = ATRV()
        motion = MotionVW()
        robot.append(motion)
        Environment("empty")

    def bare() -> None:
        robot = ATRV()  # noqa: F841
        Environment("empty")

    with morse.load(complete) as expected, morse.load(bare) as sim:
        sim.spawn("robot.motion", "MotionVW")
        for one in (expected, sim):
            one.robot.motion.publish({"v": 1.0, "w": 0.5})
            one.step(100)
        assert place_of(sim, "robot") == place_of(expected, "robot")


def test_states_hold_who_came_and_went(sim: Simulation) -> None:
    furnish(sim)
    there, state, digest = components(sim), sim.save(), sim.state_hash()
    assert "robot.pose" not in there
    sim.delete("robot")
    sim.delete("morsy")
    sim.step(5)
    sim.restore(state)
    assert (components(sim), sim.state_hash()) == (there, digest)
    sim.step(10)
    later = sim.state_hash()
    sim.restart()
    assert set(components(sim)) == {"robot.pose", "robot.camera"}
    assert sim.context.components["robot.camera"].frequency == 10.0
    with morse.load(scene) as elsewhere:
        elsewhere.restore(state)
        assert elsewhere.state_hash() == digest
        elsewhere.step(10)
        assert elsewhere.state_hash() == later


def test_a_component_comes_again_as_it_was_set_up(sim: Simulation) -> None:
    sim.delete("robot.camera")
    sim.spawn("robot.camera", "\nfrequency(30)", (0.2, 0.0, 1.0))
    camera = sim.context.components["robot.camera"]
    assert (camera.frequency, camera.image_width, camera.image_height) == (30.0, 64, 32)  # type: ignore[attr-defined]


def test_a_restart_after_changes_is_as_the_launch(sim: Simulation) -> None:
    with morse.load(scene) as new:
        new.step(20)
        expected = new.state_hash()
    furnish(sim)
    sim.restart()
    sim.step(20)
    assert sim.state_hash() == expected


def test_runs_are_simulated_again_and_shown(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(
        "from morse.builder import *\nrobot = ATRV()\npose = Pose()\nrobot.append(pose)\ncamera = VideoCamera()\n"
        "robot.append(camera)\nother = ATRV()\nother.translate(0, 5)\nenv = Environment('empty')\n"
    )
    with morse.load(script) as sim:
        # also what came before the recording
        sim.spawn("robot.early", "Gyroscope", (0.0, 0.0, 1.0))
        sim.delete("robot.pose")
        sim.step(5)
        with sim.record(tmp_path / "run.mcap"):
            sim.step(5)
            sim.spawn("robot.motion", "MotionVW")
            sim.spawn("robot.gyro", "Gyroscope\nfrequency(20)", (0.1, 0.0, 1.0))
            sim.robot.motion.publish({"v": 1.0, "w": 0.3})
            sim.step(20)
            place = sim.world.objects_by_name["robot.gyro"].world_pose()[0]
            sim.delete("robot.early")
            sim.step(5)
    with Recording(tmp_path / "run.mcap") as recording:
        outcome = resimulate(recording, trust=True)
        assert outcome.departure is None
        assert outcome.complete
    with Recording(tmp_path / "run.mcap") as recording, playing(recording, port=0, browser=False) as view:
        shown = view._simulation
        for position in (3, 25, 30, 3, 25):
            view._timeline.approach(position)
            present = set(shown.context.components)
            assert ("robot.gyro" in present) == (position > 5)
            assert ("robot.early" in present) == (position < 30)
            assert "robot.pose" not in present
            if position == 25:
                gyro = shown.world.objects_by_name["robot.gyro"].world_pose()[0]
                assert gyro == pytest.approx(place, abs=1e-9)


@pytest.mark.parametrize(
    ("name", "kind", "why"),
    [
        ("nobody.pose", "Pose", "no robot 'nobody'"),
        ("robot.nothing.pose", "Pose", "no robot or component 'robot.nothing'"),
        ("robot.pose", "Pose", "already"),
        ("robot.Pose", "Gyroscope", "already"),
        ("robot.a b", "Pose", "word"),
        ("robot.", "Pose", "word"),
        (".pose", "Pose", "no robot ''"),
        ("robot.port", "Pose", "reserved"),
        ("robot.new", "ATRV", "expected a sensor or an actuator"),
        ("robot.new", "props/crates", "expected a sensor or an actuator"),
        ("robot.new", "MotionVWDiff", "no wheels"),
        ("robot.new", "", "cannot come again"),
        ("robot.new", "<robot name='x'><link name='a'/></robot>", "expected a sensor or an actuator"),
        ("robot.new", "Pose\nexec('x')", "not a setting"),
        ("robot.new", "Pose\n__init__()", "not a setting"),
        ("robot.new", "Pose\nalter('os.system')", "installed"),
        ("robot.new", "Pose\nalter(classpath='os.system')", "installed"),
        ("robot.new", "Pose\nadd_stream('os.path')", "installed"),
        ("robot.new", "Pose\nadd_stream('socket', classpath='os.system')", "installed"),
        ("robot.new", "Pose\nproperties(classpath='os.system')", "no property"),
        ("robot.new", "Pose\nfrequency(float('nan'))", "plain values"),
        ("robot.new", "Pose\nfrequency(1e999)", "finite"),
        ("robot.new", "Pose\nfrequency(**{'a': 1})", "plain values"),
        ("robot.new", "Pose\nfrequency(" + "(" * 5000, "plain values"),
        ("robot.new", "Pose\n" + "frequency(1)\n" * 1000, "at most 100"),
        ("robot.new", "VideoCamera\nproperties(cam_width=10**9)", "plain values"),
        ("robot.new", "Pose\ndelay(1e9)", "at most 60 s"),
        ("robot.new", "Pose\ndelay(seconds=61)", "at most 60 s"),
        ("robot.new", "Pose\ndelay(-1)", "delay"),
        ("robot.new", "CompoundSensor", "cannot come as CompoundSensor"),
        ("robot.new", "VideoCamera\nproperties(cam_width=1000000000)", "cam_width"),
    ],
)
def test_what_is_refused_has_no_effect(sim: Simulation, name: str, kind: str, why: str) -> None:
    digest, there = sim.state_hash(), components(sim)
    with pytest.raises((MorseError, ValueError, OSError), match=why):
        sim.spawn(name, kind)
    assert (components(sim), sim.state_hash()) == (there, digest)
    sim.step(1)


@pytest.mark.parametrize("place", [(10**400, 0, 0), (True, 0, 0), (float("nan"), 0, 0), (0, 0)])
def test_a_position_is_three_finite_numbers(sim: Simulation, place: tuple[float, ...]) -> None:
    digest = sim.state_hash()
    with pytest.raises(MorseError, match=r"position of 'robot\.new' is 3 numbers"):
        sim.spawn("robot.new", "Pose", place)
    assert sim.state_hash() == digest


def test_clients_add_a_limited_number_of_components(sim: Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("morse.simulation.population._MOST_ADDED", 3)
    for k in range(3):
        ask(sim, f"robot.pose{k}", "Pose")
    with pytest.raises(MorseServiceFailed, match="at most 3 components"):
        ask(sim, "robot.pose3", "Pose")
    sim.delete("robot.pose1")
    ask(sim, "robot.pose3", "Pose")
    sim.spawn("robot.pose4", "Pose")  # a program is not limited


def ask(sim: Simulation, name: str, kind: str) -> None:
    sim.call("simulation", "spawn", name, kind).result(10)


def test_cameras_of_clients_have_one_budget(sim: Simulation) -> None:
    # 5 million pixels per second
    kind = "VideoCamera\nproperties(cam_width=1000, cam_height=500)\nfrequency(10)"
    ask(sim, "robot.first", kind)
    with pytest.raises(MorseServiceFailed, match="budget"):
        ask(sim, "robot.second", kind)
    # neither a restart of the robot nor one that comes again give more
    sim.call("simulation", "restart_robot", "robot").result(10)
    with pytest.raises(MorseServiceFailed, match="budget"):
        ask(sim, "robot.second", kind)
    assert "robot.second" not in sim.context.components


def test_a_camera_of_the_script_may_come_again_as_large_as_it_was() -> None:
    def large() -> None:
        robot, camera = ATRV(), VideoCamera()
        camera.properties(cam_width=1000, cam_height=1000)
        camera.frequency(20)
        robot.append(camera)
        Environment("empty")

    with morse.load(large) as sim:
        sim.delete("robot.camera")
        ask(sim, "robot.camera", "\nfrequency(10)")
        sim.delete("robot.camera")
        with pytest.raises(MorseServiceFailed, match="budget"):
            ask(sim, "robot.camera", "\nfrequency(60)")


def test_parts_of_what_a_client_has_spawned_go_only_together(sim: Simulation) -> None:
    sim.spawn("visitor", lambda: _with_pose(), (3.0, 0.0, 0.1))
    with pytest.raises(MorseError, match="visitor"):
        sim.delete("visitor.pose")
    sim.spawn("visitor.more", "Pose")
    sim.delete("visitor.more")
    assert "visitor.pose" in components(sim)


def _with_pose() -> ATRV:
    robot, pose = ATRV(), Pose()
    robot.append(pose)
    pose.name = "pose"
    return robot
