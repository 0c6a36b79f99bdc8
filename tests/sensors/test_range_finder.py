"""Distances along one ray and in a cone, by geometry."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.core.exceptions import MorseRPCTypeError
from morse.core.kinds import bind
from morse.core.validation import Arguments
from morse.sensors.range_finder import cone_of_rays

SCRIPT = """
robot = FakeRobot()
robot.translate(z=1.0)
finder = {kind}()
{setting}
robot.append(finder)
wall = Cube("Wall")
wall.scale = (0.5, 5.0, 1.0)
wall.location = ({wall} + 0.5, 0, 1.0)
wall._bpy_object.game.physics_type = "STATIC"
post = Sphere("Post")
post.scale = (0.1, 0.1, 0.1)
post.location = ({post}, 1.0)
post._bpy_object.game.physics_type = "STATIC"
env = Environment("empty", fastmode=True)
"""
FAR = "50, 50"


def finder(simulate, kind="RangeFinder", setting="", wall=3.0, post=FAR):
    simulation = simulate(SCRIPT.format(kind=kind, setting=setting, wall=wall, post=post), sockets=False)
    simulation.sleep(0.2)
    return simulation.context.component("robot.finder")


def distance(*args, **kwargs):
    return finder(*args, **kwargs).local_data["distance"]


def test_a_wall_ahead(simulate):
    assert distance(simulate) == pytest.approx(3.0, abs=1e-6)
    assert distance(simulate, setting="finder.rotate(z=math.radians(30))") == pytest.approx(
        3.0 / math.cos(math.radians(30)), abs=1e-6
    )


def test_too_far_and_too_near(simulate):
    assert distance(simulate, wall=10.5) == math.inf
    assert distance(simulate, setting="finder.properties(min_range=3.5)") == -math.inf


def test_one_ray_passes_what_is_beside_it(simulate):
    assert distance(simulate, post="1.5, 0.3") == pytest.approx(3.0, abs=1e-6)


def test_a_cone_meets_what_is_beside_its_axis(simulate):
    # the post is 0.1 m in radius, its centre 10 degrees off the axis: within the cone of 15 degrees to each side
    place = f"{1.5 * math.cos(math.radians(10))}, {1.5 * math.sin(math.radians(10))}"
    seen = distance(simulate, kind="UltrasonicRangeFinder", post=place)
    # rays need not pass through its centre; neighbours are 3 degrees apart, at most 2 degrees from it
    missed = 1.5 * math.sin(math.radians(2))
    nearest = 1.5 * math.cos(math.radians(2)) - math.sqrt(0.1**2 - missed**2)
    assert 1.4 - 1e-6 <= seen <= nearest + 1e-3


def test_a_cone_does_not_meet_what_is_outside(simulate):
    place = f"{1.5 * math.cos(math.radians(25))}, {1.5 * math.sin(math.radians(25))}"
    assert distance(simulate, kind="UltrasonicRangeFinder", post=place) == pytest.approx(3.0, abs=1e-6)


def test_as_a_message_kind(simulate):
    message = bind(finder(simulate, kind="UltrasonicRangeFinder"))[0].gather()
    assert (message.min, message.max, message.radiation) == (0.02, 4.0, "ultrasound")
    assert message.fov == pytest.approx(math.radians(30))
    assert message.distance == pytest.approx(3.0, abs=1e-5)


def test_properties_changed_while_it_runs(simulate):
    simulation = simulate(SCRIPT.format(kind="RangeFinder", setting="", wall=12.0, post="3, 0.6"), sockets=False)
    simulation.sleep(0.1)
    sensor = simulation.context.component("robot.finder")
    assert sensor.local_data["distance"] == math.inf
    sensor.set_property("range", 20.0)
    simulation.sleep(0.1)
    assert simulation.context.component("robot.finder").local_data["distance"] == pytest.approx(12.0, abs=1e-6)
    sensor.set_property("cone", 40.0)
    simulation.sleep(0.1)
    assert 2.9 < simulation.context.component("robot.finder").local_data["distance"] < 3.1


@pytest.mark.parametrize("setting", ["range=0.0", "cone=-1.0", "cone=360.0", "resolution=0.0", "radiation='x-ray'"])
def test_what_is_no_range_finder(simulate, setting):
    with pytest.raises(Exception, match=f"'{setting.split('=')[0]}' of RangeFinder"):
        finder(simulate, setting=f"finder.properties({setting})")


@given(st.floats(0.0, 180.0), st.floats(0.5, 90.0), st.floats(0.0, 1.0), st.floats(0.0, math.tau))
def test_every_direction_of_a_cone_is_near_a_ray(angle, resolution, share, turned):
    rays = cone_of_rays(angle, resolution)
    half = math.radians(angle) / 2
    assert all(math.isclose(math.hypot(*ray), 1.0) for ray in rays)
    assert all(math.acos(min(1.0, ray[0])) <= half + 1e-6 for ray in rays)
    tilt = half * share
    there = (math.cos(tilt), math.sin(tilt) * math.cos(turned), math.sin(tilt) * math.sin(turned))
    nearest = max(sum(a * b for a, b in zip(ray, there, strict=True)) for ray in rays)
    # half the diagonal of a square whose sides are the resolution
    assert math.degrees(math.acos(min(1.0, nearest))) <= resolution * math.sqrt(0.5) + 1e-3


# -- the radar altimeter: heights above the surface below ------------------------------------------

RADAR_ALTIMETER_SCRIPT = """
table = Cube("Table")
table.scale = (1, 1, 0.5)
table.location = (3, 0, 0.5)
table._bpy_object.game.physics_type = "STATIC"
floor = Cube("Floor")
floor.scale = (9, 9, 0.5)
floor.location = (0, 0, -0.5)
floor._bpy_object.game.physics_type = "STATIC"
robot = FakeRobot()
robot.translate({x}, 0, {z})
robot.rotate(0.4, 1.0, 0.2)
radar = RadarAltimeter()
{setting}
robot.append(radar)
env = Environment("empty", fastmode=True)
"""


def height(simulate, x=0.0, z=5.0, setting=""):
    simulation = simulate(RADAR_ALTIMETER_SCRIPT.format(x=x, z=z, setting=setting), sockets=False)
    simulation.sleep(0.1)
    return simulation.context.component("robot.radar").local_data["z"]


def test_height_above_floor_and_furniture_in_any_attitude(simulate):
    assert height(simulate, z=5.0) == pytest.approx(5.0, abs=1e-6)
    assert height(simulate, x=3.0, z=5.0) == pytest.approx(4.0, abs=1e-6)


def test_infinite_when_there_is_nothing_within_reach(simulate):
    assert height(simulate, z=31.0) == math.inf
    assert height(simulate, z=29.0) == pytest.approx(29.0, abs=1e-6)
    assert height(simulate, z=31.0, setting="radar.properties(MaxRange=50.0)") == pytest.approx(31.0, abs=1e-6)
    assert height(simulate, x=40.0) == math.inf


def test_a_reach_changed_while_it_runs(simulate):
    simulation = simulate(RADAR_ALTIMETER_SCRIPT.format(x=0, z=5.0, setting=""), sockets=False)
    simulation.context.component("robot.radar").set_property("MaxRange", 4.0)
    simulation.sleep(0.1)
    assert simulation.context.component("robot.radar").local_data["z"] == math.inf


@pytest.mark.parametrize("reach", [0.0, -1.0])
def test_a_reach_of_nothing_is_refused(simulate, reach):
    with pytest.raises(Exception, match=r"'MaxRange' of RadarAltimeter is .*, expected a number from 0\.001 m upward"):
        height(simulate, setting=f"radar.properties(MaxRange={reach})")


# -- the proximity sensor --------------------------------------------------------------------------

PROXIMITY_SCRIPT = """
lamp = Cube("Lamp")
lamp.location = (3, 4, 0)
lamp.properties(Shining=True)
for i, x in enumerate((0, 10, 29, 31)):
    robot = FakeRobot(f"r{i}")
    robot.translate(x, 0, 1)
    if i == 0:
        near = Proximity("near")
        near.translate(0, 0, 5)
        robot.append(near)
env = Environment("empty", fastmode=True)
"""


@pytest.fixture
def near(simulate):
    simulation = simulate(PROXIMITY_SCRIPT, sockets=False)

    def measured():
        simulation.sleep(0.2)
        return simulation.context.component("r0.near")

    return measured


def test_robots_within_30_metres_of_the_own_robot(near):
    data = near().local_data
    assert data["near_objects"] == pytest.approx({"r1": 10.0, "r2": 29.0})
    assert data["near_robots"] == data["near_objects"]


def test_reach_and_tag_may_be_changed(near):
    sensor = near()
    sensor.set_range(100)
    assert set(near().local_data["near_objects"]) == {"r1", "r2", "r3"}
    sensor.set_tracked_tag("Shining")
    assert near().local_data["near_objects"] == pytest.approx({"Lamp": math.hypot(3, 4, 1)})
    sensor.set_range(5.0)
    assert near().local_data["near_objects"] == {}


@pytest.mark.parametrize("bad", [-1.0, math.nan, "far", None, True])
def test_a_reach_that_is_none_is_refused(near, bad):
    sensor = near()
    with pytest.raises(MorseRPCTypeError, match=r"'range' is a number from 0 to .* m"):
        Arguments(sensor.set_range, "set_range").check([bad])
    assert set(near().local_data["near_objects"]) == {"r1", "r2"}


@pytest.mark.parametrize("bad", [None, 5])
def test_a_tag_that_is_none_is_refused(near, bad):
    with pytest.raises(MorseRPCTypeError, match="set_tracked_tag: 'tag' is a string"):
        Arguments(near().set_tracked_tag, "set_tracked_tag").check([bad])
    with pytest.raises(MorseRPCTypeError, match="set_tracked_tag: 'tag' is the name of a property"):
        near().set_tracked_tag("")


def test_twelve_measurements_a_second(simulate):
    simulation = simulate(PROXIMITY_SCRIPT, sockets=False)
    times = set()
    for _ in range(60):
        simulation.step()
        times.add(simulation.context.component("r0.near").local_data["timestamp"])
    assert len(times - {0.0}) == 12
