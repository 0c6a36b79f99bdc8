"""Commands, ticks and data in one call."""

import json
import socket

import pytest

from morse.builder import ATRV, Environment, MotionVW, Pose, Sick
from morse.testing.process import SimulationProcess
from pymorse import Morse, MorseServiceFailed


def scene() -> None:
    robot = ATRV("robot")
    for part in (Pose("pose"), MotionVW("motion"), Sick("scan")):
        robot.append(part)
    robot.add_default_interface("socket")
    Environment("empty", fastmode=True)


def test_commands_act_in_the_ticks_and_data_are_those_of_the_last_one(simu: Morse) -> None:
    robot = simu.robot
    before = simu.exchange(read=[robot.pose])[robot.pose]
    after = simu.exchange({robot.motion: {"v": 1.0, "w": 0.0}}, [robot.pose, "robot.scan"], n=30)
    assert after[robot.pose]["timestamp"] - before["timestamp"] == pytest.approx(0.5)
    assert after[robot.pose]["x"] - before["x"] == pytest.approx(0.5, abs=1e-6)
    assert len(after["robot.scan"]["range_list"]) == 181
    assert simu.time() == pytest.approx(after[robot.pose]["timestamp"])


def test_nothing_has_to_be_read_or_commanded(simu: Morse) -> None:
    begin = simu.time()
    assert simu.exchange(n=6) == {}
    assert simu.time() - begin == pytest.approx(0.1)


def test_the_command_stays_until_the_next_one(simu: Morse) -> None:
    pose = simu.robot.pose
    simu.exchange({simu.robot.motion: {"v": 1.0}})
    first = simu.exchange(read=[pose])[pose]["x"]
    assert simu.exchange(read=[pose], n=60)[pose]["x"] - first == pytest.approx(1.0, abs=1e-6)
    simu.exchange({simu.robot.motion: {"v": 0.0}})
    first = simu.exchange(read=[pose])[pose]["x"]
    assert simu.exchange(read=[pose], n=60)[pose]["x"] == pytest.approx(first, abs=1e-6)


@pytest.mark.parametrize(
    ("commands", "read", "said"),
    [
        ({"robot.motio": {"v": 1.0}}, [], "robot.motion"),
        ({"robot.pose": {"x": 1.0}}, [], "not an actuator"),
        ({"robot.motion": {"v": "fast"}}, [], "'v' is 'fast', expected a number"),
        ({"robot.motion": {"speed": 1.0}}, [], "speed"),
        ({"robot.motion": 5}, [], "expected"),
        ({"robot.motion": {"v": 1.0}}, ["robot.posee"], "robot.pose"),
        ([1], [], "'commands' is an object"),
        ({}, [3], "no component 3"),
        ({}, [["robot.pose"]], "no component"),
    ],
)
def test_what_does_not_fit_is_refused_and_no_time_passes(
    simu: Morse, commands: object, read: list[object], said: str
) -> None:
    begin = simu.time()
    with pytest.raises((MorseServiceFailed, TypeError), match=said):
        simu.rpc("simulation", "exchange", commands, read)
    assert simu.time() == begin
    assert simu.rpc("simulation", "exchange", {}, ["robot.motion"])["robot.motion"]["v"] == 0.0


def test_any_client_can_do_it_in_one_line(process: SimulationProcess, simu: Morse) -> None:
    with socket.create_connection(("127.0.0.1", process.port), timeout=60) as wire, wire.makefile("rb") as lines:
        wire.sendall(b'1 simulation exchange [{"robot.motion": {"v": 0.0}}, ["robot.pose", "robot.motion"]]\n')
        number, status, value = lines.readline().split(b" ", 2)
    assert (number, status) == (b"1", b"SUCCESS")
    assert list(json.loads(value)) == ["robot.pose", "robot.motion"]
