"""Distances along one ray and in a cone, by geometry."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.core.kinds import bind
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
