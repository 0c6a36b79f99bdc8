"""The kernel of people who walk against its twin in numpy, and against known distances."""

import numpy as np
import pytest
from twins import walking as twin

from morse.kernel import walking

TURNED = np.array([(np.cos(a), np.sin(a)) for a in np.radians([-12.0, 12.0, -36.0, 36.0, -84.0, 84.0])])


def people(seed, count=40, pairs=300):
    """Arguments of `directions`: people in a hall with random walls."""
    random = np.random.default_rng(seed)
    apart = random.normal(0.0, 1.0, (pairs, 2))
    angle = random.uniform(0.0, 6.28, count)
    wanted = np.stack([np.cos(angle), np.sin(angle)], axis=1) * (random.random(count) < 0.8)[:, None]
    return [
        random.integers(0, count, pairs),
        *(apart, random.normal(0.0, 1.0, (pairs, 2)), np.sqrt((apart * apart).sum(axis=1)), np.full(pairs, 0.4)),
        *(random.uniform(-1.0, 9.0, (count, 2)), wanted, random.uniform(0.5, 2.0, count), np.full(count, 0.15)),
        *(random.random(count) < 0.9, random.uniform(0.0, 2.0, (40, 60)), np.array([0.0, 0.0]), 0.1, 3.0, TURNED),
    ]


@pytest.mark.parametrize("seed", range(5))
def test_directions_are_those_of_the_twin_bit_by_bit(seed):
    given = people(seed)
    assert (walking.directions(*given) == twin.directions(*given)).all()


def test_nobody_and_what_is_no_number():
    assert walking.directions(*people(0, 0, 0)).shape == (0, 2)
    given = people(1)
    given[5][:3], given[5][3] = np.nan, 1e300
    given[1][:5] = np.inf
    found = walking.directions(*given)
    assert np.isfinite(found).all()


def test_people_who_do_not_exist_and_arrays_of_other_shapes_are_refused():
    given = people(2)
    with pytest.raises(ValueError, match="numbers 0 to 39"):
        walking.directions(given[0] + 39, *given[1:])
    with pytest.raises(ValueError, match="shape"):
        walking.directions(given[0], given[1][:-1], *given[2:])


def hall(height, width, seed=None):
    """Times, free cells and slowness of a hall; with a seed, with random walls."""
    free = np.zeros((height, width), dtype=bool)
    free[1:-1, 1:-1] = True
    slowness = np.full((height, width), 0.1)
    if seed is not None:
        random = np.random.default_rng(seed)
        free &= random.random((height, width)) < 0.8
        slowness *= random.uniform(1.0, 2.5, (height, width))
    return np.full((height, width), np.inf), free, slowness


@pytest.mark.parametrize("seed", range(5))
def test_arrivals_are_those_of_the_twin_bit_by_bit(seed):
    (time, free, slowness), (other, _, _) = hall(30, 40, seed), hall(30, 40)
    seeds = np.flatnonzero(free)[[3, 200]]
    for one in (time, other):
        one.ravel()[seeds] = 0.0
    walking.arrival(time, free, slowness, seeds)
    twin.arrival(other, free, slowness, seeds)
    assert (time == other).all()
    assert np.isfinite(time).sum() > 300


def test_arrival_in_the_open_is_the_distance():
    time, free, slowness = hall(101, 101)
    time[50, 50] = 0.0
    walking.arrival(time, free, slowness, np.array([50 * 101 + 50]))
    row, column = np.mgrid[1:100, 1:100]
    far = 0.1 * np.hypot(row - 50, column - 50)
    # the scheme is of first order: its error grows with the logarithm of the distance in cells
    assert np.abs(time[1:-1, 1:-1] - far).max() < 0.25
    assert time[50, 99] == pytest.approx(4.9)
    assert np.isinf(time[0]).all()


def test_a_grid_whose_edge_is_free_is_refused():
    time, free, slowness = hall(5, 5)
    free[0, 2] = True
    with pytest.raises(ValueError, match="edges"):
        walking.arrival(time, free, slowness, np.array([12]))
    with pytest.raises(ValueError, match="edge"):
        walking.arrival(time, hall(5, 5)[1], slowness, np.array([2]))
    with pytest.raises(ValueError, match="cells 0 to 24"):
        walking.arrival(time, hall(5, 5)[1], slowness, np.array([25]))


@pytest.mark.parametrize("corners", [1, 2, 4, 9])
def test_distances_to_walls_are_those_of_the_twin_bit_by_bit(corners):
    random = np.random.default_rng(corners)
    one, other = np.full((50, 60), 3.0), np.full((50, 60), 3.0)
    for _ in range(20):
        angle = np.linspace(0.0, 2.0 * np.pi, corners, endpoint=False)
        polygon = random.uniform(0.0, 5.0, 2) + random.uniform(0.1, 1.5) * np.stack(
            [np.cos(angle), np.sin(angle)], axis=1
        )
        part = slice(3, 50), slice(0, 58)
        walking.wall(one, polygon, *part, np.array([-0.3, 0.2]), 0.1)
        twin.wall(other, polygon, *part, np.array([-0.3, 0.2]), 0.1)
    assert (one == other).all()


def test_distances_to_a_square_are_those_of_geometry():
    gap = np.full((60, 60), 3.0)
    walking.wall(
        gap, np.array([(2.0, 2.0), (4.0, 2.0), (4.0, 4.0), (2.0, 4.0)]), slice(0, 60), slice(0, 60), np.zeros(2), 0.1
    )
    assert gap[30, 30] == pytest.approx(-1.0)
    assert gap[30, 10] == pytest.approx(1.0)
    assert gap[10, 10] == pytest.approx(2.0**0.5)
    with pytest.raises(ValueError, match="corners"):
        walking.wall(gap, np.zeros((1, 2)), slice(0, 61), slice(0, 60), np.zeros(2), 0.1)
