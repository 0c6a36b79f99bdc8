"""Robots that fall below the world are named once."""

import math
from pathlib import Path

import pytest

from morse.core.observer import SHOWN
from morse.simulation.reviews import FallenError
from morse.simulation.simulation import Simulation
from tests.kit.scenes import Load


def falls(caplog: pytest.LogCaptureFixture) -> list[str]:
    return [line for line in caplog.messages if " falls: " in line]


def test_a_robot_beyond_the_edge_of_the_floor_is_named_once(load: Load, caplog: pytest.LogCaptureFixture) -> None:
    # the floor of 'empty' ends at 20 m (spec: a slab of 40 m x 40 m)
    simulation = load(
        """
        on, off = ATRV(), ATRV()
        on.translate(19, 0, 0.1)
        off.translate(21, 0, 0.1)
        env = Environment("empty", fastmode=True)
        """,
        sockets=False,
    )
    simulation.step(120)
    (line,) = falls(caplog)
    assert line.startswith("off falls: it is at z = -")
    assert "below the floor of 'empty'" in line
    simulation.restart()
    simulation.step(120)
    assert len(falls(caplog)) == 2


def test_a_world_without_floor_is_named(load: Load, caplog: pytest.LogCaptureFixture, tmp_path: Path) -> None:
    """A world of Gazebo whose ground is a model of an online library, which is not there."""
    world = tmp_path / "bare.sdf"
    world.write_text(
        '<sdf version="1.9"><world name="w"><include><uri>https://fuel.gazebosim.org/1.0/a/models/Ground</uri></include>'
        '<light type="directional" name="sun"/></world></sdf>'
    )
    simulation = load(f"robot = ATRV()\nenv = Environment({str(world)!r}, fastmode=True)\n", sockets=False)
    simulation.step(180)
    (line,) = falls(caplog)
    assert line.endswith("bare.sdf' has no floor; F11 or the service simulation.reset begins again")


def test_a_robot_without_collision_shapes_falls_through_the_floor_and_this_is_said(
    load: Load, caplog: pytest.LogCaptureFixture, tmp_path: Path
) -> None:
    file = tmp_path / "ghost.urdf"
    file.write_text(
        '<robot name="ghost"><link name="b"><visual><geometry><sphere radius="0.1"/></geometry></visual><inertial>'
        '<mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
    )
    simulation = load(f"robot = Robot({str(file)!r})\nenv = Environment('empty', fastmode=True)\n", sockets=False)
    simulation.step(180)
    (line,) = falls(caplog)
    assert "; it has no collision shapes that could stand on one" in line


def test_a_fall_onto_the_floor_is_not_reported(load: Load, caplog: pytest.LogCaptureFixture) -> None:
    simulation = load(
        """
        robot = ATRV()
        robot.translate(0, 0, 30)
        env = Environment("empty", fastmode=True)
        """,
        sockets=False,
    )
    simulation.step(180)
    assert falls(caplog) == []


EDGE = """
    robot = ATRV()
    robot.translate(21, 0, 0.1)
    teleport = Teleport()
    robot.append(teleport)
    env = Environment("empty", fastmode=True{})
    """


def at_the_edge(load: Load, options: str = "") -> Simulation:
    simulation = load(EDGE.format(options), sockets=False)
    simulation.deactivate("robot.teleport")  # it holds the robot
    return simulation


def test_it_is_an_event_of_the_simulation_and_of_the_page(load: Load, caplog: pytest.LogCaptureFixture) -> None:
    simulation = at_the_edge(load)
    simulation.step(60)
    assert simulation.failures == ()
    simulation.step(60)
    (failure,) = simulation.failures
    assert (failure.kind, failure.part, failure.consequence) == ("fallen", "robot", "has left the world")
    # 10 m and the height of the start below the floor, s = g t^2 / 2, and at most two reviews of half a second later
    assert math.sqrt(2 * 10.1 / 9.81) <= failure.time <= math.sqrt(2 * 10.1 / 9.81) + 1.0
    assert failure.where.endswith("scene.py:3"), "the line that created it"
    (record,) = [one for one in caplog.records if " falls: " in one.getMessage()]
    assert not getattr(record, SHOWN, False), "the page shows it in words: nothing else of the page does"


@pytest.mark.parametrize("back", ["reset", "restart", "place", "teleport", "restart_robot"])
def test_who_is_back_may_leave_again(load: Load, back: str) -> None:
    simulation = at_the_edge(load)
    simulation.step(240)
    assert len(simulation.failures) == 1, "once in each life"
    if back == "place":
        simulation.place("robot", (21.0, 0.0, 0.1, 0.0, 0.0, 0.0))
    elif back == "teleport":
        simulation.activate("robot.teleport")
        simulation.robot.teleport.publish({"x": 21.0, "y": 0.0, "z": 0.1})
        simulation.step(60)
        simulation.deactivate("robot.teleport")
    elif back == "restart_robot":
        simulation.restart_robot("robot")
        simulation.deactivate("robot.teleport")
    else:
        getattr(simulation, back)()
        simulation.deactivate("robot.teleport")
    simulation.step(60)
    assert len(simulation.failures) == 1, "it is back"
    simulation.step(180)
    assert [failure.kind for failure in simulation.failures] == ["fallen", "fallen"]


def test_it_is_an_error_if_the_scene_says_so(load: Load) -> None:
    simulation = at_the_edge(load, ', fallen="error"')
    with pytest.raises(FallenError, match="robot has left the world: it is at z = -1"):  # noqa: PT012
        for _ in range(180):
            simulation.step()
    simulation.step(60)
    simulation.restart()
    simulation.deactivate("robot.teleport")
    with pytest.raises(FallenError):
        simulation.run(10.0, math.inf)


@pytest.mark.parametrize("value", ["raise", "Error", 3, None])
def test_other_values_are_refused(load: Load, value: object) -> None:
    with pytest.raises(Exception, match="Environment\\(fallen\\)"):
        load(EDGE.format(f", fallen={value!r}"), sockets=False)


def test_a_world_without_a_floor(load: Load, tmp_path: Path) -> None:
    lamp = '<geom type="box" size=".1 .1 .1" pos="0 0 50" contype="0" conaffinity="0"/>'
    (tmp_path / "nothing.xml").write_text(f"<mujoco><worldbody>{lamp}</worldbody></mujoco>")
    simulation = load(
        f"""
        high, low = ATRV(), ATRV()
        high.translate(0, 0, 30)
        low.translate(5, 0, -40)
        env = Environment({str(tmp_path / "nothing.xml")!r}, fastmode=True)
        """,
        sockets=False,
    )
    simulation.step(240)
    assert [failure.part for failure in simulation.failures] == ["low"], "the lowest shape is that of the low robot"
    simulation.step(120)
    assert [failure.part for failure in simulation.failures] == ["low", "high"]
    assert all("nothing.xml' has no floor" in failure.cause for failure in simulation.failures)
    assert simulation.clock.time < 5.0 + math.sqrt(2 * 80 / 9.81)


@pytest.mark.parametrize(("robot", "speed"), [("Submarine", -3.0), ("RMax", -8.0), ("Quadrotor", -5.0)])
def test_robots_that_fly_or_dive_do_not_fall(load: Load, robot: str, speed: float) -> None:
    simulation = load(
        f"""
        robot = {robot}()
        robot.translate(25, 0, 1)
        env = Environment("empty", fastmode=True)
        """,
        sockets=False,
    )
    for _ in range(600):
        simulation.context.robots["robot"].bge_object.set_velocity((0.0, 0.0, speed), None)
        simulation.step()
    assert simulation.context.robots["robot"].bge_object.world_pose()[0][2] < -25.0
    assert simulation.failures == ()


def test_nothing_falls_without_gravity(load: Load) -> None:
    simulation = load(EDGE.format("") + "env.set_gravity(0)\n", sockets=False)
    for _ in range(300):
        simulation.context.robots["robot"].bge_object.set_velocity((0.0, 0.0, -20.0), None)
        simulation.step()
    assert simulation.failures == ()
