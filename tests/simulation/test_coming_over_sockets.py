"""Robots are added and removed while clients are connected."""

from collections.abc import Callable
from typing import Any

import pytest

from pymorse import Morse, MorseServiceFailed

SCENE = """
    robot = ATRV()
    motion, pose = MotionVW(), Pose()
    robot.append(motion)
    robot.append(pose)
    robot.add_default_interface("socket")
    env = Environment("empty", fastmode=True)
"""


def newcomer() -> Any:
    from morse.builder import ATRV, MotionVW, Pose

    robot = ATRV()
    robot.append(MotionVW("motion"))
    robot.append(Pose("pose"))
    return robot


def streams(client: Any) -> set[str]:
    return set(client.rpc("simulation", "get_all_stream_ports"))


def test_streams_and_services_come_and_go(running: Callable[..., Any]) -> None:
    run = running(SCENE)
    simu = run.client
    simu.step(2)
    pose, before = simu.robot.pose, streams(simu)
    assert pose.last() is None
    for cycle in range(3):
        # the simulation is paused: only the requests have an effect
        run.simulation.spawn("late", newcomer, (5.0, 0.0, 0.1))
        assert streams(simu) == before | {"late.pose", "late.motion"}
        assert set(simu.rpc("simulation", "list_robots")) == {"robot", "late"}
        assert {robot["name"] for robot in simu.rpc("simulation", "details")["robots"]} == {"robot", "late"}
        with Morse("127.0.0.1", run.port) as second:
            second.late.pose.last()
            second.late.motion.publish({"v": 1.0})
            second.step(30)
            assert second.late.pose.last()["x"] > 5.2
            assert second.rpc("late.motion", "stop") is None
            run.simulation.delete("late")
            second.step()
            with pytest.raises(MorseServiceFailed):
                second.rpc("late.motion", "stop")
        assert streams(simu) == before
        simu.step()
        assert pose.last()["timestamp"] == pytest.approx((2 + 32 * (cycle + 1)) / 60)


def test_services_let_robots_come_and_refuse_what_cannot(running: Callable[..., Any]) -> None:
    simu = running(SCENE).client
    assert simu.rpc("simulation", "spawn", "late", "ATRV", [5.0, 0.0, 0.1]) == "late"
    assert simu.rpc("simulation", "save", "here") == "here"
    simu.rpc("simulation", "delete", "late")
    for name, kind, place in (
        ("robot", "ATRV", [0.0, 0.0, 0.0]),
        ("x", "ATVR", [0.0, 0.0, 0.0]),
        ("x", "ATRV", [0.0, 0.0]),
        ("a b", "ATRV", [0.0, 0.0, 0.0]),
        ("x", "../../etc/passwd", [0.0, 0.0, 0.0]),
        ("x" * 200, "ATRV", [0.0, 0.0, 0.0]),
    ):
        with pytest.raises(MorseServiceFailed):
            simu.rpc("simulation", "spawn", name, kind, place)
    with pytest.raises(MorseServiceFailed, match="no object 'late'"):
        simu.rpc("simulation", "delete", "late")
    assert simu.rpc("simulation", "list_robots") == ["robot"]
    simu.rpc("simulation", "restore", "here")
    assert simu.rpc("simulation", "list_robots") == ["robot", "late"]
    with pytest.raises(MorseServiceFailed, match="there is no state 'her'; did you mean 'here'"):
        simu.rpc("simulation", "restore", "her")
    with pytest.raises(MorseServiceFailed):
        simu.rpc("simulation", "save", "../up")
    simu.rpc("simulation", "reset")
    assert simu.rpc("simulation", "list_robots") == ["robot"]
    simu.step()
