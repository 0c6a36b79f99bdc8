"""Victims in a cone, and their healing."""

import math

import pytest

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
def scene(load):
    def start(victims, setting=""):
        simulation = load(SCRIPT.format(victims=victims, setting=setting))
        simulation.step(12)
        return simulation

    return start


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
    places = {"ahead": (0, 8.5), "left": (29, 5), "right": (-38, 5), "far": (5, 10.6), "behind": (180, 3)}
    victims = "".join(
        victim(name, r * math.cos(math.radians(a)), r * math.sin(math.radians(a))) for name, (a, r) in places.items()
    )
    assert seen(scene(victims)) == {"ahead", "left"}
    assert seen(scene(victims, "sar.properties(Angle=78.0, Distance=11.0)")) == {"ahead", "left", "right", "far"}


def test_healing_takes_ten_measurements(scene):
    simulation = scene(victim("bob", 1.5, 0.0))
    healing = simulation.robot.sar.heal()
    for count in range(10):
        simulation.step(10)  # six measurements per second
        assert healing.done() == (count == 9)
    assert healing.result() == "bob"
    simulation.step(20)
    # the robot has the abilities 1 and 2
    bob = simulation.robot.sar.data["victim_dict"]["bob"]
    assert (bob["requirements"], bob["severity"]) == ([3], 10)


def test_a_victim_without_requirements_is_healed_and_stays_in_the_list(scene):
    simulation = scene(victim("bob", 1.5, 0.0), "sar.properties(Abilities='3,2,1')")
    healing = simulation.robot.sar.heal()
    simulation.step(130)
    assert healing.result() == "bob"
    bob = simulation.robot.sar.data["victim_dict"]["bob"]
    assert (bob["requirements"], bob["severity"]) == ([], 0)
    assert simulation.context.world.game_object("bob")["Injured"] is True


def test_a_part_of_the_shape_in_the_cone_is_enough(scene):
    # the origin, at the feet, is below the cone; the head is inside
    simulation = scene(victim("bob", 1.0, 0.0), "sar.translate(z=1.0)")
    assert math.degrees(math.atan2(1.5, 1.0)) > 30.0
    assert seen(simulation) == {"bob"}
    assert simulation.robot.sar.data["victim_dict"]["bob"]["coordinate"]["z"] == pytest.approx(0.0, abs=0.1)


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
    assert simulation.robot.sar.data["victim_dict"]["bob"]["requirements"] == [1, 2, 3]


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
    bob = simulation.context.component("robot.sar").local_data
    simulation.step(60)
    assert bob["victim_dict"]["bob"]["requirements"] == [1, 2, 3]
    simulation.step(20)
    assert bob["victim_dict"]["bob"]["requirements"] == [3]
