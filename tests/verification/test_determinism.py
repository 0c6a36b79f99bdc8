"""The same scene, seed and inputs give bit-identical results."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import verification_scenes as scenes

from morse.simulation.options import RunOptions
from morse.testing.process import SimulationProcess
from morse.verification.verify import verify
from pymorse import Morse

pytestmark = pytest.mark.long

HERE = str(Path(__file__).parent)
CROWD_TICKS, WHEEL_TICKS = 240, 240


def options_of(script: str, tmp_path: Path, **more: object) -> RunOptions:
    path = tmp_path / "scene.py"
    path.write_text(script, encoding="utf-8")
    return RunOptions(str(path), source_paths=[HERE], **more)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("script", "ticks"),
    [
        pytest.param(scenes.CROWD, CROWD_TICKS, id="crowd", marks=pytest.mark.slow),
        pytest.param(scenes.WHEELS, WHEEL_TICKS, id="wheels"),
    ],
)
def test_processes_restarts_views_clients_and_the_wall_clock_change_nothing(
    script: str, ticks: int, tmp_path: Path
) -> None:
    assert verify(options_of(script, tmp_path), ticks, clients=10, pages=3) == []


def drive(simu: Morse, rounds: int) -> list[str]:
    """Commands in lockstep; the state after every tick."""
    states = []
    for n in range(rounds):
        simu.r0.motion.publish({"v": 1.0 + 0.1 * (n % 7), "w": 0.5 - 0.2 * (n % 5)})
        simu.step()
        states.append(simu.rpc("simulation", "state_hash"))
    return states


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Callable[..., Morse]]:
    script = tmp_path / "driven.py"
    script.write_text(scenes.DRIVEN, encoding="utf-8")
    processes: list[SimulationProcess] = []

    def started(*options: str) -> Morse:
        process = SimulationProcess(script, tmp_path / f"log{len(processes)}", options=options)
        processes.append(process)
        process.wait_initialized()
        simu = Morse("127.0.0.1", process.port)
        simu.pause()
        return simu

    yield started
    for process in processes:
        process.stop()


def test_commands_in_lockstep_give_the_same_states(start: Callable[..., Morse]) -> None:
    """In another process, after a restart, with and without other clients, with a view."""
    runs = []
    for options in (("--headless", "--seed", "5"), ("--view-port", "0", "--no-browser", "--seed", "6")):
        with start(*options) as simu:
            for others in (0, 10):
                simu.reset(seed=5)
                listeners = [Morse(simu.host, simu.port) for _ in range(others)]
                for listener in listeners:
                    for robot in (listener.r0, listener.r1):
                        robot.pose.subscribe(lambda _: None)
                runs.append(drive(simu, 60))
                for listener in listeners:
                    listener.close()
            simu.reset(seed=6)
            assert drive(simu, 5)[-1] != runs[0][4]  # the noise has another seed
    assert len(set(runs[0])) == 60
    assert all(run == runs[0] for run in runs)
