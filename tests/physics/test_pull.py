"""Pulling a body at a point, like the pointer in the view."""

import math

import pytest
from worlds import box, ground, node, rigid, run, world

STIFFNESS, DAMPING, STRONGEST = 60.0, 2 * math.sqrt(60.0), 80.0


def pull(w, name, anchor, target):
    w.game_object(name).pull(anchor, target, STIFFNESS, DAMPING, STRONGEST)


def test_a_weightless_body_ends_where_it_is_pulled_to():
    w = world(rigid("Box", box(0.5, 0.5, 0.5), at=(0, 0, 0), mass=7.0), gravity=0)
    run(w, 2.0, lambda: pull(w, "Box", (0, 0, 0), (1, 0.5, 0)))
    assert tuple(w.game_object("Box").worldPosition) == pytest.approx((1, 0.5, 0), abs=0.01)


def test_under_gravity_it_hangs_below_the_pointer():
    w = world(ground(), rigid("Box", box(0.5, 0.5, 0.5), at=(0, 0, 0.25), mass=7.0))
    run(w, 3.0, lambda: pull(w, "Box", (0, 0, 0), (0, 0, 2.0)))
    # the spring is stretched by g/k
    assert w.game_object("Box").worldPosition.z == pytest.approx(2.0 - 9.81 / STIFFNESS, abs=0.02)


def test_the_pull_has_a_limit():
    w = world(rigid("Box", box(0.5, 0.5, 0.5), at=(0, 0, 0)), gravity=0)
    pull(w, "Box", (0, 0, 0), (1e6, 0, 0))
    w.step()
    assert w.game_object("Box").worldLinearVelocity.x == pytest.approx(STRONGEST / 60, rel=0.02)


def test_what_stands_fast_is_not_pulled():
    w = world(node("Wall", box(1, 1, 1), at=(0, 0, 0.5)))
    run(w, 0.5, lambda: pull(w, "Wall", (0, 0, 0), (5, 0, 0)))
    assert tuple(w.game_object("Wall").worldPosition) == pytest.approx((0, 0, 0.5))


def test_centres_of_mass_are_in_the_frame_of_the_body():
    w = world(ground(), rigid("Box", box(0.5, 0.5, 0.5), at=(3, 0, 0.25), mass=7.0))
    assert w.mass_centres() == [("Box", pytest.approx(7.0), pytest.approx((0, 0, 0)))]
