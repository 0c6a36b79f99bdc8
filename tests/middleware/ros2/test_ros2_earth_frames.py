"""Frames of messages in the axes of the earth are in the tree of frames."""

import math
from collections.abc import Callable
from typing import Any

import pytest

from morse.helpers.transformation import Transformation3d
from morse.mathutils.rotations import rotation_from_quaternion
from morse.mathutils.rotations import turn as rotated

#: the X axis of the world points north
NORTH = "env.properties(longitude=1.4, latitude=43.6, altitude=100.0, angle_against_north=1.5707963267948966)"


def test_velocities_of_gps_are_in_a_frame_of_the_tree(start: Callable[..., Any]) -> None:
    simulation, desk = start('gps = GPS("gps"); gps.level("raw"); robot.append(gps)', NORTH)
    simulation.step(2)
    frame = desk.last("/robot/gps/vel").header.frame_id
    found = {t.child_frame_id: t for t in desk.last("/tf_static").transforms}
    assert found[frame].header.frame_id == "map"
    turn = found[frame].transform.rotation
    # east is the -Y axis of a world whose X axis points north
    east = (1.0 - 2.0 * turn.z**2, 2.0 * turn.w * turn.z)
    assert east == pytest.approx((0.0, -1.0), abs=1e-12)
    assert math.hypot(turn.x, turn.y) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("given", [NORTH, "env.properties(longitude=-70.0, latitude=-33.0, altitude=500.0)"])
def test_the_earth_is_the_parent_of_the_map(start: Callable[..., Any], given: str) -> None:
    # by REP 105; the pose in earth-centred coordinates is that of the tree
    simulation, desk = start('spot = Pose("spot"); spot.alter("ECEF"); robot.append(spot)', given)
    simulation.step(2)
    measured = desk.last("/robot/spot")
    assert measured.header.frame_id == "earth"
    (found,) = [t for t in desk.last("/tf_static").transforms if t.child_frame_id == "map"]
    assert found.header.frame_id == "earth"
    place, turn = found.transform.translation, found.transform.rotation
    pose = Transformation3d()
    pose.set_pose((place.x, place.y, place.z), rotation_from_quaternion(turn.w, turn.x, turn.y, turn.z))
    world = simulation.world.objects_by_name["robot.spot"].world_pose()[0]
    there, axes = pose.get_pose()
    expected = [one + moved for one, moved in zip(there, rotated(axes, world), strict=True)]
    position = measured.pose.position
    assert [position.x, position.y, position.z] == pytest.approx(expected, abs=1e-6)
    assert math.hypot(*there) == pytest.approx(6.37e6, rel=0.01)


def test_the_grid_is_below_the_map(start: Callable[..., Any]) -> None:
    simulation, desk = start(
        'spot = Pose("spot"); spot.alter("UTM"); robot.append(spot)',
        'env.properties(UTMXOffset=377000.0, UTMYOffset="4827000.5", UTMZOffset=100.0)',
    )
    simulation.step(2)
    measured = desk.last("/robot/spot")
    assert measured.header.frame_id == "utm"
    (found,) = [t for t in desk.last("/tf_static").transforms if t.child_frame_id == "utm"]
    assert found.header.frame_id == "map"
    origin, place = found.transform.translation, measured.pose.position
    world = simulation.world.objects_by_name["robot.spot"].world_pose()[0]
    seen = [place.x + origin.x, place.y + origin.y, place.z + origin.z]
    assert seen == pytest.approx(list(world), abs=1e-6)
    assert origin.y == -4827000.5
