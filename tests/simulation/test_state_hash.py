"""The hash of a state is equal wherever the future is equal, and differs where the future differs."""

import contextlib
import pickle
from collections.abc import Iterator
from typing import Any

import pytest
import state_of_components as components

import morse
from morse.simulation.recordings.input_recording import InputRecorder
from morse.simulation.recordings.replaying import Replay
from morse.simulation.states.state import State
from tests.kit.programs import new_processes

#: components with a state of their own, some of which act in groups
SHORT = ("IMU", "MotionVW", "Odometry", "Waypoint", "PTU")
_SENSORS = sorted(set(components.names()) - {"CompoundSensor"} - set(components.catalog.components("morse.actuators")))


@pytest.fixture(scope="module")
def elsewhere() -> Iterator[Any]:
    """Another process."""
    with new_processes() as pool:
        yield pool


class _Run:
    """A run of 2 × ``ticks``, to be compared with others."""

    def __init__(self, name: str, ticks: int, *, real: bool) -> None:
        self.name, self.ticks = name, ticks
        self.simulation, self.carrier = components.load(name, real=real)
        self.build = components.scene(name, self.carrier, real=real)
        self.pickled = pickle.dumps(self.simulation.scene)
        self.real = real
        self.hash = self.simulation.state_hash()
        self.begin = self._go(self.simulation)
        self.state = self.simulation.save()
        self.content = self.state.to_bytes()
        self.end = self._go(self.simulation)

    def _go(self, simulation: Any) -> tuple[list[Any], str]:
        return components.go(simulation, self.name, self.ticks), simulation.state_hash()

    def check_all(self, scene: Any) -> None:
        """Check that a scene has the same states and data from the beginning."""
        with morse.load(scene, seed=3) as other:
            assert other.state_hash() == self.hash
            assert self._go(other) == self.begin
            assert self._go(other) == self.end

    def check_restored(self, simulation: Any, state: State) -> None:
        """Check that a simulation has the same end after the state in the middle was restored."""
        simulation.restore(state)
        assert simulation.state_hash() == self.state.hash()
        assert self._go(simulation) == self.end


def _check(name: str, ticks: int, elsewhere: Any, monkeypatch: pytest.MonkeyPatch, *, real: bool = False) -> None:
    run = _Run(name, ticks, real=real)
    with contextlib.closing(run.simulation):
        run.check_restored(run.simulation, run.state)
        run.check_all(pickle.loads(run.pickled))
        run.check_all(run.build)
        with morse.load(run.build, seed=3) as other:
            run.check_restored(other, State.from_bytes(run.content))
        there = elsewhere.apply(components.go_on, (name, run.carrier, run.content, ticks), {"real": real})
        assert there == run.end


@pytest.mark.parametrize("name", SHORT)
def test_equal_states_have_equal_futures(name: str, elsewhere: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    _check(name, 20, elsewhere, monkeypatch)


def _limited() -> None:
    from morse.builder import ATRV, Environment, MotionVW

    for number in range(4):
        robot, motion = ATRV(), MotionVW("motion")
        robot.name = f"r{number}"
        robot.translate(x=3.0 * number)
        robot.append(motion)
        motion.add_stream("socket", timeout=0.5)
    Environment("empty", fastmode=True)


def _command(simulation: Any, text: bytes) -> None:
    (manager,) = [one for one in simulation.observers if "r0.motion" in getattr(one, "streams", ())]
    manager.streams["r0.motion"][0].server.inbox.put(text)


def _hashes(simulation: Any, ticks: int) -> list[str]:
    hashes = []
    for _ in range(ticks):
        simulation.step()
        hashes.append(simulation.state_hash())
    return hashes


@pytest.mark.parametrize("sockets", [True, False])
def test_the_end_of_a_command_is_part_of_the_state(monkeypatch: pytest.MonkeyPatch, sockets: bool) -> None:
    """A robot whose controller is gone stops, also where its state is restored, and also without sockets there."""
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    with morse.load(_limited, seed=1, sockets=True) as first:
        first.step(10)
        recorder = InputRecorder(first)
        _command(first, b'{"v": 1.0}')
        first.step(10)
        state = first.save()
        later = _hashes(first, 60)
        assert first.r0.motion.data["v"] == 0.0
        recording = recorder.stop()
    with morse.load(_limited, seed=1, sockets=sockets) as second:
        second.restore(State.from_bytes(state.to_bytes()))
        assert second.r0.motion.data["v"] == 1.0
        assert second.state_hash() == state.hash()
        assert _hashes(second, 60) == later
    with morse.load(_limited, seed=1) as third:
        replayed: list[str] = []
        Replay(third, recording).run(lambda: replayed.append(third.state_hash()))
        assert replayed[10:] == later


def test_a_command_without_a_limit_does_not_end(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    with morse.load(_limited, seed=1, sockets=True) as simulation:
        _command(simulation, b'{"v": 1.0}')
        simulation.step(5)
        simulation.r0.motion.publish({"v": 1.0})  # the last command decides
        simulation.step(60)
        assert simulation.r0.motion.data["v"] == 1.0


def _since_the_epoch() -> None:
    from morse.builder import Environment, FakeRobot, Pose

    robot = FakeRobot("robot")
    robot.append(Pose("pose"))
    Environment("empty", fastmode=True).use_relative_time(False)


def test_the_time_since_the_epoch_is_part_of_the_state() -> None:
    with morse.load(_since_the_epoch, seed=1) as first, morse.load(_since_the_epoch, seed=1) as second:
        assert first.state_hash() != second.state_hash()
        first.step(3)
        second.restore(State.from_bytes(first.save().to_bytes()))
        assert _hashes(first, 5) == _hashes(second, 5)
        assert first.robot.pose.data["timestamp"] == second.robot.pose.data["timestamp"]


@pytest.mark.slow
@pytest.mark.parametrize("name", components.names())
def test_all_components_have_equal_futures(name: str, elsewhere: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    _check(name, 60, elsewhere, monkeypatch)


@pytest.mark.slow
@pytest.mark.parametrize("name", _SENSORS)
def test_all_sensors_with_delay_have_equal_futures(name: str, elsewhere: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    _check(name, 60, elsewhere, monkeypatch, real=True)
