"""The bits of a driven robot depend only on what it touches; last digits may depend on others in one case."""

import math
import random

import mujoco
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from worlds import bits, box, ground, node, rigid, robot, sphere, world

from morse.physics.gliding import passage, stances
from tests.kit.effort import examples

TICKS = 150
#: columns of places, 4 m apart; the robot that is observed is at the first place and stays within 1.5 m
_COLUMNS, _APART = 8, 4.0


def place(number):
    return _APART * (number % _COLUMNS) - 14.0, _APART * (number // _COLUMNS) - 14.0


def floor():
    return node("Floor", box(80, 80, 1), at=(0, 0, -0.5))


class Other:
    """Another robot with a wall and a crate, far from the observed robot. What it does is drawn at random."""

    def __init__(self, number, seed):
        self.chance = random.Random(f"{seed}:{number}")
        self.name, self.x, self.y = f"other{number}", *place(number)
        self.mass = self.chance.uniform(1.0, 80.0)
        self.deed = self.chance.choice(("hits a wall", "pushes", "is teleported", "stops", "is thrown", "circles"))

    def nodes(self):
        body = robot(self.name, at=(self.x, self.y, 0.25), mass=self.mass)
        if self.deed == "hits a wall":
            return [body, node(f"{self.name}.wall", box(0.2, 1, 1), at=(self.x + 0.8, self.y, 0.5))]
        if self.deed == "pushes":
            return [body, rigid(f"{self.name}.crate", box(0.3, 0.3, 0.3), at=(self.x + 0.6, self.y, 0.15))]
        if self.deed == "is thrown":
            return [body, rigid(f"{self.name}.ball", sphere(0.1), at=(self.x + 0.1, self.y, 1.5))]
        return [body]

    def act(self, w, tick):
        obj = w.game_object(self.name)
        if self.deed == "is teleported" and tick % 20 == 10:
            obj.worldPosition = (self.x + self.chance.uniform(-1, 1), self.y, 0.3)
        elif self.deed == "stops" and tick % 40 > 25:
            return
        speed = 0.3 if self.deed != "circles" else 1.0
        obj.drive((speed, 0, 0), (0, 0, 1.5 if self.deed == "circles" else 0.0), ground=True)


def path(others, plan, living=False, lever=0.0):
    """Positions, rotations and velocities (T, 18) of the observed robot among others."""
    shape = box(0.5, 0.4, 0.5)
    shape.position = (lever, 0.0, 0.0)
    body = robot("observed", shape, at=(*place(0), 0.25))
    nodes = [one for other in others for one in other.nodes()]
    w = world(floor(), body, *nodes, robots=[body, *(n for n in nodes if n.properties.get("GroundRobot"))])
    rows = []
    for tick in range(TICKS):
        if living and tick == 40:
            w.add([rigid("comer", box(0.2, 0.2, 0.2), at=(20, 20, 1.0), mass=300.0)])
        if living and tick == 80:
            w.remove([w.game_object("comer")])
        speed, rate = plan[tick // 30]
        w.game_object("observed").drive((speed, 0, 0), (0, 0, rate), ground=True)
        for other in others:
            other.act(w, tick)
        w.step()
        slot, dof = w.game_object("observed").slot, w.slots[w.game_object("observed").slot].dof
        rows.append(np.concatenate([w.positions.array[slot], w.rotations.array[slot], w.data.qvel[dof : dof + 6]]))
    return np.array(rows)


def numbers(low, high):
    return st.floats(low, high).map(lambda value: round(value, 3))


plans = st.lists(st.tuples(numbers(0.05, 0.5), numbers(-2.0, 2.0)), min_size=5, max_size=5)


@settings(max_examples=examples(20), deadline=None)
@given(plans, st.integers(1, 6), st.integers(0, 10_000), st.booleans())
def test_a_robot_that_touches_only_its_floor_has_the_bits_of_the_robot_alone(plan, count, seed, living):
    alone = path([], plan)
    among = path([Other(number, seed) for number in range(1, count + 1)], plan, living)
    assert np.array_equal(alone, among), int(np.flatnonzero((alone != among).any(axis=1))[0])


@settings(max_examples=examples(20), deadline=None)
@given(plans, st.integers(1, 6), st.integers(0, 10_000), st.booleans())
@example([(0.5, 0.25), (0.5, 0.0), (0.5, 0.0), (0.5, 0.0), (0.5, 0.0)], 1, 1, False)
@example([(0.411, 0.15), (0.411, 0.15), (0.3, 0.0), (0.3, 0.0), (0.3, 0.0)], 1, 2508, False)
@example([(0.464, 0.193), (0.464, 0.193), (0.3, 0.0), (0.3, 0.0), (0.3, 0.0)], 4, 8396, False)
def test_of_a_robot_with_its_mass_off_centre_only_last_digits_depend_on_others(plan, count, seed, living):
    # the bits of the engine's solver for one island of contacts are not those for one of several islands
    alone = path([], plan, lever=0.05)
    among = path([Other(number, seed) for number in range(1, count + 1)], plan, living, lever=0.05)
    assert np.abs(alone - among).max() < 1e-11


@pytest.mark.parametrize("count", [7, pytest.param(63, marks=pytest.mark.slow)])
def test_among_many(count):
    plan = [(0.4, 0.5), (0.3, -1.0), (0.0, 0.3), (0.2, 0.0), (0.5, 2.0)]
    assert np.array_equal(path([], plan), path([Other(n, 3) for n in range(1, count + 1)], plan))


@pytest.mark.parametrize("gap", [0.02, 0.3])
def test_who_passes_without_touching_leaves_the_bits(gap):
    def travel(passes):
        body, other = robot("observed", at=(0, 0, 0.25)), robot("other", at=(3.0, 0.4 + gap, 0.25))
        post = node("post", box(0.1, 0.1, 1), at=(-0.5, 0.4 + gap, 0.5))
        w = world(floor(), body, other, post, robots=[body, other])
        rows = []
        for _ in range(240):
            w.game_object("observed").drive((0.3, 0, 0), (0, 0, 0), ground=True)
            if passes:
                # it glides, and is then pushed by the post
                w.game_object("other").drive((-1.0, 0, 0), (0, 0, 0), ground=True)
            w.step()
            rows.append(w.positions.array[w.game_object("observed").slot].copy())
        assert not passes or w.game_object("other").worldPosition.x < 0.1
        return np.array(rows)

    assert np.array_equal(travel(False), travel(True))


def test_a_crate_that_nobody_touches_sleeps_beside_those_who_pass():
    body, crate = robot("robot", at=(-1.0, 0, 0.25)), rigid("crate", box(0.3, 0.3, 0.3), at=(0, 0.38, 0.15))
    other = robot("other", at=(3, 3, 0.25))
    w = world(floor(), body, crate, other, node("wall", box(0.2, 2, 1), at=(3.6, 3, 0.5)), robots=[body, other])
    tree = w.model.body_treeid[w.slots[w.game_object("crate").slot].body]
    for _ in range(120):
        w.step()
    before = w.positions.array[w.game_object("crate").slot].copy()
    for _ in range(240):
        w.game_object("robot").drive((0.5, 0, 0), (0, 0, 0), ground=True)
        w.game_object("other").drive((0.5, 0, 0), (0, 0, 0), ground=True)
        w.step()
        assert w.data.tree_asleep[tree] >= 0
    assert np.array_equal(before, w.positions.array[w.game_object("crate").slot])


def test_a_static_thing_that_is_moved_elsewhere_ends_no_gliding():
    body = robot("robot", at=(0, 0, 0.25))
    w = world(floor(), body, node("shelf", box(1, 1, 0.4), at=(5, 5, 0.2)), robots=[body])
    for tick in range(90):
        if tick > 40:
            w.game_object("shelf").worldPosition = (5 + 0.01 * tick, 5, 0.2)
        w.game_object("robot").drive((0.3, 0, 0), (0, 0, 0), ground=True)
        w.step()
        assert tick < 40 or w.gliding.glides


def test_a_shelf_that_is_moved_into_the_way_is_met():
    body = robot("robot", at=(0, 0, 0.25))
    w = world(floor(), body, node("shelf", box(0.4, 1, 0.4), at=(5, 5, 0.2)), robots=[body])
    for tick in range(180):
        if tick == 60:
            w.game_object("shelf").worldPosition = (w.game_object("robot").worldPosition.x + 0.5, 0, 0.2)
        w.game_object("robot").drive((0.4, 0, 0), (0, 0, 0), ground=True)
        w.step()
    assert w.game_object("robot").worldPosition.x < w.game_object("shelf").worldPosition.x - 0.4


# -- a world in which everything sleeps needs no engine steps, and is bit-identical to a world with steps

ALL_ASLEEP_TICKS = 240


def make():
    body = robot(at=(3, 0, 0.25))
    boxes = [rigid(name, box(0.3, 0.3, 0.3), at=(0, 0, z)) for name, z in (("Box", 0.15), ("Upper", 0.45))]
    return world(ground(), node("Shelf", box(1, 1, 0.4), at=(-3, 0, 0.2)), *boxes, body, robots=[body])


@pytest.fixture
def steps(monkeypatch):
    """The number of engine steps."""
    count, step = [0], mujoco.mj_step

    def counted(*arguments):
        count[0] += 1
        step(*arguments)

    monkeypatch.setattr(mujoco, "mj_step", counted)
    return count


def asleep():
    w = make()
    for _ in range(ALL_ASLEEP_TICKS):
        w.step()
    assert w.data.nv_awake == 0
    return w


def test_no_step_is_needed(steps):
    w = asleep()
    steps[0] = 0
    for _ in range(60):
        w.step()
    assert steps[0] == 0
    assert w.data.time == pytest.approx((ALL_ASLEEP_TICKS + 60) / 60.0)


@pytest.mark.parametrize("at", [0, 1, 7])
def test_steps_would_change_nothing(at):
    w, stepped, restored = asleep(), asleep(), make()
    stepped._steps._all_sleep = lambda: False
    for _ in range(at):
        w.step()
        stepped.step()
    restored.set_state(w.get_state())
    for _ in range(50):
        for one in (w, stepped, restored):
            one.step()
        assert bits(w.get_state()) == bits(stepped.get_state()) == bits(restored.get_state())
        assert sorted(map(str, w.contacts())) == sorted(map(str, stepped.contacts()))


WAKING = {
    "a push": lambda w: w.game_object("Upper").applyForce((200, 0, 0)),
    "a velocity": lambda w: w.game_object("Upper").setLinearVelocity((0.5, 0, 0)),
    "another place": lambda w: setattr(w.game_object("Upper"), "worldPosition", (0, 0, 2.0)),
    "the lower one taken away": lambda w: setattr(w.game_object("Box"), "worldPosition", (1.5, 1.5, 0.15)),
    "a robot that drives": lambda w: w.game_object("robot").drive((-1.0, 0, 0), (0, 0, 0), ground=True),
}


@pytest.mark.parametrize("deed", WAKING)
def test_what_wakes_things_wakes_them(deed):
    w = asleep()
    for _ in range(20):
        w.step()
    slot = w.game_object("robot" if "drives" in deed else "Upper").slot
    before, farthest = w.positions.array[slot].copy(), 0.0
    for tick in range(40):
        if tick == 0 or "drives" in deed:
            WAKING[deed](w)
        w.step()
        farthest = max(farthest, abs(w.positions.array[slot] - before).max())
    assert farthest > 0.01


# -- robots that drift after a contact check with a large margin are bit-identical to robots checked in every tick

ROBOTS = 3


def crowded():
    """Robots between walls, with a sleeping box."""
    robots = [robot(f"robot{i}", at=(1.2 * i - 1.2, 0.3 * i, 0.25)) for i in range(ROBOTS)]
    walls = [node(f"Wall{x}", box(0.2, 6, 1), at=(x, 0, 0.5)) for x in (-3.5, 3.5)]
    return world(ground(), rigid("Box", box(0.3, 0.3, 0.3), at=(0.6, 1.8, 0.15)), *walls, *robots, robots=robots)


@pytest.fixture
def looks(monkeypatch):
    """The number of contact checks of the engine."""
    count, look = [0], mujoco.mj_collision

    def counted(model, data):
        count[0] += 1
        look(model, data)

    monkeypatch.setattr(mujoco, "mj_collision", counted)
    return count


def journey(seed, ticks=600):
    """Poses (T, K, 3) of a world whose robots are driven randomly, slowly and suddenly fast."""
    numbers, w, places = np.random.default_rng(seed), crowded(), []
    for tick in range(ticks):
        if tick % 15 == 0:
            speeds = numbers.choice([0.02, 0.2, 2.0], size=ROBOTS, p=[0.5, 0.4, 0.1])
            rates = numbers.uniform(-1.0, 1.0, size=ROBOTS)
        for i, (v, rate) in enumerate(zip(speeds.tolist(), rates.tolist(), strict=True)):
            w.game_object(f"robot{i}").drive((v, 0, 0), (0, 0, rate), ground=True)
        w.step()
        places.append(w.positions.array.copy())
    return np.array(places)


@pytest.mark.parametrize("seed", range(6))
def test_the_same_bits_as_with_a_look_in_every_tick(monkeypatch, looks, seed):
    ahead = journey(seed)
    assert looks[0] > 0
    for module in (passage, stances):
        monkeypatch.setattr(module, "FORESIGHT", 1)
    assert np.array_equal(ahead, journey(seed))


def test_a_robot_with_room_around_it_is_looked_at_in_one_of_eight_ticks(looks):
    w = crowded()
    for _ in range(120):
        w.game_object("robot1").drive((0.0, 0, 0), (0, 0, 0.5), ground=True)
        w.step()
    looks[0] = 0
    for _ in range(80):
        w.game_object("robot1").drive((0.0, 0, 0), (0, 0, 0.5), ground=True)
        w.step()
    assert looks[0] <= 10


@pytest.mark.parametrize("speed", [3.0, 8.0])
def test_who_dashes_off_after_a_look_still_meets_the_wall(speed):
    w = crowded()
    for _ in range(90):
        w.game_object("robot2").drive((0.02, 0, 0), (0, 0, 0), ground=True)
        w.step()
    for _ in range(120):
        w.game_object("robot2").drive((speed, 0, 0), (0, 0, 0), ground=True)
        w.step()
    assert 2.9 < w.game_object("robot2").worldPosition.x < 3.5


def test_what_comes_into_the_way_of_a_robot_is_met():
    w = crowded()
    for tick in range(240):
        if tick == 120:
            assert w.gliding.clear_until > w.gliding.tick
            x, y, _ = w.game_object("robot1").worldPosition
            w.game_object("Box").worldPosition = (x + 0.5, y, 0.15)
        w.game_object("robot1").drive((0.3, 0, 0), (0, 0, 0), ground=True)
        w.step()
    (x, y, _), (bx, by, _) = w.game_object("robot1").worldPosition, w.game_object("Box").worldPosition
    assert math.hypot(bx - x, by - y) > 0.35
