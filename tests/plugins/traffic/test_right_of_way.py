"""Right of way: nobody collides or waits for ever, those with priority need not brake, and people cross on zebras."""

import math

import numpy as np
import pytest

from morse.builder import Traffic
from morse.plugins.traffic.crossings import lines
from morse.plugins.traffic.roads import Road
from tests.kit.scenes import Load

ARMS = """
cars = Traffic("cars", deviation=0.08, acceleration=1.4)
cars.road("westward", [(70, 1.75), (-70, 1.75)], {west}, speed=11.0)
cars.road("eastward", [(-70, -1.75), (70, -1.75)], {east}, speed=11.0)
cars.road("southward", [(-1.75, 70), (-1.75, -70)], {count}, speed=11.0)
cars.road("northward", [(1.75, -70), (1.75, 70)], {count}, speed=11.0)
cars.right_of_way("westward", "eastward", "southward", "northward", first={first})
env = Environment("empty")
env.simulator_frequency({rate})
"""
#: m: half of the width of a car
HALF = 0.9


def closest(cars) -> float:
    """The smallest distance between the axes of two cars on a road, m; below twice `HALF`, they would overlap."""
    data = cars.data
    there = data["present"]
    places, speeds = data["positions"][there, :2], cars.component._ways[there]
    # axes of 4.6 m less the half width at both ends, as points 0.2 m apart
    along = np.linspace(-2.3 + HALF, 2.3 - HALF, 15)
    points = places[:, None, :] + along[None, :, None] * speeds[:, None, :]
    apart = np.sqrt(((points[:, None, :, None] - points[None, :, None, :]) ** 2).sum(-1)).min((2, 3))
    np.fill_diagonal(apart, np.inf)
    return float(apart.min(initial=np.inf))


@pytest.mark.slow
@pytest.mark.parametrize(("first", "west", "east"), [("()", 4, 4), ("('westward', 'eastward')", 2, 1)])
def test_four_arms_have_no_collision_and_no_deadlock_for_ten_minutes(load: Load, first: str, west: int, east: int):
    """With priority, the main road has gaps of 7 s, or nobody of the other one could ever pass."""
    simulation = load(ARMS.format(west=west, east=east, count=4, first=first, rate=10))
    cars, count = simulation.cars, west + east + 8
    passed, before, nearest, longest = np.zeros(count, int), cars.data["places"].copy(), math.inf, np.zeros(count)
    for _ in range(600 * 10):
        simulation.step(1)
        places = cars.data["places"]
        passed += places < before - 50.0
        before = places.copy()
        nearest = min(nearest, closest(cars))
        longest = np.where(cars.data["speeds"] < 0.3, longest + 0.1, 0.0)
        assert longest.max() < 120.0, "a car has waited for two minutes"
    assert nearest > 2 * HALF
    # each car has driven its 140 m many times: of all roads, nobody was left waiting
    assert passed.min() >= 6


def pair(load: Load, rule: str, gap: float):
    """A car 40 m before a crossing, and one on the other road, which arrives from the south, its right."""
    simulation = load(f"""
        cars = Traffic("cars", acceleration=1.4)
        cars.road("eastward", [(-60, 0), (300, 0)], 1, speed=10.0)
        cars.road("northward", [(0, -60), (0, 300)], 1, speed=10.0)
        cars.right_of_way("eastward", "northward"{rule})
        env = Environment("empty")
        env.simulator_frequency(20)
    """)
    cars = simulation.cars.component
    cars.front[:], cars.speed[:] = (20.0, 20.0 - gap), 10.0
    least = np.full(2, np.inf)
    reached = np.full(2, np.inf)
    for tick in range(20 * 20):
        simulation.step(1)
        least = np.minimum(least, np.where(cars.front < 60.0, cars.speed, np.inf))
        reached = np.where((cars.front >= 60.0) & np.isinf(reached), tick / 20, reached)
    return least, reached


@pytest.mark.parametrize("gap", [0.0, 10.0])
def test_who_comes_from_the_right_goes_first_and_need_not_brake(load: Load, gap: float):
    """The Convention on Road Traffic of 1968, article 18, 4a."""
    least, reached = pair(load, "", gap)
    assert least[1] > 9.5
    assert least[0] < 6.0
    assert reached[1] < reached[0]


def test_a_road_with_priority_goes_first_and_need_not_brake(load: Load):
    least, reached = pair(load, ", first=['eastward']", 0.0)
    assert least[0] > 9.5
    assert reached[0] < reached[1]


def test_a_gap_that_is_long_enough_is_used(load: Load):
    """Drivers without priority accept gaps of 6.5 s (Highway Capacity Manual 2010, exhibit 19-10): here, 10 s."""
    _, reached = pair(load, "", 100.0)
    assert reached[0] < reached[1]


def test_nobody_enters_a_crossing_on_which_he_would_have_to_stop(load: Load):
    """Article 18, 5: behind the crossing, a robot blocks the road."""
    simulation = load("""
        cars = Traffic("cars", acceleration=1.4)
        cars.road("eastward", [(-60, 0), (60, 0)], 2, speed=10.0)
        cars.road("northward", [(0, -60), (0, 60)], 2, speed=10.0)
        cars.right_of_way("eastward", "northward", first=["eastward"])
        robot = ATRV()
        robot.translate(7.0, 0.0, 0.2)
        env = Environment("empty")
        env.simulator_frequency(20)
    """)
    cars = simulation.cars.component
    cars.front[:2] = (30.0, 10.0)
    simulation.step(20 * 30)
    # they wait before the crossing, whose roads are 3.5 m wide, and the other road is not blocked
    assert (cars.front[:2] < 60.0 - 1.75).all()
    assert cars.speed[:2].max() < 0.1
    assert cars.speed[2:].max() > 5.0


ZEBRA = """
cars = Traffic("cars", acceleration=1.4)
cars.road("eastward", [(-80, -1.75), (80, -1.75)], 5, speed=10.0)
cars.road("westward", [(80, 1.75), (-80, 1.75)], 5, speed=10.0)
cars.zebra("eastward", 80.0, width=4.0)
cars.zebra("westward", 80.0, width=4.0)
people = Crowd("people", {count})
people.start([(-1.5, -12.0), (1.5, -6.0)], goals=[(0.0, 9.0), (0.0, -9.0)], then="repeat", wait=2.0)
env = Environment("empty")
env.simulator_frequency(30)
"""


def test_people_cross_on_a_zebra_while_cars_wait(load: Load):
    """Article 21, 2b."""
    simulation = load(ZEBRA.format(count=4))
    cars, people = simulation.cars, simulation.people
    nearest, sides = math.inf, np.zeros(4, int)
    before = np.sign(people.data["positions"][:, 1])
    for _ in range(30 * 45):
        simulation.step(1)
        places, axes = cars.data["positions"][:, :2], cars.component._ways
        apart = people.data["positions"][:, None, :2] - places[None]
        along = np.clip((apart * axes).sum(-1), -2.3, 2.3)
        gap = np.sqrt(((apart - along[..., None] * axes) ** 2).sum(-1))[:, cars.data["present"]]
        nearest = min(nearest, float(gap.min()))
        side = np.sign(people.data["positions"][:, 1])
        sides += side != before
        before = side
    # all have crossed, and more than once; no car has touched anybody, and all cars have gone on
    assert sides.min() >= 2
    assert nearest > HALF + 0.2
    assert people.data["exceeded"] == 0
    assert cars.data["speeds"].max() > 3.0


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ("cars.right_of_way('a')", "two or more different roads"),
        ("cars.right_of_way('a', 'a')", "two or more different roads"),
        ("cars.right_of_way('a', 'c')", "there is no road 'c'"),
        ("cars.right_of_way('a', 'b', first='a')", "a list of names"),
        ("cars.right_of_way('a', 'b', first=['c'])", "there is no road 'c'"),
        ("cars.right_of_way('a', 'b'); cars.right_of_way('b', 'a')", "already"),
        ("cars.zebra('c', 5.0)", "there is no road 'c'"),
        ("cars.zebra('a', float('nan'))", "finite"),
        ("cars.zebra('a', 5.0, width=0.0)", "0.5"),
    ],
)
def test_mistakes_are_named(load: Load, call: str, words: str):
    roads = "cars = Traffic()\ncars.road('a', [(0, 0), (50, 0)], 1)\ncars.road('b', [(9, -9), (9, 50)], 1)\n"
    with pytest.raises(Exception, match=words):
        load(f'{roads}{call}\nenv = Environment("empty")')


def test_a_restored_state_passes_the_crossing_in_the_same_order(load: Load):
    simulation = load(ARMS.format(west=3, east=3, count=3, first="()", rate=20))
    simulation.step(20 * 12)
    state = simulation.save()
    simulation.step(20 * 20)
    places = simulation.cars.data["places"].copy()
    simulation.restore(state)
    simulation.step(20 * 20)
    assert (simulation.cars.data["places"] == places).all()


def test_each_crossing_of_a_town_has_a_line_in_each_road_that_waits_for_the_other_one():
    """20 streets at right angles cross 100 times: each line has its one rival, of which one goes first."""
    far = np.arange(1, 11) * 60.0
    streets = [Road(np.array([(0.0, y), (660.0, y)]), 1, 3.5, closed=False) for y in far]
    avenues = [Road(np.array([(x, 0.0), (x, 660.0)]), 1, 3.5, closed=False) for x in far]
    found = lines([*streets, *avenues], [(list(range(20)), [])])
    assert len(found) == 200
    for number, line in enumerate(found):
        ((rival, goes_first),) = line.rivals
        assert found[rival].rivals == ((number, not goes_first),)
        # who drives along +X sees +Y come from the right
        assert goes_first == (line.road < 10)


def test_of_two_lines_that_meet_one_goes_first_whatever_the_shape_of_the_roads():
    """A rival that does not know of the other one would not wait for it."""
    random, pairs = np.random.default_rng(2), 0
    for _ in range(40):
        count = int(random.integers(2, 5))
        shapes = [random.uniform(-60, 60, (int(random.integers(2, 6)), 2)) for _ in range(count)]
        found = lines([Road(one, 1, 3.5, closed=False) for one in shapes], [(list(range(count)), [])])
        goes_first = {(number, rival): first for number, one in enumerate(found) for rival, first in one.rivals}
        assert all(goes_first.get((rival, number)) is not first for (number, rival), first in goes_first.items())
        assert all((rival, number) in goes_first for number, rival in goes_first)
        pairs += len(goes_first)
    assert pairs > 100


def test_lines_beside_their_road_are_refused():
    cars = Traffic("cars")
    cars.road("street", [(0, 0), (100, 0)], 0)
    cars.zebra("street", 100.0)
    for call in (lambda: cars.zebra("street", 100.1), lambda: cars.stop("street", 1e4, "light")):
        with pytest.raises(ValueError, match="'street' is 100 m long"):
            call()
