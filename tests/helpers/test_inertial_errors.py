"""The errors of inertial sensors against the Allan deviations of their terms (IEEE Std 952-1997)."""

import math

import numpy as np
import pytest

from morse.sensors.imu import ErrorTerms, InertialErrors


def record(terms, count, step, seed=5):
    """(N, 3) measurements at rest."""
    errors = InertialErrors(np.random.default_rng(seed), terms)
    return np.array([errors.added((0.0, 0.0, 0.0), step) for _ in range(count)])


def allan_deviation(values, step, tau):
    """Overlapping, of all axes together."""
    length = round(tau / step)
    sums = np.cumsum(np.vstack([np.zeros((1, values.shape[1])), values]), axis=0) * step
    second = sums[2 * length :] - 2.0 * sums[length:-length] + sums[: -2 * length]
    return math.sqrt(float((second**2).mean()) / (2.0 * tau**2))


@pytest.mark.parametrize("step", [0.01, 0.02])
def test_white_noise_is_the_density_at_a_second_whatever_the_rate(step):
    values = record(ErrorTerms((2e-3,) * 3, 0.0, 0.0, 100.0), 40_000, step)
    for tau in (0.1, 1.0):
        # Allan deviation of white noise: N / sqrt(tau)
        assert allan_deviation(values, step, tau) == pytest.approx(2e-3 / math.sqrt(tau), rel=0.06)


def test_bias_instability_is_the_largest_allan_deviation_of_the_bias():
    step, time = 0.1, 1.0
    values = record(ErrorTerms((0.0,) * 3, 3e-4, 0.0, time), 120_000, step)
    found = {tau: allan_deviation(values, step, tau) for tau in (0.2, 1.0, 1.9, 4.0, 20.0)}
    assert max(found, key=found.get) == 1.9
    assert found[1.9] == pytest.approx(3e-4, rel=0.06)


def test_random_walk_of_the_bias():
    values = record(ErrorTerms((0.0,) * 3, 0.0, 1e-3, 100.0), 60_000, 0.1)
    for tau in (1.0, 10.0):
        # Allan deviation of a random walk: K sqrt(tau / 3)
        assert allan_deviation(values, 0.1, tau) == pytest.approx(1e-3 * math.sqrt(tau / 3.0), rel=0.08)


def test_they_go_on_from_a_state():
    terms = ErrorTerms((1e-3,) * 3, 1e-3, 1e-3, 10.0)
    one, other = (InertialErrors(np.random.Generator(np.random.PCG64(seed)), terms) for seed in (1, 2))
    one.added((0.0, 0.0, 0.0), 0.1)
    other.set_state(one.get_state())
    assert one.added((1.0, 2.0, 3.0), 0.1) == other.added((1.0, 2.0, 3.0), 0.1)
