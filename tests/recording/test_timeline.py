"""A recorded run can be set to any of its ticks, with the original state."""

import random
from pathlib import Path
from typing import Any

import pytest
from recorded import SCRIPT, drive

import morse
from morse.core.observer import Observer
from morse.launch.recorded_run import inputs_of
from morse.recording.recording import Recording
from morse.simulation.recordings import timeline as module
from morse.simulation.recordings.timeline import SimulatedTimeline
from morse.simulation.simulation import Simulation


class _Hashes:
    """The state after each tick, and after each reset."""

    def __init__(self, sim: Simulation) -> None:
        self._sim, self.found = sim, [sim.state_hash()]

    def __getattr__(self, name: str) -> Any:
        return lambda *_: None

    def after_tick(self) -> None:
        self.found.append(self._sim.state_hash())


def recorded(tmp_path: Path, *, reset: bool) -> tuple[Path, list[str]]:
    script, path = tmp_path / "scene.py", tmp_path / "run.mcap"
    script.write_text(SCRIPT)
    with morse.load(script, seed=4) as sim:
        hashes = _Hashes(sim)
        observer: Observer = hashes  # type: ignore[assignment]
        sim.observers.append(observer)
        with sim.record(path):
            drive(sim, 50)
            if reset:
                sim.restart(8)
            drive(sim, 40)
    return path, hashes.found


def arrive(timeline: SimulatedTimeline, target: int) -> None:
    for _ in range(10_000):
        if timeline.approach(target):
            return
    raise AssertionError(f"{target} is never reached")


@pytest.mark.parametrize("reset", [False, True])
@pytest.mark.parametrize("most", [3, 600])
def test_every_position_has_the_state_of_the_run(
    tmp_path: Path, reset: bool, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_MOST", most)
    monkeypatch.setattr(module, "_EVERY", 7)
    path, wanted = recorded(tmp_path, reset=reset)
    assert len(wanted) == 91
    with Recording(path) as recording, morse.load(tmp_path / "scene.py") as sim:
        timeline = SimulatedTimeline(sim, inputs_of(recording), 90)
        rng = random.Random(1)
        for target in [0, 90, 0, 5, 45, *(rng.randrange(91) for _ in range(20)), *range(60, 40, -1)]:
            arrive(timeline, target)
            assert timeline.position == target
            # commands that the actuators have not processed yet are in neither state
            assert sim.state_hash() == wanted[target], target
        arrive(timeline, 90)
        assert timeline.at_end
        arrive(timeline, 10**9)
        assert timeline.position == 90
