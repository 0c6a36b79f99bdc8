"""Bodies under gravity, friction and contact, against textbook formulas."""

import math

import pytest
from worlds import bits, box, ground, node, rigid, robot, run, sphere, world

G = 9.81


def test_free_fall_follows_the_parabola():
    w = world(rigid("Ball", sphere(0.1), at=(0, 0, 10)))
    run(w, 1.0)
    x, y, z = w.game_object("Ball").worldPosition
    assert (x, y) == pytest.approx((0, 0), abs=1e-9)
    # semi-implicit steps of length h end h*v/2 below the parabola
    assert z == pytest.approx(10 - 0.5 * G, abs=G / 240)
    assert w.game_object("Ball").worldLinearVelocity.z == pytest.approx(-G, rel=1e-6)


def test_linear_damping_takes_its_share_each_second():
    w = world(rigid("Ball", sphere(0.1), at=(0, 0, 0), linear_damping=0.3), gravity=0)
    w.game_object("Ball").worldLinearVelocity = [2, 0, 0]
    run(w, 1.0)
    assert w.game_object("Ball").worldLinearVelocity.x == pytest.approx(2 * 0.7, rel=2e-3)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_angular_damping_takes_its_share_about_each_axis(axis):
    """The inertias of the brick about its axes differ by a factor of ten."""
    w = world(rigid("Brick", box(0.6, 0.3, 0.1), at=(0, 0, 0), angular_damping=0.1), gravity=0)
    brick = w.game_object("Brick")
    brick.worldAngularVelocity = [float(axis == k) for k in range(3)]
    run(w, 10.0)
    assert brick.worldAngularVelocity[axis] == pytest.approx(0.9**10, rel=5e-3)


def test_a_box_rests_on_the_ground_and_stays():
    w = world(ground(), rigid("Box", box(1, 1, 1), at=(0, 0, 0.5)))
    run(w, 5.0)
    assert tuple(w.game_object("Box").worldPosition) == pytest.approx((0, 0, 0.5), abs=2e-3)


@pytest.mark.parametrize("mu", [0.1, 0.3, 0.5])
def test_a_box_slides_down_a_slope_as_friction_lets_it(mu):
    tilt = math.radians(30)
    w = world(
        ground(tilt=tilt), rigid("Box", box(1, 1, 0.2), at=(0.1 * math.sin(tilt), 0, 0.1 * math.cos(tilt)), friction=mu)
    )
    box_object = w.game_object("Box")
    box_object.worldOrientation = [0, tilt, 0]
    start = box_object.worldPosition
    run(w, 1.0)
    expected = 0.5 * G * (math.sin(tilt) - mu * math.cos(tilt))
    assert (box_object.worldPosition - start).length == pytest.approx(expected, rel=0.03, abs=0.01)


def test_friction_holds_a_box_on_a_gentle_slope():
    tilt = math.radians(15)
    w = world(
        ground(tilt=tilt),
        rigid("Box", box(1, 1, 0.2), at=(0.1 * math.sin(tilt), 0, 0.1 * math.cos(tilt)), friction=0.5),
    )
    box_object = w.game_object("Box")
    box_object.worldOrientation = [0, tilt, 0]
    run(w, 2.0)
    assert math.hypot(*box_object.worldPosition[:2]) < 0.03


def test_a_force_accelerates_by_mass():
    w = world(rigid("Box", box(1, 1, 1), at=(0, 0, 0), mass=4.0), gravity=0)
    run(w, 1.0, lambda: w.game_object("Box").applyForce([8, 0, 0]))
    assert w.game_object("Box").worldLinearVelocity.x == pytest.approx(2.0, rel=1e-3)
    assert w.game_object("Box").worldPosition.x == pytest.approx(1.0, rel=1e-2)


def test_a_torque_turns_by_inertia():
    w = world(rigid("Box", box(1, 1, 1), at=(0, 0, 0), mass=6.0), gravity=0)
    run(w, 1.0, lambda: w.game_object("Box").applyTorque([0, 0, 0.5]))
    # a unit cube of 6 kg has 1 kg m^2
    assert w.game_object("Box").worldAngularVelocity.z == pytest.approx(0.5, rel=1e-2)


def test_a_wall_that_moves_after_gravity_was_disabled_stops_a_body():
    wall = node("Wall", box(0.2, 3, 1), at=(5, 0, 0.5))
    # the engine uses its tree of bounding boxes for bodies with several shapes
    posts = [node(f"Post{i}", box(0.2, 0.2, 1), at=(-5, i, 0.5)) for i in range(20)]
    w = world(wall, *posts, rigid("Box", box(0.3, 0.3, 0.3), at=(0, 0, 0.5)))
    w.game_object("Wall").worldPosition = (5, 4, 0.5)
    w.game_object("Box").disable_gravity()
    w.game_object("Wall").worldPosition = (1, 0, 0.5)
    w.game_object("Box").worldLinearVelocity = (1, 0, 0)
    run(w, 2.0)
    assert w.game_object("Box").worldPosition.x <= 0.75 + 0.01


def test_weightless_bodies_hover():
    w = world(rigid("A", sphere(0.1), at=(0, 0, 3), gravity=False), rigid("B", sphere(0.1), at=(2, 0, 3)))
    w.game_object("B").disable_gravity()
    run(w, 1.0)
    assert w.game_object("A").worldPosition.z == pytest.approx(3, abs=1e-6)
    assert w.game_object("B").worldPosition.z == pytest.approx(3, abs=1e-6)


def test_momentum_is_conserved_when_balls_meet():
    w = world(
        rigid("A", sphere(0.1), at=(-1, 0, 0), mass=2.0, friction=0.0),
        rigid("B", sphere(0.1), at=(1, 0, 0), mass=1.0, friction=0.0),
        gravity=0,
    )
    a, b = w.game_object("A"), w.game_object("B")
    a.worldLinearVelocity = [1, 0, 0]
    b.worldLinearVelocity = [-1, 0, 0]
    run(w, 2.0)
    assert 2 * a.worldLinearVelocity.x + b.worldLinearVelocity.x == pytest.approx(1.0, abs=1e-6)
    assert a.worldLinearVelocity.x < 1.0 - 0.1


def test_reset_puts_everything_back():
    w = world(ground(), rigid("Ball", sphere(0.1), at=(0, 0, 1)), node("Wall", box(1, 1, 1), at=(5, 0, 0.5)))
    before = bits(w.get_state())
    run(w, 1.0)
    w.game_object("Wall").worldPosition = [7, 0, 0.5]
    w.reset()
    assert bits(w.get_state()) == before
    assert tuple(w.game_object("Ball").worldPosition) == pytest.approx((0, 0, 1))


def test_two_runs_are_equal_to_the_bit():
    def final():
        w = world(ground(), *(rigid(f"Ball{i}", sphere(0.1), at=(0.03 * i, 0, 1 + 0.3 * i)) for i in range(6)), robot())
        run(w, 2.0, lambda: w.game_object("robot").drive((0.5, 0, 0), (0, 0, 0.3), ground=True))
        return bits(w.get_state())

    assert final() == final()
