"""Random sequences of everything that may happen to a simulation: the recorded run is the same again."""

import contextlib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import morse
from morse.builder import ATRV, Arucomarker, Environment, Human, Keyboard, Morsy, MotionVW, Pose, Sick, Waypoint
from morse.core.exceptions import MorseError
from morse.recording.recording import Recording
from morse.simulation import population
from morse.simulation.simulation import Simulation
from morse.verification.resimulation import repeat
from pymorse.errors import MorseServiceFailed
from tests.kit.effort import examples

pytestmark = pytest.mark.long


def scene() -> None:
    """Robots with a service that takes long, commands, keys, parts that move late, and noise."""
    robot = ATRV()
    goto, scan, marker = Waypoint("goto"), Sick("scan"), Arucomarker("marker")
    for part in (goto, scan, marker):
        robot.append(part)
    scan.noise(gaussian=0.01)
    scan.delay(0.05)
    morsy = Morsy()
    morsy.translate(0.0, 3.0, 0.2)
    motion, pose, keys = MotionVW("motion"), Pose("pose"), Keyboard("keys")
    for part in (keys, motion, pose):
        morsy.append(part)
    pose.noise(gaussian=0.01, bias_walk=0.01)
    person = Human()
    person.translate(0.3, 0.0, 0.0)
    Environment("empty")


def guest() -> Any:
    robot = Morsy()
    robot.append(MotionVW("motion"))
    return robot


class Run:
    """A simulation, and what happens to it."""

    def __init__(self, sim: Simulation, patch: pytest.MonkeyPatch) -> None:
        self.sim, self._patch = sim, patch
        self._states = [sim.save()]
        self._calls: list[Any] = []

    def do(self, kind: str, number: int) -> None:
        """One event; refusals are outcomes as well."""
        with contextlib.suppress(MorseError, MorseServiceFailed, ValueError, AttributeError):
            getattr(self, kind)(number)

    def step(self, number: int) -> None:
        self.sim.step(1 + number)

    def pause(self, number: int) -> None:
        (self.sim.pause if number % 2 else self.sim.resume)()

    def command(self, number: int) -> None:
        self.sim.morsy.motion.publish({"v": 0.1 * number, "w": 0.2})

    def marker(self, number: int) -> None:
        self.sim.robot.marker.publish({"z": 0.1 * number})

    def goto(self, number: int) -> None:
        self._calls.append(self.sim.robot.goto.goto(0.05 * number, 0.4, 0.0, 0.2, 1.0))

    def cancel(self, number: int) -> None:
        if self._calls:
            self._calls[number % len(self._calls)].cancel()

    def service(self, number: int) -> None:
        self.sim.rpc("simulation", "set_object_position", ["morsy", "nobody"][number % 2], [2.0, 3.0 + number, 0.3])

    def switch(self, number: int) -> None:
        (self.sim.activate if number % 2 else self.sim.deactivate)("morsy.motion")

    def keys(self, number: int) -> None:
        self.sim.set_controls(frozenset(["ArrowUp", "ArrowLeft"][: number % 3]))

    def spawn(self, number: int) -> None:
        self.sim.spawn(f"guest{number % 2}", ["Morsy", guest, "props/crates", "Nope"][number % 4], [-3.0, number, 0.3])

    def refused(self, number: int) -> None:
        """A server refuses the robot after all else was done."""

        def refuses(*_: object) -> None:
            raise MorseError("the server refuses this name")

        with self._patch.context() as patch:
            patch.setattr(population, "connect", refuses)
            self.sim.spawn("stranger", ["Morsy", guest][number % 2], [-3.0, -3.0, 0.3])

    def delete(self, number: int) -> None:
        self.sim.delete(["guest0", "guest1", "morsy", "nobody"][number % 4])

    def renew(self, number: int) -> None:
        self.sim.rpc("simulation", "restart_robot", ["robot", "morsy"][number % 2], number)

    def reset(self, number: int) -> None:
        self.sim.restart(number if number % 3 else None)

    def save(self, _number: int) -> None:
        self._states.append(self.sim.save())

    def restore(self, number: int) -> None:
        self.sim.restore(self._states[number % len(self._states)])


KINDS = [name for name in vars(Run) if not name.startswith("_") and name != "do"]


def attacked(before: list[tuple[str, int]], events: list[tuple[str, int]], seed: int, folder: Path) -> None:
    """Record a run of some events, and repeat it from its file and from memory."""
    path = folder / "run.mcap"
    path.unlink(missing_ok=True)
    with morse.load(scene, seed=seed) as sim, pytest.MonkeyPatch.context() as patch:
        run = Run(sim, patch)
        for event in before:
            run.do(*event)
        recorder, inputs = sim.record(path), sim.record_inputs()
        for event in events:
            run.do(*event)
        sim.step(2)
        recording = inputs.stop()
        recorder.stop()
        wanted = sim.save().fingerprints()
        sim.step(3)
        beyond = sim.save().fingerprints()
    with morse.load(scene) as again, Recording(path) as file:
        outcome = repeat(file, again)
        assert outcome.departure is None
        assert outcome.complete
        assert again.save().fingerprints() == wanted
        again.step(3)
        assert again.save().fingerprints() == beyond
    with morse.load(scene, seed=4) as again:
        again.replay(recording)
        assert again.save().fingerprints() == wanted


_events = st.tuples(st.sampled_from(KINDS), st.integers(0, 9))


@settings(max_examples=examples(24))
@given(st.lists(_events, max_size=5), st.lists(_events, min_size=1, max_size=16), st.integers(0, 99))
def test_a_random_run_is_the_same_again(
    tmp_path_factory: pytest.TempPathFactory, before: list[Any], events: list[Any], seed: int
) -> None:
    attacked(before, events, seed, tmp_path_factory.mktemp("run"))
