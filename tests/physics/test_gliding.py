"""Robots that glide over a level floor move exactly like robots whose feet are in contact with it."""

import itertools
import math

import mujoco
import numpy as np
import pytest
from worlds import bits, box, ground, node, rigid, robot, run, sphere, world

from morse.scene import CollisionShape, ShapeKind

TICK = 1 / 60


class Twins:
    """The same world twice: in one, robots may glide, in the other, they always stand on their feet."""

    def __init__(self, make):
        self.gliding, self.standing = make(), make()
        self.standing.gliding.consider = lambda index, command: None
        self.glided = 0

    def run(self, seconds, act):
        """``act(world, time)`` before each tick; returns the largest distance between twins, and between their axes."""
        worst = 0.0
        for k in range(round(seconds * 60)):
            for twin in (self.gliding, self.standing):
                act(twin, k * TICK)
                twin.step()
            self.glided += len(self.gliding.gliding.glides) > 0
            worst = max(worst, self.difference())
        return worst

    def difference(self):
        places = np.array(self.gliding.positions) - np.array(self.standing.positions)
        turns = np.array(self.gliding.rotations) - np.array(self.standing.rotations)
        return max(float(np.abs(places).max()), float(np.abs(turns).max()))


def drive(world, v=0.5, w=0.0, name="robot"):
    world.game_object(name).drive((v, 0, 0), (0, 0, w), ground=True)


def with_ground(*others, at=(0, 0, 0.25), shape=None, **settings):
    def make():
        body = robot(at=at, shape=shape, **settings)
        return world(ground(), body, *(other() for other in others), robots=[body])

    return make


# equal motion -------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", [box(0.6, 0.4, 0.5), CollisionShape(ShapeKind.CYLINDER, (0.2, 0.25))])
def test_circles_are_the_same(shape):
    twins = Twins(with_ground(shape=shape))
    assert twins.run(5.0, lambda w, t: drive(w, 0.8, 0.6)) < 1e-6
    assert twins.glided > 280


def test_a_body_off_its_origin_moves_the_same():
    shape = CollisionShape(ShapeKind.BOX, (0.3, 0.2, 0.25), (0.12, -0.05, 0.0))
    twins = Twins(with_ground(shape=shape))
    assert twins.run(10.0, lambda w, t: drive(w, 0.5, 1.5)) < 1e-6
    assert twins.glided > 500


def test_commands_that_change_and_pause_are_followed_alike():
    twins = Twins(with_ground())

    def act(w, t):
        if t % 1.0 < 0.7:
            drive(w, 0.6 * math.sin(3 * t), math.cos(5 * t))

    assert twins.run(6.0, act) < 1e-6
    assert twins.glided > 150


def test_sideways_and_shifted_motion_is_the_same():
    twins = Twins(with_ground())

    def act(w, t):
        w.game_object("robot").drive((0.3, -0.4, 0), (0, 0, 0.7), ground=True, position=t > 1.0)

    assert twins.run(3.0, act) < 1e-6
    assert twins.glided > 150


def test_velocities_that_sensors_see_are_the_same():
    twins = Twins(with_ground())
    twins.run(2.0, lambda w, t: drive(w, 0.5, 0.8))
    seen = [np.array(w.game_object("robot").velocity()) for w in (twins.gliding, twins.standing)]
    assert seen[0] == pytest.approx(seen[1], abs=1e-6)
    assert np.hypot(*seen[0][0][:2]) == pytest.approx(0.5, abs=1e-5)


def test_a_floor_that_is_turned_carries_as_well():
    def make():
        body = robot(at=(0, 0, 0.25))
        return world(node("Floor", box(6, 3, 1), at=(0, 0, -0.5), turned=(0, 0, 0.5)), body, robots=[body])

    twins = Twins(make)
    assert twins.run(4.0, lambda w, t: drive(w, 0.4, 0.4)) < 1e-6
    assert twins.glided > 220


def test_a_box_on_its_side_carries_as_well():
    def make():
        body = robot(at=(0, 0, 0.25))
        floor = node("Floor", box(1, 8, 8), at=(0, 0, -0.5), turned=(0, math.pi / 2, 0))
        return world(floor, body, robots=[body])

    twins = Twins(make)
    assert twins.run(2.0, lambda w, t: drive(w)) < 1e-6
    assert twins.glided > 100


# contacts -----------------------------------------------------------------------------------


def test_a_wall_stops_it_alike():
    # at 1.5 m, a step of the engine would end where the robot just does not touch the wall: rounding would decide
    twins = Twins(with_ground(lambda: node("Wall", box(0.2, 4, 1), at=(1.502, 0, 0.5))))
    assert twins.run(4.0, lambda w, t: drive(w, 0.8)) < 1e-6
    assert twins.gliding.game_object("robot").worldPosition.x == pytest.approx(1.502 - 0.1 - 0.25, abs=0.01)


def test_a_box_is_pushed_alike():
    # a box that is pushed by a robot has stick-slip: a nanometre decides when, so that the paths differ later
    twins = Twins(with_ground(lambda: rigid("Box", box(0.3, 0.3, 0.3), at=(1.0, 0.05, 0.15))))
    assert twins.run(0.7, lambda w, t: drive(w, 0.8)) < 1e-6
    assert twins.gliding.game_object("Box").worldPosition.x == pytest.approx(1.0, abs=0.02)
    twins.run(1.3, lambda w, t: drive(w, 0.8))
    for w in (twins.gliding, twins.standing):
        gap = w.game_object("Box").worldPosition.x - w.game_object("robot").worldPosition.x
        assert gap == pytest.approx(0.25 + 0.15, abs=0.12)
        # it wobbles
        assert w.game_object("Box").worldPosition.z == pytest.approx(0.15, abs=0.03)


def test_what_falls_on_it_hits_it_alike():
    twins = Twins(with_ground(lambda: rigid("Ball", sphere(0.1), at=(0.6, 0.1, 2.0), mass=3.0)))
    assert twins.run(0.9, lambda w, t: drive(w, 0.8)) < 1e-3
    ball = twins.gliding.game_object("Ball").worldPosition
    assert ball.z > 0.1 or math.hypot(ball.x, ball.y) > 0.3


def test_robots_collide_alike():
    def make():
        first, second = robot(at=(-1, 0, 0.25)), robot("other", at=(1, 0.1, 0.25))
        return world(ground(), first, second, robots=[first, second])

    twins = Twins(make)

    def act(w, t):
        drive(w, 0.7)
        drive(w, -0.7, name="other")

    assert twins.run(2.5, act) < 1e-3
    places = [twins.gliding.game_object(name).worldPosition.x for name in ("robot", "other")]
    assert places[1] - places[0] > 0.48


def test_something_flat_on_the_floor_is_not_driven_through():
    # lower than the hull: only feet can touch it
    twins = Twins(with_ground(lambda: node("Rug", box(1, 4, 0.004), at=(1.2, 0, 0.002))))
    assert twins.run(3.0, lambda w, t: drive(w, 0.4)) < 1e-4
    assert twins.gliding.game_object("robot").worldPosition.z == pytest.approx(0.254, abs=1e-3)


def test_it_climbs_a_ramp_alike():
    ramp = lambda: node("Ramp", box(4, 4, 0.2), at=(2.6, 0, 0.0), turned=(0, -0.15, 0))  # noqa: E731
    twins = Twins(with_ground(ramp))
    assert twins.run(4.0, lambda w, t: drive(w, 0.6)) < 2e-3
    assert twins.gliding.game_object("robot").worldPosition.z > 0.3


def test_a_robot_that_keeps_touching_seldom_glides():
    w = with_ground(lambda: node("Wall", box(0.2, 4, 1), at=(0.8, 0, 0.5)))()
    glided = []

    def act():
        drive(w, 0.5)
        glided.append(bool(w.gliding.glides))

    run(w, 5.0, act)
    assert sum(not before and after for before, after in itertools.pairwise(glided)) <= 3


# the floor ends -----------------------------------------------------------------------------


def test_it_falls_over_the_edge_alike():
    def make():
        body = robot(at=(0, 0, 0.25))
        return world(node("Table", box(3, 3, 1), at=(0, 0, -0.5)), body, robots=[body])

    twins = Twins(make)
    assert twins.run(2.2, lambda w, t: drive(w, 0.9)) < 1e-6
    assert twins.glided > 60
    run(twins.gliding, 1.0, lambda: drive(twins.gliding, 0.9))
    assert twins.gliding.game_object("robot").worldPosition.z < -1.0


def test_a_sudden_dash_does_not_carry_it_over_the_edge():
    def make():
        body = robot(at=(0, 0, 0.25))
        return world(node("Table", box(3, 3, 1), at=(0, 0, -0.5)), body, robots=[body])

    twins = Twins(make)
    assert twins.run(1.5, lambda w, t: drive(w, 0.05 if t < 1.0 else 30.0)) < 1e-4
    assert twins.gliding.game_object("robot").worldPosition.z < 0.2


def test_it_goes_on_over_a_seam_to_the_next_floor():
    def make():
        body = robot(at=(-1, 0, 0.25))
        floors = [node(f"Tile{i}", box(2, 4, 1), at=(2 * i - 1, 0, -0.5)) for i in range(4)]
        return world(*floors, body, robots=[body])

    twins = Twins(make)
    assert twins.run(8.0, lambda w, t: drive(w, 0.7)) < 1e-5
    assert twins.glided > 200


@pytest.mark.parametrize("take_away", ["lower", "open"])
def test_it_falls_when_the_floor_goes(take_away):
    w = with_ground()()
    run(w, 0.5, lambda: drive(w))
    floor = w.game_object("Ground")
    if take_away == "lower":
        floor.worldPosition = (0, 0, -5.0)
    else:
        w.bodies.set_collision([floor.node], False)
    run(w, 0.5, lambda: drive(w))
    assert w.game_object("robot").worldPosition.z < 0.0


# other influences ---------------------------------------------------------------------------


def test_a_force_lifts_it_alike():
    twins = Twins(with_ground())

    def act(w, t):
        drive(w)
        if t > 0.5:
            w.game_object("robot").wrench((0, 0, 150.0), (0, 0, 0), local=False)

    assert twins.run(1.0, act) < 1e-6
    assert twins.gliding.game_object("robot").worldPosition.z > 0.5


def test_it_falls_from_where_it_is_put():
    twins = Twins(with_ground())

    def act(w, t):
        drive(w)
        if abs(t - 0.5) < TICK / 2:
            w.game_object("robot").worldPosition = (0, 0, 1.25)

    assert twins.run(2.0, act) < 1e-6
    assert twins.gliding.game_object("robot").worldPosition.z == pytest.approx(0.25, abs=1e-3)


def test_a_velocity_upward_makes_it_jump_alike():
    twins = Twins(with_ground())

    def act(w, t):
        if abs(t - 0.5) < TICK / 2:
            w.game_object("robot").drive((0.5, 0, 2.0), (0, 0, 0))
        else:
            drive(w)

    assert twins.run(1.5, act) < 1e-6


def test_without_collision_it_falls_through():
    w = with_ground()()
    run(w, 0.5, lambda: drive(w))
    body = w.game_object("robot")
    w.bodies.set_collision([body.node], False)
    run(w, 0.5, lambda: drive(w))
    assert body.worldPosition.z < 0.0


def test_it_still_touches_the_floor_for_those_who_ask():
    twins = Twins(with_ground())
    twins.run(1.0, lambda w, t: drive(w))
    touching = [sorted((a.name, b.name) for a, b in w.contacts()) for w in (twins.gliding, twins.standing)]
    assert [tuple(sorted(pair)) for pair in touching[0]] == [tuple(sorted(pair)) for pair in touching[1]]
    assert len(touching[0]) == 4


# restart ------------------------------------------------------------------------------------


def test_after_a_reset_everything_happens_again_bit_by_bit():
    make = with_ground(lambda: rigid("Box", box(0.3, 0.3, 0.3), at=(1.0, 0.05, 0.15)))
    w, fresh = make(), make()
    run(w, 2.0, lambda: drive(w, 0.8, 0.2))
    w.reset()
    for _ in range(120):
        for each in (w, fresh):
            drive(each, 0.8, 0.2)
            each.step()
        assert bits(w.get_state()) == bits(fresh.get_state())


def test_a_robot_without_weight_is_left_alone():
    def make():
        body = robot(at=(0, 0, 0.25))
        body.properties["NoGravity"] = True
        return world(ground(), body, robots=[body])

    twins = Twins(make)
    twins.run(1.0, lambda w, t: drive(w))
    assert twins.glided == 0
    assert twins.gliding.game_object("robot").worldPosition.z == pytest.approx(0.25, abs=1e-6)


# near something -----------------------------------------------------------------------------


def test_a_lower_floor_does_not_matter():
    twins = Twins(with_ground(lambda: node("Below", box(40, 40, 1), at=(0, 0, -0.51))))
    assert twins.run(5.0, lambda w, t: drive(w, 0.8, -0.6)) < 1e-6
    assert twins.glided > 280


def test_it_glides_while_something_else_moves():
    w = with_ground(lambda: rigid("Ball", sphere(0.1), at=(3, 3, 50.0)))()
    run(w, 2.0, lambda: drive(w, 0.5))
    assert w.gliding.glides
    assert w.game_object("robot").worldPosition.x == pytest.approx(1.0, abs=1e-6)
    ball = w.game_object("Ball").worldPosition.z
    assert ball == pytest.approx(50.0 - 9.81 / 2 * 4.0, abs=0.1)


def test_a_fast_robot_does_not_jump_into_a_thin_wall():
    twins = Twins(with_ground(lambda: node("Wall", box(0.02, 4, 1), at=(6, 0, 0.5))))
    assert twins.run(1.0, lambda w, t: drive(w, 9.0)) < 1e-5
    assert twins.gliding.game_object("robot").worldPosition.x < 6.0


def test_robots_that_pass_closely_glide_on():
    def make():
        first, second = robot(at=(-1, 0, 0.25)), robot("other", at=(1, 0.405, 0.25))
        return world(ground(), first, second, robots=[first, second])

    twins = Twins(make)

    def act(w, t):
        drive(w, 0.5)
        drive(w, -0.5, name="other")
        if t > 1.0:
            assert len(twins.gliding.gliding.glides) == 2

    assert twins.run(6.0, act) < 1e-6


def test_a_sleeping_box_is_woken_alike():
    # the box is at rest for seconds before the robot arrives
    twins = Twins(with_ground(lambda: rigid("Box", box(0.3, 0.3, 0.3), at=(2.6, 0.0, 0.15))))
    assert twins.run(5.0, lambda w, t: drive(w, 0.4)) < 1e-5
    twins.run(1.5, lambda w, t: drive(w, 0.4))
    assert twins.gliding.game_object("Box").worldPosition.x > 2.65


def test_lightening_another_body_leaves_the_floor_under_a_robot_that_glides():
    body = robot()
    w = world(ground(), body, rigid("Balloon", box(0.2, 0.2, 0.2), at=(3, 3, 0.1)), robots=[body])
    run(w, 0.5, lambda: drive(w))
    assert "robot" in [w.slots[index].frame.node.name for index in w.gliding.glides]
    w.game_object("Balloon").disable_gravity()
    run(w, 0.5, lambda: drive(w))
    run(w, 1.0)
    assert w.game_object("robot").worldPosition.z == pytest.approx(0.25, abs=1e-3)


# drifting: no engine steps ----------------------------------------------------------------------


def drifters(*others, count=1):
    bodies = [robot(f"robot{i}" if i else "robot", at=(0, 3 * i, 0.25)) for i in range(count)]
    return world(ground(), *bodies, *others, robots=bodies)


class EngineSteps:
    """Counts the steps of the engine."""

    def __init__(self, monkeypatch):
        self.count = 0
        original = mujoco.mj_step

        def step(*arguments):
            self.count += 1
            original(*arguments)

        monkeypatch.setattr(mujoco, "mj_step", step)

    def during(self, act):
        before = self.count
        act()
        return self.count - before


@pytest.fixture
def engine_steps(monkeypatch):
    return EngineSteps(monkeypatch)


def asleep(name="Box", at=(-5, 0, 0.15)):
    return rigid(name, box(0.3, 0.3, 0.3), at=at)


def settle(w, seconds=1.0):
    run(w, seconds, lambda: drive(w, 0.5, 0.2))


def test_robots_that_glide_alone_need_no_step_of_the_engine(engine_steps):
    w = drifters(asleep())
    settle(w)
    assert engine_steps.during(lambda: run(w, 1.0, lambda: drive(w, 0.5, 0.2))) == 0
    assert w.data.time == pytest.approx(2.0)
    assert w.game_object("Box").worldPosition.z == pytest.approx(0.15, abs=1e-3)


@pytest.mark.parametrize(
    "stir",
    [
        lambda o: setattr(o, "worldLinearVelocity", (0, 1.0, 0)),
        lambda o: o.applyForce((0, 500.0, 0)),
        lambda o: setattr(o, "worldPosition", (-5, 0.1, 1.0)),
        lambda o: o.applyMovement((0, 0.1, 0)),
        lambda o: o.drive((0, 1.0, 0), (0, 0, 0)),
    ],
)
def test_a_sleeper_that_is_stirred_wakes_while_others_drift(stir, engine_steps):
    w = drifters(asleep())
    settle(w)
    assert engine_steps.during(lambda: settle(w, 0.1)) == 0
    sleeper = w.game_object("Box")
    before = sleeper.worldPosition.copy()
    stir(sleeper)
    settle(w, 0.3)
    assert (sleeper.worldPosition - before).length > 0.02
    settle(w, 2.0)
    assert sleeper.worldPosition.z == pytest.approx(0.15, abs=1e-3)
    assert engine_steps.during(lambda: settle(w, 0.1)) == 0


def test_a_sleeping_robot_that_is_driven_starts_while_another_drifts():
    w = drifters(count=2)
    settle(w, 2.0)
    run(w, 1.0, lambda: (drive(w, 0.5), drive(w, 0.5, name="robot1")))
    assert w.game_object("robot1").worldPosition.x == pytest.approx(0.5, abs=0.01)
    assert w.game_object("robot").worldPosition.x > 0.4


def test_a_robot_without_forces_wakes_what_it_meets_while_others_drift():
    pusher = node("pusher", box(0.2, 0.2, 0.2), at=(-6, 0, 0.15))
    body = robot()
    w = world(ground(), body, pusher, asleep(), robots=[body, pusher])

    def both():
        drive(w, 0.3, 0.4)
        w.game_object("pusher").drive((0.5, 0, 0), (0, 0, 0), position=True)

    run(w, 1.0, lambda: drive(w, 0.3, 0.4))
    run(w, 3.0, both)
    pushed = w.game_object("Box").worldPosition.x - w.game_object("pusher").worldPosition.x
    assert pushed == pytest.approx(0.25, abs=0.02)


def test_what_loses_its_floor_falls_while_others_drift():
    table = node("Table", box(1, 1, 0.5), at=(-5, 0, 0.25))
    w = drifters(table, asleep(at=(-5, 0, 0.65)))
    settle(w)
    w.game_object("Table").worldPosition = (-9, 0, 0.25)
    w.game_object("Box").worldLinearVelocity = (0, 0, 0.01)
    settle(w)
    assert w.game_object("Box").worldPosition.z == pytest.approx(0.15, abs=2e-3)


def test_a_drifting_robot_is_stopped_by_a_wall_and_pushes_a_sleeper():
    w = drifters(asleep(at=(1.5, 0, 0.15)), node("Wall", box(0.2, 4, 1), at=(3.0, 0, 0.5)))
    run(w, 6.0, lambda: drive(w, 0.8))
    assert w.game_object("Box").worldPosition.x > 1.6
    assert w.game_object("robot").worldPosition.x < 3.0 - 0.1 - 0.25 + 0.01


def test_drifting_robots_that_meet_collide():
    first, second = robot(at=(-3, 0, 0.25)), robot("other", at=(3, 0.1, 0.25))
    w = world(ground(), first, second, robots=[first, second])

    def act():
        drive(w, 0.9)
        drive(w, -0.9, name="other")

    run(w, 5.0, act)
    gap = w.game_object("other").worldPosition.x - w.game_object("robot").worldPosition.x
    assert gap > 0.45


@pytest.mark.parametrize("at", [70, 71, 200])
def test_a_state_saved_while_robots_drift_goes_on_with_the_same_bits(at):
    def make():
        return drifters(asleep(at=(1.5, 0.4, 0.15)), count=2)

    def act(w, tick):
        drive(w, 0.6, 0.1)
        if tick > 40:
            drive(w, 0.4, -0.1, name="robot1")
        if tick == 100:
            w.game_object("Box").applyForce((30, 0, 0))

    w, fresh = make(), make()
    for tick in range(at):
        act(w, tick)
        w.step()
    fresh.set_state(w.get_state())
    for tick in range(at, at + 200):
        for one in (w, fresh):
            act(one, tick)
            one.step()
        assert bits(w.get_state()) == bits(fresh.get_state())
