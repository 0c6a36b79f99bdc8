"""Water: the C function equals its twin in Python, to the bit."""

import math
from ctypes import byref

import numpy as np

from morse.kernel.water import WaterValues
from tests.kernel.twins import water


def some_water(seed, **given):
    chance = np.random.default_rng(seed)
    values = WaterValues(
        depth=chance.uniform(-2, 2), half=chance.uniform(0.1, 1), lift=chance.uniform(0, 100), most=chance.uniform(0, 9)
    )
    values.bob = (seed % 2) * 7.3
    if seed % 3 == 0:
        values.swell[:], values.rise[:] = chance.normal(size=4), chance.normal(size=4)
    for name in ("centre", "drag", "up", "linear", "angular"):
        getattr(values, name)[:] = chance.normal(size=3)
    for cell in values.cells:
        cell[:] = chance.normal(size=3)
    for name, value in given.items():
        setattr(values, name, value)
    return values


def results(values):
    return [*values.force, *values.torque]


def test_both_give_the_same_bits(build):
    for seed in range(200):
        mine, theirs = some_water(seed), some_water(seed)
        build.morse_water(byref(mine))
        water.push(theirs)
        assert results(mine) == results(theirs)


def test_a_submerged_box_is_lifted_by_all_its_cells_and_slowed_by_the_square_of_its_speed():
    values = some_water(1, depth=100.0, half=0.5, lift=10.0, most=math.inf)
    values.up[:], values.angular[:], values.drag[:], values.linear[:] = (0, 0, 1), (0, 0, 0), (2, 3, 4), (3, -1, 0)
    water.push(values)
    assert list(values.force) == [-2.0 * 3.0**2, 3.0 * 1.0**2, 8 * 10.0]
