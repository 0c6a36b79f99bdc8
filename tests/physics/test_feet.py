"""Driven robots stand on feet."""

import math

import numpy as np
import pytest
from worlds import box, ground, node, robot, run, world

from morse.physics.gliding.feet import stance, trimmed
from morse.scene import CollisionShape, ShapeKind
from morse.scene.extent import corners

ORIGIN, UPRIGHT = np.zeros(3), np.eye(3)


def test_a_box_stands_on_its_corners():
    stand = stance(corners(box(0.6, 0.4, 0.5), ORIGIN, UPRIGHT))
    assert stand.floor == pytest.approx(-0.25)
    assert (stand.feet[:, 2] - stand.radius).tolist() == pytest.approx([-0.25] * 4)
    outer = np.abs(stand.feet[:, :2]) + stand.radius
    assert outer == pytest.approx(np.tile([0.3, 0.2], (4, 1)))


def test_feet_of_a_round_robot_stay_under_it():
    stand = stance(corners(CollisionShape(ShapeKind.CYLINDER, (0.2, 0.15)), ORIGIN, UPRIGHT))
    assert (np.hypot(*stand.feet[:, :2].T) + stand.radius <= 0.2 + 1e-9).all()


def test_a_ball_has_no_feet():
    assert stance(corners(CollisionShape(ShapeKind.SPHERE, (0.2,)), ORIGIN, UPRIGHT)) is None


@pytest.mark.parametrize("shape", [box(0.6, 0.4, 0.5), CollisionShape(ShapeKind.CYLINDER, (0.2, 0.25))])
def test_a_trimmed_hull_keeps_its_top(shape):
    stand = stance(corners(shape, ORIGIN, UPRIGHT))
    cut = corners(trimmed(shape, ORIGIN, UPRIGHT, stand), ORIGIN, UPRIGHT)
    assert cut[:, 2].max() == pytest.approx(0.25)
    assert cut[:, 2].min() == pytest.approx(-0.25 + stand.clearance)


def test_a_robot_crosses_the_seam_of_two_floors():
    body = robot(at=(-1, 0.1, 0.25))
    w = world(
        node("Left", box(10, 10, 1), at=(-5, 0, -0.5)),
        node("Right", box(10, 10, 1), at=(5, 0, -0.5)),
        body,
        robots=[body],
    )
    heights = []
    obj = w.game_object("robot")

    def drive():
        obj.drive((1, 0, 0), (0, 0, 0), ground=True)
        heights.append(obj.worldPosition.z)

    run(w, 2.0, drive)
    assert obj.worldPosition.x == pytest.approx(1.0, abs=0.01)
    assert np.ptp(heights[10:]) < 1e-3


def test_a_robot_drives_up_a_ramp():
    tilt = math.radians(10)
    ramp = node("Ramp", box(4, 4, 0.2), at=(2.5, 0, 0.0), turned=(0, -tilt, 0))
    body = robot()
    w = world(ground(), ramp, body, robots=[body])
    run(w, 4.0, lambda: w.game_object("robot").drive((0.7, 0, 0), (0, 0, 0), ground=True))
    x, _, z = w.game_object("robot").worldPosition
    assert x > 2.5
    # its centre stays 0.25 m above the surface, which is 0.1 m above the middle of the slab
    assert z == pytest.approx((x - 2.5) * math.tan(tilt) + (0.1 + 0.25) / math.cos(tilt), abs=5e-3)
    assert w.game_object("robot").worldOrientation.to_euler().y == pytest.approx(-tilt, abs=0.01)


def test_a_tall_robot_that_runs_into_a_low_kerb_does_not_fall_over():
    body = robot(shape=box(0.6, 0.6, 1.6), at=(0, 0, 0.8))
    w = world(ground(), node("Kerb", box(0.5, 4, 0.3), at=(1.5, 0, 0.15)), body, robots=[body])
    run(w, 5.0, lambda: w.game_object("robot").drive((1, 0, 0), (0, 0, 0), ground=True))
    assert w.game_object("robot").worldPosition.x == pytest.approx(0.95, abs=0.03)
    assert w.game_object("robot").worldOrientation[2][2] > 0.99
