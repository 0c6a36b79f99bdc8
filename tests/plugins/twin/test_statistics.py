"""Statistics against their known values, and against evo."""

import math

import numpy as np
import pytest

from morse.plugins.twin.comparison import noise_of, persistence
from morse.plugins.twin.statistics import (
    Trajectory,
    absolute_error,
    aligned,
    allan,
    relative_error,
    rms,
    rotations_of,
    spectrum,
)

RATE = 100.0


def slopes(found, low, high):
    part = (found.times >= low) & (found.times <= high)
    return np.polyfit(np.log(found.times[part]), np.log(found.deviations[part]), 1)[0]


def test_white_noise_has_the_slope_of_minus_a_half():
    """σ(τ) = N / sqrt(τ), with the density N: σ sqrt(2 / rate) one-sided is N = s / sqrt(rate) here (IEEE Std 952)."""
    values = np.random.default_rng(1).normal(0.0, 0.3, 60_000)
    found = allan(values, RATE)
    assert slopes(found, 0.02, 5.0) == pytest.approx(-0.5, abs=0.03)
    assert found.white == pytest.approx(0.3 / math.sqrt(RATE), rel=0.05)


def test_a_random_walk_has_the_slope_of_a_half():
    """σ(τ) = K sqrt(τ / 3)."""
    walk = np.cumsum(np.random.default_rng(2).normal(0.0, 0.02 / math.sqrt(RATE), 60_000))
    found = allan(walk, RATE)
    assert slopes(found, 0.1, 10.0) == pytest.approx(0.5, abs=0.06)
    part = (found.times > 0.5) & (found.times < 5.0)
    assert found.deviations[part] == pytest.approx(0.02 * np.sqrt(found.times[part] / 3.0), rel=0.2)


def test_a_short_signal_has_no_allan_deviation():
    assert allan(np.zeros(99), RATE) is None


def test_the_spectrum_has_the_power_of_the_signal():
    """Parseval: the integral of the density is the variance."""
    values = np.random.default_rng(3).normal(0.0, 2.0, 40_000)
    frequencies, power = spectrum(values, RATE)
    assert np.sum(power) * (frequencies[1] - frequencies[0]) == pytest.approx(4.0, rel=0.03)
    sine = np.sin(2.0 * math.pi * 12.5 * np.arange(8192) / RATE)
    frequencies, power = spectrum(sine, RATE)
    assert frequencies[np.argmax(power)] == pytest.approx(12.5, abs=0.1)


def test_noise_is_found_beside_a_smooth_motion():
    rng = np.random.default_rng(4)
    motion = 5.0 * np.sin(np.arange(3000) / 100.0)
    assert noise_of(motion + rng.normal(0.0, 0.1, 3000)) == pytest.approx(0.1, rel=0.08)


def test_errors_that_last_count_once():
    rng = np.random.default_rng(5)
    white = rng.normal(size=4000)
    assert persistence(white) == pytest.approx(1.0, abs=0.2)
    # a first-order process with the coefficient a: (1 + a) / (1 - a)
    errors = [0.0]
    for step in white:
        errors.append(0.8 * errors[-1] + step)
    assert persistence(np.array(errors)) == pytest.approx(9.0, rel=0.35)


def paths():
    rng = np.random.default_rng(6)
    times = np.arange(200) / 10.0
    yaw, zero = 0.3 * times, np.zeros(200)
    true = Trajectory(times, np.stack([np.cos(yaw), np.sin(yaw), 0.1 * times], axis=1), rotations_of(zero, zero, yaw))
    angles = [rng.normal(0.0, 0.02, 200) for _ in range(3)]
    off = rotations_of(angles[0], angles[1], yaw + angles[2] + 0.2)
    return true, Trajectory(times, true.positions + rng.normal(0.0, 0.05, (200, 3)) + [1.0, 0.0, 0.0], off)


def test_a_motion_of_the_whole_is_aligned():
    true, _ = paths()
    turn = rotations_of(*(np.array([angle]) for angle in (0.1, -0.2, 2.0)))[0]
    rotation, shift = aligned(true.positions @ turn.T + [1.0, 2.0, 3.0], true.positions)
    assert rotation == pytest.approx(turn.T, abs=1e-9)
    assert shift == pytest.approx(-turn.T @ [1.0, 2.0, 3.0], abs=1e-9)


def test_errors_of_trajectories_are_those_of_evo():
    metrics = pytest.importorskip("evo.core.metrics")
    trajectory = pytest.importorskip("evo.core.trajectory")
    true, off = paths()

    def of_evo(path):
        poses = np.tile(np.eye(4), (len(path.times), 1, 1))
        poses[:, :3, :3], poses[:, :3, 3] = path.rotations, path.positions
        return trajectory.PoseTrajectory3D(poses_se3=list(poses), timestamps=path.times)

    ape = metrics.APE(metrics.PoseRelation.translation_part)
    ape.process_data((of_evo(true), of_evo(off)))
    assert absolute_error(off, true) == pytest.approx(ape.error)
    moved = of_evo(off)
    moved.align(of_evo(true))
    ape.process_data((of_evo(true), moved))
    assert rms(absolute_error(off, true, align=True)) == pytest.approx(ape.get_statistic(metrics.StatisticsType.rmse))
    rpe = metrics.RPE(metrics.PoseRelation.translation_part, 10, metrics.Unit.frames, all_pairs=True)
    rpe.process_data((of_evo(true), of_evo(off)))
    assert relative_error(off, true, 10) == pytest.approx(rpe.error)
