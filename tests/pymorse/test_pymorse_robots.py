"""The representation of the simulation in Python."""

from collections.abc import Iterator

import pytest
from scripted_simulation import ScriptedSimulation

from pymorse import Component, Morse, Robot

ROBOTS = {
    "robot": {
        "robot.arm.pose": ([], "OUT"),
        "robot.arm": (["rest"], None),
        "robot.turret.head.camera": ([], "OUT"),
        "robot.motion": (["go-to"], "IN"),
        "robot.update": ([], "IN"),
    },
    "m": {"m.pose": ([], "OUT")},
    "m_002": {},
    "m_001": {"m_001.pose": ([], "OUT")},
    "rob-2.x~3": {},
    "time": {},
}


@pytest.fixture
def simu() -> Iterator[Morse]:
    with (
        ScriptedSimulation(
            ROBOTS, {"robot wag": 'SUCCESS "wagged"', "robot.motion go-to": "SUCCESS 1"}, {"robot": ["wag"]}
        ) as s,
        Morse("127.0.0.1", s.port) as simu,
    ):
        yield simu


def test_robots_are_attributes_under_names_that_python_allows(simu: Morse) -> None:
    assert simu.robots == ["robot", "m", "m_002", "m_001", "rob_2_x_3", "time"]
    assert isinstance(simu.rob_2_x_3, Robot)
    assert simu.rob_2_x_3.name == "rob-2.x~3"


def test_robots_of_a_loop_are_in_a_list(simu: Morse) -> None:
    assert simu.ms == [simu.m, simu.m_001, simu.m_002]


def test_a_robot_is_a_dictionary_of_its_components(simu: Morse) -> None:
    assert isinstance(simu.robot, dict)
    assert set(simu.robot) == {"arm", "turret", "motion", "update"}
    assert simu.robot["motion"] is simu.robot.motion
    assert all(isinstance(part, Component) for part in simu.robot.values())


def test_components_carry_components(simu: Morse) -> None:
    assert simu.robot.arm.pose.fqn == "robot.arm.pose"
    assert simu.robot.turret.head.camera.fqn == "robot.turret.head.camera"
    assert {"rest", "pose"} <= set(dir(simu.robot.arm))


def test_services_of_robots_and_components_are_methods(simu: Morse) -> None:
    assert simu.robot.wag().result(60) == "wagged"
    assert simu.robot.motion.go_to() == 1


def test_a_missing_component_is_a_key_error_and_names_the_nearest(simu: Morse) -> None:
    with pytest.raises(KeyError, match="did you mean 'motion'"):
        _ = simu.robot.moton
    with pytest.raises(KeyError, match="did you mean 'motion'"):
        _ = simu.robot["moton"]
    assert not hasattr(simu.robot, "moton")


def test_a_missing_robot_or_member_names_what_there_is(simu: Morse) -> None:
    with pytest.raises(AttributeError, match="did you mean 'robot'"):
        _ = simu.robt
    with pytest.raises(AttributeError, match="rest"):
        _ = simu.robot.arm.xyz
    with pytest.raises(KeyError, match="no robot 'nope'"):
        _ = simu["nope"]


def test_a_name_that_pymorse_uses_itself_is_reached_by_key(simu: Morse) -> None:
    assert simu["time"].fqn == "time"
    assert callable(simu.time)
    assert simu.robot["update"].fqn == "robot.update"


@pytest.mark.parametrize(
    ("member", "hint"),
    [
        ("simu.robot.motion.get()", "takes data: use publish"),
        ("simu.m.pose.publish({})", "sends data: use get"),
        ("simu.robot.arm.get()", r"arm.add_stream\('socket'\)"),
        ("simu.robot.arm.stream", r"arm.add_stream\('socket'\)"),
    ],
)
def test_using_a_stream_the_wrong_way_says_which_is_right(simu: Morse, member: str, hint: str) -> None:
    with pytest.raises(AttributeError, match=hint):
        eval(member)


def test_a_component_without_services_tells_how_it_gets_them(simu: Morse) -> None:
    with pytest.raises(AttributeError, match=r"m.pose has no 'set_speed'.*add pose.add_service\('socket'\)"):
        _ = simu.m.pose.set_speed
    with pytest.raises(AttributeError, match=r"has no 'subscrib'; did you mean 'subscribe'\?$"):
        _ = simu.m.pose.subscrib
    with pytest.raises(AttributeError, match=r"robot.motion has no 'speed'; there is: [^;]*$"):
        _ = simu.robot.motion.speed
