"""Victims in a cone, and their healing."""

from __future__ import annotations

import math

import pytest

import morse

SCRIPT = """
robot = FakeRobot()
robot.translate(z=0.5)
sar = SearchAndRescue()
{setting}
robot.append(sar)
motion = MotionXYW()
robot.append(motion)
{victims}
env = Environment("empty", fastmode=True)
"""


def victim(name, x, y, more=""):
    return f"{name} = Victim()\n{name}.translate({x}, {y}, 0.0)\n{more}\n"


@pytest.fixture
def scene(tmp_path):
    made = []

    def make(victims, setting=""):
        path = tmp_path / f"scene{len(made)}.py"
        path.write_text("from morse.builder import *\n" + SCRIPT.format(victims=victims, setting=setting))
        made.append(morse.load(path))
        made[-1].step(12)
        return made[-1]

    yield make
    for simulation in made:
        simulation.close()


def seen(simulation):
    return set(simulation.robot.sar.data["victim_dict"])


def test_what_is_said_of_a_victim(scene):
    simulation = scene(victim("bob", 5.0, 1.0))
    bob = simulation.robot.sar.data["victim_dict"]["bob"]
    assert bob["coordinate"] == pytest.approx({"x": 5.0, "y": 1.0, "z": 0.0}, abs=0.1)
    assert (bob["requirements"], bob["severity"]) == ([1, 2, 3], 10)
    assert simulation.robot.sar.get_victim_severity().result() == 10
    assert simulation.robot.sar.get_victim_requirements().result() == [1, 2, 3]
    assert simulation.robot.sar.get_robot_abilities().result() == [1, 2]


def test_a_cone_of_sixty_degrees_and_ten_metres(scene):
    # angle (degrees) and distance (m)
    places = {"ahead": (0, 8.5), "left": (29, 5), "right": (-31, 5), "far": (5, 10.5), "behind": (180, 3)}
    victims = "".join(
        victim(name, r * math.cos(math.radians(a)), r * math.sin(math.radians(a))) for name, (a, r) in places.items()
    )
    # half a metre below the sensor: at a horizontal angle of 29 degrees, the angle is 29.5
    assert seen(scene(victims)) == {"ahead", "left"}
    assert seen(scene(victims, "sar.properties(Angle=64.0, Distance=11.0)")) == {"ahead", "left", "right", "far"}


def test_healing_takes_ten_measurements(scene):
    simulation = scene(victim("bob", 1.5, 0.0))
    healing = simulation.robot.sar.heal()
    severities = []
    for _ in range(10):
        simulation.step(10)  # six measurements per second
        victims = simulation.robot.sar.data["victim_dict"]
        severities.append(victims["bob"]["severity"] if victims else 0)
        assert healing.done() == (len(severities) == 10)
    assert severities == [9, 8, 7, 6, 5, 4, 3, 2, 1, 0]
    assert healing.result() == "bob"
    simulation.step(20)
    assert seen(simulation) == set()


@pytest.mark.parametrize(
    ("victims", "setting", "reason"),
    [
        (victim("bob", 2.5, 0.0), "", "farther than Heal_range"),
        (victim("bob", 1.5, 0.0), "sar.properties(Abilities='7')", "requires one of the abilities"),
        (victim("bob", -1.5, 0.0), "", "detects no victim"),
    ],
)
def test_healing_that_fails_at_once(scene, victims, setting, reason):
    healing = scene(victims, setting).robot.sar.heal()
    with pytest.raises(Exception, match=reason):
        healing.result(timeout=1.0)


def test_healing_that_is_cancelled(scene):
    simulation = scene(victim("bob", 1.5, 0.0))
    healing = simulation.robot.sar.heal()
    simulation.step(30)
    simulation.cancel(healing)
    simulation.step(60)
    assert simulation.robot.sar.data["victim_dict"]["bob"]["severity"] == 7


def test_healing_that_loses_its_victim(scene):
    simulation = scene(victim("bob", 1.5, 0.0))
    healing = simulation.robot.sar.heal()
    simulation.robot.motion.publish({"x": -2.0, "y": 0.0, "w": 0.0})
    simulation.step(60)
    with pytest.raises(Exception, match="'bob' is no longer within reach"):
        healing.result(timeout=1.0)


def test_only_one_healing_at_a_time(scene):
    simulation = scene(victim("bob", 1.5, 0.0))
    first = simulation.robot.sar.heal()
    simulation.step(1)
    with pytest.raises(Exception, match="already running 'heal', which cannot be interrupted"):
        simulation.robot.sar.heal()
    simulation.step(120)
    assert first.result() == "bob"


def test_a_victim_heals_itself(scene):
    simulation = scene(victim("bob", 1.5, 0.0))
    simulation.rpc("bob", "heal")
    simulation.step(20)
    assert seen(simulation) == set()


def test_requirements_that_are_no_numbers(scene):
    odd = "bob.properties(Requirements='1, two,, 3', Severity='bad')"
    simulation = scene(victim("bob", 1.5, 0.0, odd))
    bob = simulation.robot.sar.data["victim_dict"]["bob"]
    assert (bob["requirements"], bob["severity"]) == ([1, 3], 0)


def test_healing_goes_on_from_a_saved_state(scene):
    simulation = scene(victim("bob", 1.5, 0.0))
    simulation.robot.sar.heal()
    simulation.step(30)
    state = simulation.save()
    simulation.step(60)
    simulation.restore(state)
    simulation.step(30)
    assert simulation.robot.sar.data["victim_dict"]["bob"]["severity"] == 4
