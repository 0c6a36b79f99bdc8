"""Collision and bumper against the geometry of obstacles."""

import math

import pytest
from messages import published

from morse.core.kinds import bind
from morse.core.streams.kind_stream import KindStream

SCRIPT = """
robot = {robot}()
motion = MotionXYW()
motion.properties(ControlType="Position")
robot.append(motion)
sensor = {kind}()
sensor.translate(x={ahead}, z=0.4)
{setting}
robot.append(sensor)
wall = Cube("Wall")
wall.scale = (0.5, 5.0, 1.0)
wall.location = (3.5, 0, 1.0)
wall._bpy_object.game.physics_type = "{physics}"
wall.properties(Hard=True)
{more}
env = Environment("empty", fastmode=True)
"""


def scene(simulate, kind="Collision", robot="FakeRobot", setting="", ahead=0.8, physics="STATIC", more=""):
    return simulate(
        SCRIPT.format(kind=kind, robot=robot, setting=setting, ahead=ahead, physics=physics, more=more), sockets=False
    )


def drive(simulation, distance):
    """Forward, at 0.6 m/s: a centimetre per tick."""
    motion = simulation.context.component("robot.motion")
    motion.local_data["x"] = 0.6 if distance > 0 else -0.6
    simulation.sleep(abs(distance) / 0.6)
    motion.local_data["x"] = 0.0
    simulation.sleep(0.05)
    return simulation


@pytest.mark.parametrize("robot", ["FakeRobot", "ATRV"])
def test_the_default_cube_touches_a_wall_two_centimetres_ahead(simulate, robot):
    simulation = scene(simulate, robot=robot)
    messages = published(simulation.context.component("robot.sensor"))
    # the face of the wall is at 3 m, that of the cube at 0.82 m
    drive(simulation, 2.15)
    assert messages == []
    assert simulation.context.component("robot.sensor").local_data["collision"] is False
    drive(simulation, 0.06)
    assert messages[-1]["collision"] is True
    assert messages[-1]["objects"] == "Wall"
    message = bind(simulation.context.component("robot.sensor"))[0].gather()
    assert (message.touching, message.names) == (True, ("Wall",))
    count = len(messages)
    drive(simulation, -0.1)
    sent = len(messages) - count
    assert sent < 10
    drive(simulation, -0.1)
    assert len(messages) - count == sent
    data = simulation.context.component("robot.sensor").local_data
    assert (data["collision"], data["objects"]) == (False, "")


def test_its_own_robot_is_not_felt(simulate):
    simulation = scene(simulate, robot="ATRV", ahead=0.0)
    simulation.sleep(0.5)
    assert simulation.context.component("robot.sensor").local_data["collision"] is False


def test_it_adds_nothing_to_the_robot(simulate):
    plain = simulate('robot = ATRV()\nrobot.translate(z=0.5)\nenv = Environment("empty")', sockets=False)
    plain.sleep(1.0)
    felt = scene(simulate, robot="ATRV", setting="sensor.scale = (2, 2, 2)\nrobot.translate(z=0.5)")
    felt.sleep(1.0)
    a, b = plain.context.component("robot"), felt.context.component("robot")
    assert a.bge_object.mass == b.bge_object.mass
    assert list(a.bge_object.localInertia) == list(b.bge_object.localInertia)
    assert a.position_3d.z == pytest.approx(b.position_3d.z, abs=1e-3)


def test_a_larger_body(simulate):
    simulation = scene(simulate, setting="sensor.scale = (1.0, 0.1, 0.1)")
    drive(simulation, 1.1)
    assert simulation.context.component("robot.sensor").local_data["collision"] is False
    assert drive(simulation, 0.2).context.component("robot.sensor").local_data["objects"] == "Wall"


def test_only_objects_with_a_property(simulate):
    more = "post = Cylinder('Post')\npost.location = (2.0, 0, 0)\npost.scale = (.1, .1, 1)\n"
    more += "post._bpy_object.game.physics_type = 'STATIC'\n"
    simulation = scene(simulate, setting="sensor.properties(only_objects_with_property='Hard')", more=more)
    anything = scene(simulate, more=more)
    assert drive(simulation, 1.2).context.component("robot.sensor").local_data["collision"] is False
    assert drive(anything, 1.2).context.component("robot.sensor").local_data["objects"] == "Post"
    assert drive(simulation, 1.0).context.component("robot.sensor").local_data["objects"] == "Wall"


def test_another_robot_is_named(simulate):
    more = "other = ATRV()\nother.translate(x=2.0)\n"
    # the hull of an ATRV begins 0.57 m behind its centre
    simulation = drive(scene(simulate, more=more), 0.55)
    assert simulation.context.component("robot.sensor").local_data["collision"] is False
    assert drive(simulation, 0.15).context.component("robot.sensor").local_data["objects"] == "other"


def test_what_does_not_collide_is_not_felt(simulate):
    simulation = scene(simulate, physics="NO_COLLISION")
    assert drive(simulation, 2.7).context.component("robot.sensor").local_data["collision"] is False


def test_the_inside_of_a_thing_is_felt(simulate):
    simulation = scene(simulate)
    assert drive(simulation, 2.7).context.component("robot.sensor").local_data["objects"] == "Wall"


def test_what_hands_put_somewhere_is_felt(simulate):
    simulation = scene(simulate)
    simulation.sleep(0.1)
    wall = simulation.world.game_object("Wall")
    wall.worldPosition = [1.3, 0.0, 1.0]
    simulation.sleep(0.05)
    assert simulation.context.component("robot.sensor").local_data["objects"] == "Wall"
    wall.worldPosition = [1.4, 0.0, 1.0]
    simulation.sleep(0.05)
    assert simulation.context.component("robot.sensor").local_data["collision"] is False


def test_a_bumper_says_so_at_each_measurement(simulate):
    simulation = scene(simulate, kind="Bumper", robot="ATRV", ahead=0.58)
    messages = published(simulation.context.component("robot.sensor"))
    drive(simulation, 2.3)
    assert {message["collision"] for message in messages} == {False}
    # the bar is in front of the hull, and the wall stops the robot
    drive(simulation, 0.3)
    assert messages[-1]["objects"] == "Wall"
    assert len(messages) == round(simulation.time() * 60)
    assert drive(simulation, -0.2).context.component("robot.sensor").local_data["collision"] is False


def test_the_travel_of_a_bumper(simulate):
    simulation = scene(simulate, kind="Bumper", ahead=0.5, setting="sensor.properties(Travel=0.1)")
    assert drive(simulation, 2.35).context.component("robot.sensor").local_data["collision"] is False
    assert drive(simulation, 0.06).context.component("robot.sensor").local_data["collision"] is True


def test_things_that_come_and_go(simulate):
    simulation = scene(simulate)
    simulation.sleep(0.1)
    drive(simulation, 2.25)
    simulation.delete("Wall")
    simulation.sleep(0.1)
    assert simulation.context.component("robot.sensor").local_data["collision"] is False


def test_message_kinds_say_once_that_it_has_ended(simulate):
    simulation = scene(simulate)
    said = []

    class Stream(KindStream):
        def __init__(self):
            pass

        def default(self, ci=None):
            said.append(bind(ci)[0].gather().touching)
            return False

    simulation.context.component("robot.sensor").output_functions.append(Stream().default)
    drive(simulation, 2.25)
    drive(simulation, -0.3)
    assert said.count(False) == 1
    assert said[-1] is False
    assert len(said) > 3


# -- victims in a cone, and their healing ----------------------------------------------------------

SEARCH_AND_RESCUE_SCRIPT = """
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
def search_and_rescue_scene(load):
    def start(victims, setting=""):
        simulation = load(SEARCH_AND_RESCUE_SCRIPT.format(victims=victims, setting=setting))
        simulation.step(12)
        return simulation

    return start


def seen(simulation):
    return set(simulation.robot.sar.data["victim_dict"])


def test_what_is_said_of_a_victim(search_and_rescue_scene):
    simulation = search_and_rescue_scene(victim("bob", 5.0, 1.0))
    bob = simulation.robot.sar.data["victim_dict"]["bob"]
    assert bob["coordinate"] == pytest.approx({"x": 5.0, "y": 1.0, "z": 0.0}, abs=0.1)
    assert (bob["requirements"], bob["severity"]) == ([1, 2, 3], 10)
    assert simulation.robot.sar.get_victim_severity().result() == 10
    assert simulation.robot.sar.get_victim_requirements().result() == [1, 2, 3]
    assert simulation.robot.sar.get_robot_abilities().result() == [1, 2]


def test_a_cone_of_sixty_degrees_and_ten_metres(search_and_rescue_scene):
    # angle (degrees) and distance (m)
    places = {"ahead": (0, 8.5), "left": (29, 5), "right": (-38, 5), "far": (5, 10.6), "behind": (180, 3)}
    victims = "".join(
        victim(name, r * math.cos(math.radians(a)), r * math.sin(math.radians(a))) for name, (a, r) in places.items()
    )
    assert seen(search_and_rescue_scene(victims)) == {"ahead", "left"}
    assert seen(search_and_rescue_scene(victims, "sar.properties(Angle=78.0, Distance=11.0)")) == {
        "ahead",
        "left",
        "right",
        "far",
    }


def test_healing_takes_ten_measurements(search_and_rescue_scene):
    simulation = search_and_rescue_scene(victim("bob", 1.5, 0.0))
    healing = simulation.robot.sar.heal()
    for count in range(10):
        simulation.step(10)  # six measurements per second
        assert healing.done() == (count == 9)
    assert healing.result() == "bob"
    simulation.step(20)
    # the robot has the abilities 1 and 2
    bob = simulation.robot.sar.data["victim_dict"]["bob"]
    assert (bob["requirements"], bob["severity"]) == ([3], 10)


def test_a_victim_without_requirements_is_healed_and_stays_in_the_list(search_and_rescue_scene):
    simulation = search_and_rescue_scene(victim("bob", 1.5, 0.0), "sar.properties(Abilities='3,2,1')")
    healing = simulation.robot.sar.heal()
    simulation.step(130)
    assert healing.result() == "bob"
    bob = simulation.robot.sar.data["victim_dict"]["bob"]
    assert (bob["requirements"], bob["severity"]) == ([], 0)
    assert simulation.context.world.game_object("bob")["Injured"] is True


def test_a_part_of_the_shape_in_the_cone_is_enough(search_and_rescue_scene):
    # the origin, at the feet, is below the cone; the head is inside
    simulation = search_and_rescue_scene(victim("bob", 1.0, 0.0), "sar.translate(z=1.0)")
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
def test_healing_that_fails_at_once(search_and_rescue_scene, victims, setting, reason):
    healing = search_and_rescue_scene(victims, setting).robot.sar.heal()
    with pytest.raises(Exception, match=reason):
        healing.result(timeout=1.0)


def test_healing_that_is_cancelled(search_and_rescue_scene):
    simulation = search_and_rescue_scene(victim("bob", 1.5, 0.0))
    healing = simulation.robot.sar.heal()
    simulation.step(30)
    simulation.cancel(healing)
    simulation.step(60)
    assert simulation.robot.sar.data["victim_dict"]["bob"]["requirements"] == [1, 2, 3]


def test_healing_that_loses_its_victim(search_and_rescue_scene):
    simulation = search_and_rescue_scene(victim("bob", 1.5, 0.0))
    healing = simulation.robot.sar.heal()
    simulation.robot.motion.publish({"x": -2.0, "y": 0.0, "w": 0.0})
    simulation.step(60)
    with pytest.raises(Exception, match="'bob' is no longer within reach"):
        healing.result(timeout=1.0)


def test_only_one_healing_at_a_time(search_and_rescue_scene):
    simulation = search_and_rescue_scene(victim("bob", 1.5, 0.0))
    first = simulation.robot.sar.heal()
    simulation.step(1)
    with pytest.raises(Exception, match="already running 'heal', which cannot be interrupted"):
        simulation.robot.sar.heal()
    simulation.step(120)
    assert first.result() == "bob"


def test_a_victim_heals_itself(search_and_rescue_scene):
    simulation = search_and_rescue_scene(victim("bob", 1.5, 0.0))
    simulation.rpc("bob", "heal")
    simulation.step(20)
    assert seen(simulation) == set()


def test_requirements_that_are_no_numbers(search_and_rescue_scene):
    odd = "bob.properties(Requirements='1, two,, 3', Severity='bad')"
    simulation = search_and_rescue_scene(victim("bob", 1.5, 0.0, odd))
    bob = simulation.robot.sar.data["victim_dict"]["bob"]
    assert (bob["requirements"], bob["severity"]) == ([1, 3], 0)


def test_healing_goes_on_from_a_saved_state(search_and_rescue_scene):
    simulation = search_and_rescue_scene(victim("bob", 1.5, 0.0))
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
