"""Controllers that are programs over a socket, in lock-step."""

import sys

import pytest

from morse.plugins.falsify.scenario import read_scenario

pytestmark = pytest.mark.long

SCENARIO = """
import sys
from morse.many import Scenario, uniform

def scene():
    from morse.builder import Environment, MotionVW, Pose, Robot
    robot = Robot(name="robot")
    for part in (MotionVW("motion"), Pose("pose")):
        robot.append(part)
    robot.add_default_interface("socket")
    Environment("empty")

scenario = Scenario(
    scene, program=[sys.executable, {program!r}, "{{speed}}"], duration=1.0, speed=uniform(0.1, 2.0), timeout=60
)
scenario.always("robot.pose.x < 0.6")
"""
CONTROLLER = """
import sys
from pymorse import Morse

with Morse() as simu:
    for _ in range(30):
        pose = simu.robot.pose.get_local_data().result()
        simu.robot.motion.set_speed(float(sys.argv[1]), 0.0)
        simu.step()
"""


def scenario_with(tmp_path, controller):
    (tmp_path / "controller.py").write_text(controller)
    file = tmp_path / "scenario.py"
    file.write_text(SCENARIO.format(program=str(tmp_path / "controller.py")))
    return read_scenario(file)


def test_a_program_steps_each_run_and_two_run_at_once(tmp_path):
    scenario = scenario_with(tmp_path, CONTROLLER)
    found = scenario.falsify(tmp_path / "r", runs=12, workers=2)
    # 30 ticks are half a second
    assert {row["ticks"] for row in found.rows} == {30}
    assert found.smallest.parameters["speed"] == pytest.approx(1.2, abs=0.06)
    assert found.smallest.repeats is True
    assert scenario.once(speed=0.5)["hash"] == scenario.once(speed=0.5)["hash"]


@pytest.mark.parametrize(
    ("controller", "message"),
    [
        ("raise SystemExit('no map')", "ProgramError: the program has ended with status 1: ['no map']"),
        ("1 / 0", "ZeroDivisionError: division by zero"),
        ("import os; os.kill(os.getpid(), 9)", "the program has ended with status -9"),
    ],
)
def test_a_program_that_fails_is_a_failure(tmp_path, controller, message):
    row = scenario_with(tmp_path, controller).once()
    assert message in row["error"]
    assert row["where"] == ""


def test_a_program_goes_on_for_the_duration_at_most(tmp_path):
    endless = CONTROLLER.replace("range(30)", "iter(int, 1)")
    row = scenario_with(tmp_path, endless).once(speed=0.2)
    assert (row["error"], row["ticks"]) == ("", 60)


def test_a_program_that_hangs_is_ended(tmp_path):
    scenario = scenario_with(tmp_path, "import time\ntime.sleep(10000)")
    scenario.study().timeout = 3.0
    assert scenario.once()["error"].startswith("RunTimeout")


def test_what_cannot_be_started(tmp_path):
    scenario = scenario_with(tmp_path, CONTROLLER)
    scenario.monitored._program = ("no-such-program-anywhere",)
    assert "'no-such-program-anywhere' cannot be started" in scenario.once()["error"]
    assert sys.executable
