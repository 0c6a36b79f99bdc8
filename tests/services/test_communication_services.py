"""The pseudo component ``communication``: distances between robots, and visibility."""

import pytest

from morse.builder import ATRV, Cube, Environment
from pymorse import Morse, MorseServiceFailed


def scene():
    for name, x, y in (("anna", 0.0, 0.0), ("bert", 3.0, 4.0), ("carl", -5.0, 0.0)):
        robot = ATRV(name)
        robot.translate(x, y, 0.0)
    wall = Cube("Wall")
    wall.scale = (0.1, 1.0, 1.0)
    wall.location = (-2.5, 0.0, 1.0)
    wall._bpy_object.game.physics_type = "STATIC"
    Environment("empty", fastmode=True)


def ask(simu: Morse, *robots: object) -> list[object]:
    return simu.rpc("communication", "distance_and_view", *robots)


def test_distance_and_view_in_the_open(simu: Morse) -> None:
    assert ask(simu, "anna", "bert") == [pytest.approx(5.0, abs=1e-3), True]
    assert ask(simu, "bert", "anna") == [pytest.approx(5.0, abs=1e-3), True]


def test_a_wall_is_in_the_way(simu: Morse) -> None:
    assert ask(simu, "anna", "carl") == [pytest.approx(5.0, abs=1e-3), False]
    assert ask(simu, "carl", "anna") == [pytest.approx(5.0, abs=1e-3), False]


def test_a_robot_is_in_the_way(simu: Morse) -> None:
    simu.rpc("simulation", "set_object_position", "bert", [-10.0, 0.0, 0.1])
    assert ask(simu, "bert", "anna")[1] is False


def test_a_robot_sees_itself(simu: Morse) -> None:
    assert ask(simu, "anna", "anna") == [0.0, True]


@pytest.mark.parametrize(
    "robots", [("anna", "bertt"), ("ana", "bert"), ("anna", None), ("anna", 3), ("anna", ["bert"])]
)
def test_unknown_robots_are_refused(simu: Morse, robots: tuple[object, ...]) -> None:
    with pytest.raises(MorseServiceFailed):
        ask(simu, *robots)
    with pytest.raises(MorseServiceFailed, match="Robot bertt unknown; did you mean 'bert'"):
        ask(simu, "bertt", "anna")
