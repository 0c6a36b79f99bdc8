"""Sensor noise: mean, standard deviation and repetition, in linear light."""

import numpy as np
import pytest

from morse.rendering.picture import Chip, exposed
from morse.rendering.textures import LIGHT, encoded


def generators(seed=1):
    return np.random.default_rng(seed), np.random.default_rng(99)


def flat(code, size=200):
    return np.full((size, size, 3), code, np.uint8)


@pytest.mark.parametrize("code", [120, 160, 200])
def test_shot_noise_is_the_square_root_of_the_electrons(code):
    electrons = 2000.0
    light = LIGHT[exposed(Chip(full_well=electrons), flat(code), *generators())]
    mean = float(LIGHT[code])
    assert light.mean() == pytest.approx(mean, rel=0.01)
    # sigma of n electrons is sqrt(n): in units of the full well sqrt(mean / electrons); quantization adds a little
    assert light.std() == pytest.approx(np.sqrt(mean / electrons), rel=0.05)


def test_read_noise_does_not_depend_on_the_light():
    for code in (140, 220):
        light = LIGHT[exposed(Chip(read_noise=0.02), flat(code), *generators())]
        assert light.std() == pytest.approx(0.02, rel=0.05)


def test_stuck_pixels_stay_where_they_are():
    chip, picture = Chip(stuck=0.02), flat(128)
    first, second = (exposed(chip, picture, np.random.default_rng(i), np.random.default_rng(99)) for i in (1, 2))
    np.testing.assert_array_equal(first, second)
    black, white = (first == 0).all(axis=2).mean(), (first == 255).all(axis=2).mean()
    assert black == pytest.approx(0.01, rel=0.3)
    assert white == pytest.approx(0.01, rel=0.3)
    assert (first == 128).all(axis=2).mean() == pytest.approx(0.98, abs=0.005)


def test_a_perfect_chip_changes_nothing():
    picture = flat(77, 20)
    assert exposed(Chip(), picture, *generators()) is picture


def test_codes_and_light_are_each_others_inverse():
    np.testing.assert_array_equal(encoded(LIGHT), np.arange(256))
    np.testing.assert_array_equal(encoded(np.float32([-1.0, 0.0, 1.0, 9.0])), [0, 0, 255, 255])
