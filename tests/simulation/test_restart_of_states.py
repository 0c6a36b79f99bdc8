"""A restart gives components of MORSE the states of the launch again, and creates those anew that may have more."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import morse
from morse.core.modifier import AbstractModifier
from morse.verification.contract.contract_world import LogCapture, set_up
from morse.verification.contract.subjects import subjects

SPIDER = Path(__file__).parents[1] / "many" / "spider.xml"


@pytest.fixture
def journal() -> Iterator[LogCapture]:
    with LogCapture() as journal:
        yield journal


@pytest.mark.parametrize(
    "name", ["Odometry", "GPS", "VN100", "Sick", "Waypoint", "Gripper", "HumanPosture", "WheelEncoders", "VideoCamera"]
)
def test_a_restart_is_a_launch(name: str, journal: LogCapture) -> None:
    (subject,) = subjects(name)
    with set_up(subject, journal) as stand:
        simulation, component = stand.simulation, stand.component
        launched, first = simulation.state_hash(), stand.run(12)
        simulation.restart(seed=5)
        assert simulation.state_hash() != launched
        simulation.restart(seed=1)
        assert simulation.state_hash() == launched
        assert (stand.component is component) == (name != "VideoCamera"), "only its noise is made anew"
        assert stand.run(12) == first


def spider() -> None:
    from morse.builder import IMU, Armature, ArmaturePose, Environment, Pose, Robot

    robot = Robot(str(SPIDER), name="robot")
    legs = Armature("legs", armature_name="spider_joints")
    legs.control("position")
    legs.gains(40.0, 1.0)
    for part in (legs, Pose("pose"), IMU("imu")):
        robot.append(part)
    legs.append(ArmaturePose("angles"))
    Environment("empty")


@pytest.fixture
def walked() -> Iterator[tuple[Any, str, str]]:
    """A simulation after some ticks, the hash of its launch, and the hash after 9 ticks with a command."""
    with morse.load(spider, seed=3) as simulation:
        launched = simulation.state_hash()
        yield simulation, launched, walk(simulation)


def walk(simulation: Any) -> str:
    simulation.robot.legs.publish({"hip_a": 0.3, "knee_c": -0.2})
    simulation.step(9)
    return str(simulation.state_hash())


def parts(simulation: Any) -> list[object]:
    return [*simulation.context.robots.values(), *simulation.context.components.values()]


CHANGES = {
    "gains": lambda sim: sim.robot.legs.set_gains(5.0, 0.2),
    "control": lambda sim: sim.robot.legs.set_control("effort"),
    "property": lambda sim: sim.robot.legs.set_property("RotationSpeed", 0.1),
    "place": lambda sim: sim.robot.place([1.0, 2.0, 0.5]),
    "mass": lambda sim: sim.robot.set_mass(9.0),
    "command": lambda sim: sim.robot.legs.publish({"hip_a": 1.0}),
    "inactive": lambda sim: setattr(sim.context.components["robot.pose"], "active", False),
    "data": lambda sim: sim.context.components["robot.imu"].local_data.update(velocity=[1.0, 2.0, 3.0]),
    "object": lambda sim: sim.context.components["robot.imu"].bge_object.__setitem__("own", 1),
}


@pytest.mark.parametrize("change", CHANGES)
def test_nothing_of_before_is_left(change: str, walked: tuple[Any, str, str]) -> None:
    simulation, launched, after = walked
    before = parts(simulation)
    CHANGES[change](simulation)
    simulation.step(2)
    CHANGES[change](simulation)
    simulation.restart()
    assert simulation.state_hash() == launched
    assert [one is other for one, other in zip(parts(simulation), before, strict=True)] == [True] * len(before)
    assert walk(simulation) == after


class Double(AbstractModifier):
    """Changes nothing."""

    def modify(self) -> None:
        pass


ADDITIONS = {
    "method": lambda sim: setattr(sim.context.components["robot.pose"], "default_action", list),
    "function": lambda sim: sim.context.components["robot.pose"].output_functions.append(print),
    "input": lambda sim: sim.context.components["robot.legs"].input_functions.append(lambda _: False),
    "random": lambda sim: sim.context.random("mine"),
    "modifier": lambda sim: sim.context.components["robot.pose"].output_modifiers.append(
        Double(sim.context.components["robot.pose"], {})
    ),
    "spawn": lambda sim: sim.spawn("other", "Morsy", (3.0, 0.0, 0.0)),
}


@pytest.mark.parametrize("addition", ADDITIONS)
def test_what_somebody_has_added_goes_with_its_component(addition: str, walked: tuple[Any, str, str]) -> None:
    simulation, launched, after = walked
    before = parts(simulation)
    ADDITIONS[addition](simulation)
    simulation.restart()
    assert not set(map(id, parts(simulation))) & set(map(id, before))
    assert simulation.state_hash() == launched
    assert walk(simulation) == after
    renewed = parts(simulation)
    simulation.restart()
    assert (parts(simulation)[0] is renewed[0]) == (addition != "random"), "the new ones have states of a launch, too"
    assert simulation.state_hash() == launched
