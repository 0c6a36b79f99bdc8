"""The page goes back in time: with a running simulation, and a page on the protocol level."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from driving_page import DrivingPage

import morse
from morse.viewer import page_messages as page

SCENE = """
from morse.builder import *
robot = ATRV()
robot.translate(0, 0, 0.3)
motion = MotionVW()
robot.append(motion)
pose = Pose()
robot.append(pose)
pose.alter("Noise")
wheels = Odometry()
robot.append(wheels)
env = Environment("indoors-1/boxes", fastmode=True)
"""


@pytest.fixture
def shown(tmp_path: Path) -> Iterator[DrivingPage]:
    script = tmp_path / "scene.py"
    script.write_text(SCENE)
    with morse.load(script, view="web", seed=4) as simulation:
        looking = DrivingPage(simulation)
        yield looking
        looking.close()


def test_the_whole_simulation_goes_back_and_takes_the_same_way_again(shown: DrivingPage) -> None:
    simulation, witness = shown.simulation, shown.witness
    shown.send(page.Command(1, "robot.motion", {"v": 1.0, "w": 0.3}))
    shown.send(page.Play())
    shown.until(lambda: len(shown.times) >= 5)
    shown.send(page.Pause())
    shown.until(lambda: simulation.paused)
    last, goal = simulation.ticks, shown.times[2]
    shown.send(page.Rewind(goal + 0.1))
    shown.until(lambda: simulation.ticks < last)
    assert simulation.time() == pytest.approx(goal)
    assert simulation.paused
    shown.send(page.Play())
    shown.until(lambda: simulation.ticks > last)
    assert len(witness.again) >= 60
    assert not witness.different


def test_step_back_goes_to_the_tick_before_where_ticks_were_taken_one_by_one(shown: DrivingPage) -> None:
    simulation, witness = shown.simulation, shown.witness
    shown.send(page.Play())
    shown.until(lambda: shown.times)
    shown.send(page.Pause())
    shown.until(lambda: simulation.paused)
    for _ in range(5):
        before = simulation.ticks
        shown.send(page.Step(1))
        shown.until(lambda before=before: simulation.ticks == before + 1 and len(witness.hashes) >= before)  # type: ignore[misc]
    last = simulation.ticks
    for back in range(1, 5):
        shown.send(page.StepBack())
        shown.until(lambda back=back: simulation.ticks == last - back)  # type: ignore[misc]
    shown.until(lambda: last - 4 in witness.again)
    assert not witness.different
