"""Known answers of models of pedestrians: RiMEA 6, ORCA head-on, lanes, groups; ways, polygons, contacts, steps.

Those with figures, RiMEA 1, 4 and 9 and doors, are in docs/validation.md, which tests/docs measures again.
"""

import math

import numpy as np
import pytest

from morse.plugins.people.contacts import REGIONS, footprint, press, regions, ways_out
from morse.plugins.people.gait import Gait
from morse.plugins.people.walking import Orca, Others, SocialForce, Walkers, neighbours
from morse.plugins.people.wayfinding import Ground, distance_to, hull, inside

TICK = 1.0 / 60.0
MODELS = (SocialForce(), Orca())
both = pytest.mark.parametrize("model", MODELS, ids=["social-force", "orca"])


def box(x, y, u, v):
    return np.array([(x, y), (u, y), (u, v), (x, v)], dtype=float)


def ground(walls, low, high):
    return Ground(walls, np.array(low, dtype=float), np.array(high, dtype=float), 0.2)


@both
def test_rimea_6_a_corner_is_turned_and_no_wall_entered(model):
    walls = [
        box(-1, -0.5, 12.5, 0),
        box(-1, 2, 10, 2.5),
        box(-1, -0.5, -0.5, 2.5),
        box(12, 0, 12.5, 12),
        box(9.5, 2, 10, 12),
    ]
    floor = ground(walls, (-2, -2), (14, 14))
    way = floor.way_to(floor.cells_in(box(10, 11, 12, 12.5)))
    spots = np.array([(0.5 + 0.6 * (k // 3), 0.5 + 0.5 * (k % 3)) for k in range(20)])
    walkers = Walkers.at(floor, spots, 1.34, 0.2)
    for _ in range(60 * 60):
        walkers.wanted = floor.heading(way, walkers.position)
        walkers.step(TICK, model)
        for wall in walls:
            assert (distance_to(wall, walkers.position[walkers.present]) > 0.1).all()
        walkers.present &= walkers.position[:, 1] < 10.5
        if not walkers.present.any():
            break
    assert not walkers.present.any()


def test_two_agents_of_orca_pass_head_on_symmetrically_without_touching():
    floor = ground([], (-10, -10), (10, 10))
    walkers = Walkers.at(floor, np.array([(-4.0, 0.0), (4.0, 0.0)]), 1.3, 0.3)
    closest = math.inf
    for _ in range(60 * 8):
        walkers.wanted = np.array([(1.0, 0.0), (-1.0, 0.0)])
        walkers.step(TICK, Orca())
        # the rotation by 180 degrees maps each onto the other
        assert walkers.position[0] == pytest.approx(-walkers.position[1], abs=1e-9)
        closest = min(closest, math.dist(*walkers.position))
    assert closest > 0.6
    assert walkers.position[0, 0] > 3.0


@both
def test_people_give_way_to_a_robot_that_they_see_and_not_to_one_that_they_do_not(model):
    floor = ground([], (-10, -10), (10, 10))
    distances = []
    for sees in (True, False):
        walker = Walkers.at(floor, np.array([(-4.0, 0.05)]), 1.3, 0.2)
        walker.wanted[:] = (1.0, 0.0)
        robot = Others(np.zeros((1, 2)), np.zeros((1, 2)), np.array([0.4]), np.array([[sees]]))
        closest = math.inf
        for _ in range(60 * 6):
            walker.step(TICK, model, robot)
            closest = min(closest, math.hypot(*walker.position[0]))
        distances.append(closest)
        assert walker.position[0, 0] > 1.5
    assert distances[0] > 0.55
    assert distances[1] == pytest.approx(0.05, abs=0.01)


def test_streams_that_meet_form_lanes():
    """Yamori's band index: of neighbours ahead and behind, more walk the same way after half a minute than at first."""
    random = np.random.default_rng(3)
    length, count = 20.0, 60
    floor = ground([box(-9, -2.5, 29, -2), box(-9, 2, 29, 2.5)], (-6, -3), (26, 3))
    spots = np.array([((k // 5 + 0.5) * length / 12, -1.6 + 0.8 * (k % 5)) for k in range(count)])
    walkers = Walkers.at(floor, spots + random.normal(0, 0.05, spots.shape), 1.34, 0.2)
    walkers.wanted[:, 0] = np.where(random.permutation(count) % 2 == 0, 1.0, -1.0)

    def order():
        i, j = neighbours(walkers.position, 2.0)
        apart = np.abs(walkers.position[i] - walkers.position[j])
        row = (apart[:, 1] < 0.4) & (apart[:, 0] > 0.3)
        return float((walkers.wanted[i[row], 0] == walkers.wanted[j[row], 0]).mean())

    begin = order()
    for _ in range(60 * 30):
        left, right = walkers.position[:, 0] < 3.0, walkers.position[:, 0] > length - 3.0
        ghosts = int(left.sum() + right.sum())
        others = Others(
            np.concatenate([walkers.position[left] + (length, 0), walkers.position[right] - (length, 0)]),
            np.concatenate([walkers.velocity[left], walkers.velocity[right]]),
            np.full(ghosts, 0.2),
            np.ones((count, ghosts), dtype=bool),
        )
        walkers.step(TICK, SocialForce(), others)
        walkers.position[:, 0] %= length
    assert begin < 0.65
    assert order() > begin + 0.15


def test_a_group_stays_together():
    floor = ground([], (-5, -10), (60, 10))
    distances = []
    for group in (0, -1):
        walkers = Walkers.at(floor, np.array([(0.0, 0.0), (0.0, 3.0)]), 1.3, 0.2)
        walkers.group[:] = group
        walkers.wanted[:, 0] = 1.0
        for _ in range(60 * 20):
            walkers.step(TICK, SocialForce())
        distances.append(math.dist(*walkers.position))
    assert distances[0] < 1.6
    assert distances[1] > 2.5


def test_neighbours_by_cells_are_those_of_all_pairs():
    random = np.random.default_rng(0)
    for count, reach in ((1, 1.0), (40, 0.7), (200, 2.5)):
        points, others = random.uniform(-9, 9, (count, 2)), random.uniform(-12, 12, (30, 2))
        apart = np.linalg.norm(points[:, None] - points[None], axis=2)
        expected = {(int(i), int(j)) for i, j in np.argwhere(apart < reach) if i != j}
        assert set(zip(*map(np.ndarray.tolist, neighbours(points, reach)), strict=True)) == expected
        apart = np.linalg.norm(points[:, None] - others[None], axis=2)
        found = set(zip(*map(np.ndarray.tolist, neighbours(points, reach, others)), strict=True))
        assert found == {(int(i), int(j)) for i, j in np.argwhere(apart < reach)}


def test_the_way_around_a_wall_has_its_length():
    """Around the end of a wall: two legs of a triangle, and a tenth of detour at most for the room that people keep."""
    floor = ground([box(-0.1, -20, 0.1, 4)], (-8, -8), (8, 8))
    way = floor.way_to(floor.cells_in(box(4.9, -0.1, 5.1, 0.1)))
    shortest = 2.0 * math.hypot(5.0, 4.2)
    assert shortest < floor.time(way, np.array([(-5.0, 0.0)]))[0] < 1.1 * shortest
    assert floor.heading(way, np.array([(-3.0, -4.0)]))[0, 1] > 0.5


def test_polygons():
    square = box(0, 0, 2, 1)
    assert distance_to(square, np.array([(3.0, 0.5), (1.0, 0.5), (3.0, 2.0)])) == pytest.approx(
        [1.0, -0.5, math.sqrt(2)]
    )
    assert inside(square, np.array([(1.0, 0.5), (3.0, 0.5)])).tolist() == [True, False]
    points = np.array([(0, 0), (2, 0), (1, 0.5), (2, 1), (0, 1), (1, 0)], dtype=float)
    assert sorted(map(tuple, hull(points).tolist())) == sorted(map(tuple, square.tolist()))
    ((distance, place, out),) = ways_out(square, np.array([3.0, 0.5]))
    assert (distance, place.tolist(), out.tolist()) == (1.0, [2.0, 0.5], [1.0, 0.0])
    distance, _, out = ways_out(square, np.array([1.9, 0.5]))[0]
    assert distance == pytest.approx(-0.1)
    assert out.tolist() == [1.0, 0.0]


@pytest.mark.parametrize("region", REGIONS, ids=lambda region: region.name)
@pytest.mark.parametrize("robot", [5.0, 60.0, math.inf])
def test_the_peak_of_an_impact_is_that_of_iso_ts_15066(region, robot):
    """F = v sqrt(mu k), A.3.4, of a free impact, and the momentum is that of an elastic one: 2 mu v."""
    body, speed = 75.0, 0.5
    reduced = 1.0 / (1.0 / body + (0.0 if math.isinf(robot) else 1.0 / robot))
    overlap, closing, peak, total = 0.0, speed, 0.0, 0.0
    for _ in range(200):
        impulse, force, _ = press(overlap, closing, TICK, region, robot, body)
        # the bodies move as the impulse says, by the rule of the engine
        overlap += TICK * (closing - 0.5 * impulse / reduced)
        closing -= impulse / reduced
        peak, total = max(peak, force), total + impulse
        if overlap < 0.0 and closing < 0.0:
            break
    assert peak == pytest.approx(speed * math.sqrt(reduced * region.stiffness), rel=0.2)
    assert total == pytest.approx(2.0 * reduced * speed, rel=0.2)


def test_regions_are_those_that_a_height_reaches():
    assert [one.name for one in regions(0.0, 0.3, 1.75)] == ["lower legs"]
    assert [one.name for one in regions(0.0, 0.7, 1.75)] == ["lower legs", "thighs and knees"]
    assert [one.name for one in regions(1.3, 1.35, 1.75)] == ["chest"]
    assert regions(2.0, 3.0, 1.75) == ()


def test_steps_have_the_walk_ratio():
    """At 1.34 m/s: steps of 0.72 m, as Weidmann has 0.71 m to 0.75 m; and two feet that are never both in the air."""
    gait = Gait.at(np.zeros((1, 2)), np.array([[1.0, 0.0]]), np.array([1.72]), np.zeros(1, dtype=bool), np.zeros(1))
    velocity, position = np.array([[1.34, 0.0]]), np.zeros((1, 2))
    heights = []
    for _ in range(60 * 10):
        position = position + TICK * velocity
        gait.step(TICK, position, velocity, np.zeros((1, 2)), np.zeros(1, dtype=bool))
        soles, _ = gait.poses(position, np.ones(1, dtype=bool), np.zeros((1, 3)))
        heights.append(min(soles[1:, 2]))
    assert gait.phase[0] == pytest.approx(13.4 / 0.72, rel=0.05)
    assert np.abs(heights).max() < 0.02


def test_feet_do_not_slide_or_jump_however_people_walk_stop_and_turn():
    """40 people whose speeds change at random: a foot on the ground stays, and no foot is faster than 7 m/s."""
    rng, count = np.random.default_rng(3), 40
    height, nobody = rng.uniform(1.1, 1.9, count), np.zeros(count, dtype=bool)
    gait = Gait.at(
        np.zeros((count, 2)), np.tile([1.0, 0.0], (count, 1)), height, nobody, np.floor(8 * rng.random(count))
    )
    position, velocity, wanted = (np.zeros((count, 2)) for _ in range(3))
    before = None
    for tick in range(60 * 20):
        if tick % 45 == 0:
            changes, angle = rng.random(count) < 0.3, rng.uniform(-np.pi, np.pi, count)
            speed = rng.choice([0.0, 0.0, 0.1, 0.3, 0.8, 1.3, 1.8], count)
            wanted[changes] = (speed * np.array([np.cos(angle), np.sin(angle)])).T[changes]
        velocity = velocity + (wanted - velocity) * TICK / 0.5
        position = position + velocity * TICK
        # four of them sit down and get up again
        wanted[:4] *= tick < 600 or tick > 960
        sits = nobody | ((np.arange(count) < 4) & (tick > 600) & (tick < 900))
        position[sits], velocity[sits] = position[sits] - velocity[sits] * TICK, 0.0
        gait.step(TICK, position, velocity, wanted, sits)
        places, _ = gait.poses(position, ~nobody, np.zeros((count, 3)))
        trunk, soles = places[:count, 2], np.stack([places[count : 2 * count], places[2 * count :]], axis=1)
        assert soles[:, :, 2].min(axis=1).max() < 0.01
        if before is not None:
            moved = np.linalg.norm(soles - before[1], axis=2)
            stands = np.maximum(soles, before[1])[:, :, 2] < 0.003
            assert moved[stands].max(initial=0.0) < 0.005
            assert moved.max() < 7.0 * TICK
            assert np.abs(trunk - before[0]).max() < 0.04
        before = trunk.copy(), soles


def test_a_robot_without_shapes_has_no_footprint():
    from morse.scene import Node

    assert footprint(Node("nothing"), []) is None
