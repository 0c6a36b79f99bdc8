"""The same test, over sockets and in the process of the test."""

import textwrap
from pathlib import Path
from typing import Any

import pytest

pytest_plugins = ["pytester"]


def scene() -> None:
    from morse.builder import ATRV, Environment, MotionVW, Pose

    robot = ATRV("robot")
    robot.append(MotionVW("motion"))
    robot.append(Pose("pose"))
    robot.add_default_interface("socket")
    env = Environment("empty", fastmode=True)  # noqa: F841


@pytest.mark.parametrize("sockets", [True, False])
def test_the_same_source(simulate: Any, sockets: bool) -> None:
    simu = simulate(scene, "--seed", "3", sockets=sockets)
    simu.pause()
    simu.robot.pose.last()
    simu.step(30)
    start = simu.robot.pose.last()["x"]
    simu.robot.motion.publish({"v": 1.0})
    simu.step(60)
    assert simu.robot.pose.last()["x"] - start == pytest.approx(1.0, abs=0.06)
    assert simu.robot.motion.stop().result() is None
    assert simu.rpc("simulation", "list_robots") == ["robot"]


INNER = """
    import pytest
    from morse.builder import *

    def scene():
        robot = ATRV()
        motion = MotionVW()
        robot.append(motion)
        robot.add_default_interface("socket")
        env = Environment("empty", fastmode=True)

    @pytest.mark.parametrize("field", ["vv", "v"])
    def test_over_sockets(simulate, field):
        simu = simulate(scene)
        simu.pause()
        simu.robot.motion.publish({field: "fast"})
        simu.step(2)

    def test_over_sockets_but_lenient(simulate):
        simu = simulate(scene, strict=False)
        simu.pause()
        simu.robot.motion.publish({"vv": 1.0})
        simu.step(2)

    def test_in_the_process(simulate):
        simu = simulate(scene, sockets=False)
        simu.robot.motion.publish({"vv": 1.0})

    def test_an_option_that_there_is_not(simulate):
        simulate(scene, "--headless", sockets=False)

    def test_an_error_in_the_process(simulate):
        simu = simulate(scene, sockets=False)
        simu.robot.motion.component.default_action = None
        simu.step()
"""


def test_wrong_commands_and_errors_fail_the_test(pytester: pytest.Pytester) -> None:
    pytester.makeconftest('pytest_plugins = ["morse.testing.fixtures"]')
    Path(pytester.path / "test_inner.py").write_text(textwrap.dedent(INNER), encoding="utf-8")
    outcome = pytester.runpytest_subprocess("-p", "no:cacheprovider")
    outcome.assert_outcomes(passed=3, failed=3, errors=3)
    outcome.stdout.fnmatch_lines(["*the simulation reported an error:*robot.motion*refused*'vv'*did you mean 'v'*"])
    outcome.stdout.fnmatch_lines(["E*TypeError: 'NoneType' object is not callable", "E*robot.motion failed in tick 1*"])
