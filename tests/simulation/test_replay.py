"""A run is determined by its scene, its seed and its inputs: its replay is bit-identical."""

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import morse
from morse.builder import ATRV, Environment, Keyboard, Morsy, MotionVW, PassiveObject, Pose, Teleport
from morse.core.state import StateError
from morse.simulation.recordings.input_recording import InputRecording
from morse.simulation.simulation import Simulation
from tests.kit.effort import examples


def scene() -> None:
    """A robot with commands, a robot that keys drive, and a crate to push."""
    robot = ATRV()
    motion, pose = MotionVW(), Pose()
    robot.append(motion)
    robot.append(pose)
    pose.noise(gaussian=0.01)
    morsy = Morsy()
    morsy.translate(0.0, 3.0, 0.2)
    keys = Keyboard()
    morsy.append(keys)
    crate = PassiveObject("props/crates", "small_crate")
    crate.translate(1.2, 0.0, 0.3)
    Environment("empty")


def teleporting() -> Any:
    """A robot with a teleport."""
    robot = Morsy()
    there = Teleport()
    robot.append(there)
    return robot


_speeds = st.floats(-1.0, 1.0, allow_nan=False)
_inputs = st.one_of(
    st.tuples(st.just("command"), _speeds, _speeds),
    st.tuples(st.just("service"), _speeds, _speeds),
    st.tuples(st.just("stop")),
    st.tuples(st.just("keys"), st.sampled_from(["ArrowUp", "ArrowLeft", ""])),
    st.tuples(st.just("move"), _speeds, _speeds),
    st.tuples(st.just("off")),
    st.tuples(st.just("on")),
    st.tuples(st.just("refused")),
    st.tuples(st.just("spawn")),
    st.tuples(st.just("delete")),
    st.tuples(st.just("restart"), st.integers(0, 9)),
)


def give(sim: Simulation, what: tuple[Any, ...]) -> None:
    """One input."""
    match what:
        case ("command", v, w):
            sim.robot.motion.publish({"v": v, "w": w})
        case ("service", v, w):
            sim.robot.motion.set_speed(v, w)
        case ("stop",):
            sim.robot.motion.stop()
        case ("keys", key):
            sim.set_controls(frozenset([key] if key else []))
        case ("move", x, y):
            sim.rpc("simulation", "set_object_position", "morsy", [3.0 + x, 3.0 + y, 0.2])
        case ("off",):
            sim.deactivate("robot.motion")
        case ("on",):
            sim.activate("robot.motion")
        case ("refused",):
            with pytest.raises(Exception, match="set_speed"):
                sim.call("robot.motion", "set_speed", "fast", 0.0)
        case ("spawn",):
            if "guest" not in sim.robots:
                sim.spawn("guest", "Morsy", [-3.0, 0.0, 0.2])
        case ("delete",):
            if "guest" in sim.robots:
                sim.delete("guest")
        case ("restart", seed):
            sim.restart(seed)


@settings(max_examples=examples(15))
@given(
    st.lists(st.tuples(st.integers(0, 15), _inputs), min_size=1, max_size=12), st.integers(0, 20), st.integers(0, 2**31)
)
def test_a_run_is_the_same_again_from_its_inputs(inputs: list[Any], before: int, seed: int) -> None:
    with morse.load(scene, seed=seed) as sim:
        sim.step(before)
        recorder = sim.record_inputs()
        for pause, what in inputs:
            sim.step(pause)
            give(sim, what)
        sim.step(5)
        recording = recorder.stop()
        wanted = sim.state_hash()
    with morse.load(scene, seed=seed + 1) as again:
        again.replay(recording)
        assert again.state_hash() == wanted


def test_a_recording_survives_in_a_file(tmp_path: Path) -> None:
    with morse.load(scene, seed=4) as sim:
        with sim.record_inputs() as recording:
            sim.robot.motion.publish({"v": 0.5})
            sim.step(20)
            before = sim.save()
            sim.spawn("guest", "Morsy", [-3.0, 0.0, 0.2], [0.0, 0.0, 1.0])
            sim.step(10)
            sim.restore(before)
            sim.set_controls(frozenset(["ArrowUp"]), (0.5, 0.0), "morsy")
            sim.step(10)
        wanted = sim.state_hash()
        recording.write(tmp_path / "run.inputs")
    with morse.load(scene) as again:
        ticks: list[int] = []
        again.replay(InputRecording.read(tmp_path / "run.inputs"), lambda: ticks.append(again.ticks))
        assert again.state_hash() == wanted
    assert ticks == [*range(1, 31), *range(21, 31)]


@pytest.mark.parametrize(
    "before",
    [
        lambda sim: sim.spawn("guest", "Morsy", [-3.0, 0.0, 0.2]),
        lambda sim: sim.robot.motion.set_speed(0.4, 0.1),
        lambda sim: sim.rpc("simulation", "set_object_position", "morsy", [3.0, 3.0, 0.2]),
        lambda sim: (sim.set_controls(frozenset(["ArrowUp"])), sim.restart()),
    ],
    ids=["spawned", "called", "moved", "keys"],
)
def test_a_recording_from_tick_0_on_begins_with_what_happened_before(before: Any) -> None:
    with morse.load(scene, seed=2) as sim:
        before(sim)
        with sim.record_inputs() as recording:
            sim.step(8)
        wanted = sim.state_hash()
    with morse.load(scene) as again:
        again.replay(recording)
        assert again.state_hash() == wanted


def test_a_journal_without_readers_is_not_kept() -> None:
    with morse.load(scene) as sim:
        recorder = sim.record_inputs()
        recording = recorder.stop()
        sim.robot.motion.publish({"v": 0.5})
        sim.step(3)
        assert recording.entries == []
        assert sim.journal.sinks == []


def test_what_a_function_made_cannot_be_kept_in_a_file(tmp_path: Path) -> None:
    with morse.load(scene) as sim:
        with sim.record_inputs() as recording:
            sim.spawn("guest", teleporting, [-3.0, 0.0, 0.2])
            sim.step(2)
        wanted = sim.state_hash()
        with pytest.raises(ValueError, match="guest"):
            recording.write(tmp_path / "run.inputs")
    assert not list(tmp_path.iterdir())
    with morse.load(scene) as again:
        again.replay(recording)
        assert again.state_hash() == wanted


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"MORSE inputs 1\n",
        b"MORSE inputs 1\n\x93\x01\x02\x03",
        b"something else",
        b"MORSE inputs 1\n" + b"\x92" * 100_000,
    ],
)
def test_files_that_are_no_recordings_are_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "run.inputs"
    path.write_bytes(content)
    with pytest.raises(StateError):
        InputRecording.read(path)
