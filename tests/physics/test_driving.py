"""Bodies that follow velocity commands."""

import math

import numpy as np
import pytest
from worlds import box, ground, node, rigid, robot, run, world

from morse.physics.gliding.feet import stance, trimmed
from morse.scene import CollisionShape, Node, PhysicsType, ShapeKind
from morse.scene.extent import corners

V, W = 0.5, 0.3


def on_circle(v, w, t):
    return v / w * math.sin(w * t), v / w * (1 - math.cos(w * t))


def yaw(obj):
    m = obj.worldOrientation
    return math.atan2(m[1][0], m[0][0])


def circling(*, position):
    body = robot()
    w = world(ground(), body, robots=[body])
    run(w, 4.0, lambda: w.game_object("robot").drive((V, 0, 0), (0, 0, W), position=position, ground=True))
    return w.game_object("robot")


@pytest.mark.parametrize("position", [False, True])
def test_speed_and_rate_give_a_circle_of_radius_v_over_w(position):
    obj = circling(position=position)
    assert tuple(obj.worldPosition[:2]) == pytest.approx(on_circle(V, W, 4.0), abs=1e-3)
    assert yaw(obj) == pytest.approx(W * 4.0, abs=1e-3)
    assert obj.worldPosition.z == pytest.approx(0.25, abs=2e-3)


def test_a_velocity_is_kept_and_a_shift_leaves_none():
    moving, shifted = circling(position=False), circling(position=True)
    assert tuple(moving.localLinearVelocity[:2]) == pytest.approx((V, 0), abs=2e-3)
    assert tuple(shifted.worldLinearVelocity[:2]) == pytest.approx((0, 0), abs=1e-9)


@pytest.mark.parametrize("position", [False, True])
def test_a_wall_stops_a_driven_robot(position):
    body = robot()
    w = world(ground(), body, node("Wall", box(0.2, 4, 1), at=(1.1, 0, 0.5)), robots=[body])
    run(w, 4.0, lambda: w.game_object("robot").drive((1, 0, 0), (0, 0, 0), position=position, ground=True))
    x = w.game_object("robot").worldPosition.x
    assert x == pytest.approx(0.75, abs=0.02)


def test_a_driven_robot_pushes_a_box_up_to_the_wall():
    body = robot()
    w = world(
        ground(),
        body,
        rigid("Box", box(0.3, 0.3, 0.3), at=(0.6, 0, 0.15), mass=2.0),
        node("Wall", box(0.2, 4, 1), at=(2.1, 0, 0.5)),
        robots=[body],
    )
    run(w, 6.0, lambda: w.game_object("robot").drive((0.5, 0, 0), (0, 0, 0), ground=True))
    assert w.game_object("Box").worldPosition.x == pytest.approx(1.85, abs=0.02)
    assert w.game_object("robot").worldPosition.x == pytest.approx(1.45, abs=0.03)


def test_a_robot_with_friction_is_slower_than_one_without():
    smooth, rough = robot("smooth"), robot("rough", at=(0, 5, 0.25), friction=0.5)
    w = world(ground(), smooth, rough, robots=[smooth, rough])

    def drive():
        for name in ("smooth", "rough"):
            w.game_object(name).drive((1, 0, 0), (0, 0, 0), ground=True)

    run(w, 2.0, drive)
    assert w.game_object("smooth").worldPosition.x == pytest.approx(2.0, abs=0.01)
    # the floor, with friction 0.5, reduces the speed by mu 0.5 g dt in each half of a tick: 3/4 of it on average
    assert w.game_object("rough").worldPosition.x == pytest.approx(2.0 * (1 - 0.75 * 0.5 * 0.5 * 9.81 / 60), abs=0.01)


@pytest.mark.parametrize("friction", [0.0, 0.3, 2.0, 5.0, 50.0])
def test_no_friction_tips_a_driven_robot_over(friction):
    body = robot(friction=friction, shape=box(0.4, 0.4, 1.2), at=(0, 0, 0.6))
    w = world(ground(), body, robots=[body])
    obj = w.game_object("robot")
    run(w, 3.0, lambda: obj.drive((1, 0, 0), (0, 0, 0.5), ground=True))
    assert obj.worldOrientation[2][2] > 0.999
    assert obj.worldPosition.z == pytest.approx(0.6, abs=2e-3)


def test_friction_slows_no_robot_in_the_air():
    body = robot(friction=5.0, at=(0, 0, 30.0))
    w = world(ground(), body, robots=[body])
    run(w, 1.0, lambda: w.game_object("robot").drive((1, 0, 0), (0, 0, 0), ground=True))
    assert w.game_object("robot").worldPosition.x == pytest.approx(1.0, abs=0.01)


def test_a_robot_left_alone_comes_to_a_stop():
    body = robot()
    w = world(ground(), body, robots=[body])
    run(w, 1.0, lambda: w.game_object("robot").drive((1, 0, 0), (0, 0, 0), ground=True))
    run(w, 1.0)
    # v^2 / (2 mu g) with mu = 0.7
    assert w.game_object("robot").worldPosition.x == pytest.approx(1.0 + 1 / (2 * 0.7 * 9.81), abs=0.02)


def test_a_ground_robot_falls_while_it_drives():
    body = robot(at=(0, 0, 5))
    w = world(body, robots=[body])
    run(w, 0.5, lambda: w.game_object("robot").drive((1, 0, 0), (0, 0, 0), ground=True))
    x, _, z = w.game_object("robot").worldPosition
    assert x == pytest.approx(0.5, abs=1e-3)
    assert z == pytest.approx(5 - 0.5 * 9.81 * 0.25, abs=0.03)


def test_an_aircraft_obeys_all_six_speeds():
    body = robot(at=(0, 0, 5), gravity=False)
    w = world(body, robots=[body])
    run(w, 1.0, lambda: w.game_object("robot").drive((1, 0.5, 0.25), (0, 0, 0)))
    assert tuple(w.game_object("robot").worldPosition) == pytest.approx((1, 0.5, 5.25), abs=1e-3)


def test_a_robot_without_a_body_follows_the_same_circle():
    ghost = Node("ghost")
    w = world(ground(), ghost, robots=[ghost])
    run(w, 4.0, lambda: w.game_object("ghost").drive((V, 0, 0), (0, 0, W)))
    assert tuple(w.game_object("ghost").worldPosition[:2]) == pytest.approx(on_circle(V, W, 4.0), abs=1e-9)
    assert tuple(w.game_object("ghost").worldLinearVelocity) == pytest.approx(
        (V * math.cos(W * 4), V * math.sin(W * 4), 0), abs=1e-9
    )


def test_a_kinematic_robot_pushes_what_is_in_its_way():
    pusher = node("pusher", box(0.5, 0.5, 0.5), at=(0, 0, 0.26), kind=PhysicsType.STATIC)
    w = world(ground(), pusher, rigid("Box", box(0.3, 0.3, 0.3), at=(0.6, 0, 0.15)), robots=[pusher])
    run(w, 2.0, lambda: w.game_object("pusher").drive((0.5, 0, 0), (0, 0, 0)))
    assert w.game_object("pusher").worldPosition.x == pytest.approx(1.0, abs=1e-9)
    assert w.game_object("Box").worldPosition.x > 1.38


def test_speeds_that_are_no_numbers_are_refused():
    body = robot()
    w = world(body, robots=[body])
    with pytest.raises(ValueError, match="finite"):
        w.game_object("robot").drive((math.nan, 0, 0), (0, 0, 0))


# -- driven robots stand on feet -------------------------------------------------------------------

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
