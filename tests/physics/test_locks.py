"""Bodies that cannot move along some axes, and robots that only commands turn."""

import math

import pytest
from worlds import box, ground, rigid, robot, run, sphere, world

from morse.scene import PhysicsType


def test_a_body_moves_along_its_free_axes_only():
    w = world(rigid("Bead", sphere(0.1), at=(0, 0, 1), lock_location=(False, True, True)))
    run(w, 1.0, lambda: w.game_object("Bead").applyForce([2, 3, 4]))
    x, y, z = w.game_object("Bead").worldPosition
    assert x == pytest.approx(1.0, rel=0.02)
    assert (y, z) == (0, 1)


def test_a_body_that_may_not_turn_slides_upright():
    w = world(ground(), rigid("Pole", box(0.2, 0.2, 2), at=(0, 0, 1), lock_rotation=(True, True, True), friction=0.0))
    pole = w.game_object("Pole")
    pole.worldLinearVelocity = [1, 0, 0]
    run(w, 1.0, lambda: pole.applyTorque([50, 50, 50]))
    assert tuple(pole.worldOrientation.to_euler()) == pytest.approx((0, 0, 0), abs=1e-9)
    assert pole.worldPosition.x == pytest.approx(1.0, rel=0.02)


def test_a_locked_body_can_be_put_elsewhere():
    w = world(rigid("Bead", sphere(0.1), at=(0, 0, 1), lock_location=(True, True, True)))
    w.game_object("Bead").worldPosition = [2, 3, 4]
    run(w, 0.5)
    assert tuple(w.game_object("Bead").worldPosition) == pytest.approx((2, 3, 4))


def test_a_dynamic_robot_is_not_toppled_but_obeys():
    made = {}
    for kind in (PhysicsType.RIGID_BODY, PhysicsType.DYNAMIC):
        body = robot(shape=box(0.4, 0.4, 1.6), at=(0, 0, 0.8))
        body.body.type = kind
        w = world(ground(), body, robots=[body])
        obj = w.game_object("robot")
        run(w, 1.0, lambda obj=obj: obj.applyTorque([0, 80, 0]))
        made[kind] = obj.worldOrientation[2][2]
        run(w, 1.0, lambda obj=obj: obj.drive((0, 0, 0), (0, 0, 0.5), ground=True))
        if kind is PhysicsType.DYNAMIC:
            assert obj.worldOrientation.to_euler().z == pytest.approx(0.5, abs=0.02)
    assert made[PhysicsType.DYNAMIC] == pytest.approx(1.0, abs=1e-4)
    assert made[PhysicsType.RIGID_BODY] < math.cos(0.2)
