"""Errors in numbers: noise, spectra, Allan deviations, errors of trajectories."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

#: number of averaging times of an Allan deviation, for each factor of 10; and the fewest clusters of the longest one
_PER_DECADE, _FEWEST = 8, 9
#: the bias instability is the lowest Allan deviation divided by this, sqrt(2 ln 2 / pi) (IEEE Std 952-1997, C.1.3)
_FLICKER = 0.664


class Allan(NamedTuple):
    """The Allan deviation of a signal.

    Attributes:
        times: (T,) averaging times, s.
        deviations: (T,) in the unit of the signal.
        white: density of the white noise, unit/√Hz: the fit with the slope -1/2, at 1 s.
        walk: of the random walk, unit/√s: the fit with the slope +1/2, at 3 s.
        instability: of the bias, in the unit of the signal: the lowest deviation divided by 0.664.
    """

    times: Floats
    deviations: Floats
    white: float
    walk: float
    instability: float


def allan(values: Floats, rate: float) -> Allan | None:
    """The overlapping Allan deviation; None for fewer than 100 samples.

    With the integral x of the signal, averages over τ = m / rate have the variance
    sum (x[k + 2m] - 2 x[k + m] + x[k])² / (2 τ² (N - 2m)) (IEEE Std 1139-2008; Riley, NIST SP 1065, 5.2.4).

    Args:
        values: (N,) the signal at a constant rate.
        rate: Hz.
    """
    count = len(values)
    if count < 100:
        return None
    integral = np.concatenate(([0.0], np.cumsum(values))) / rate
    most = count // _FEWEST
    sizes = np.unique(np.logspace(0.0, math.log10(most), 1 + int(_PER_DECADE * math.log10(most))).astype(int))
    deviations = []
    for size in sizes:
        second = integral[2 * size :] - 2.0 * integral[size:-size] + integral[: -2 * size]
        deviations.append(math.sqrt(float(np.mean(second**2)) / 2.0) * rate / size)
    times, found = sizes / rate, np.array(deviations)
    found = np.maximum(found, 1e-300)
    return Allan(
        times,
        found,
        _at_slope(times, found, -0.5, 1.0, first=True),
        # σ(τ) = K sqrt(τ / 3): the value at 3 s
        _at_slope(times, found, 0.5, 3.0, first=False),
        float(found.min()) / _FLICKER,
    )


def _at_slope(times: Floats, deviations: Floats, slope: float, at: float, *, first: bool) -> float:
    """The value at a time of a line with a slope through the points whose local slope is near; 0 for none.

    Args:
        first: whether it is fitted to the first half of these points; otherwise to the last half.
    """
    x, y = np.log(times), np.log(deviations)
    local = np.gradient(y, x)
    near = np.flatnonzero(np.abs(local - slope) < 0.2)
    if len(near) < 3:
        return 0.0
    part = near[: max(3, len(near) // 2)] if first else near[-max(3, len(near) // 2) :]
    return float(math.exp(np.mean(y[part] - slope * x[part]) + slope * math.log(at)))


def spectrum(values: Floats, rate: float) -> tuple[Floats, Floats]:
    """Frequencies, Hz, and the power spectral density of a signal, unit²/Hz (Welch: Hann windows, half overlapping)."""
    size = min(1024, 1 << int(math.log2(max(len(values), 8))) - 1)
    window = np.hanning(size + 1)[:-1]
    starts = range(0, len(values) - size + 1, size // 2)
    parts = np.array([values[start : start + size] for start in starts]) if len(values) >= size else np.zeros((1, size))
    parts = (parts - parts.mean(axis=1, keepdims=True)) * window
    power = np.mean(np.abs(np.fft.rfft(parts, axis=1)) ** 2, axis=0) * 2.0 / (rate * float(np.sum(window**2)))
    return np.asarray(np.fft.rfftfreq(size, 1.0 / rate)[1:]), np.asarray(power[1:])


class Trajectory(NamedTuple):
    """Positions and headings.

    Attributes:
        times: (N,) s.
        positions: (N, 3) m.
        rotations: (N, 3, 3).
    """

    times: Floats
    positions: Floats
    rotations: Floats


def rotations_of(roll: Floats, pitch: Floats, yaw: Floats) -> Floats:
    """(N, 3, 3) rotations of angles, rad: Rz(yaw) Ry(pitch) Rx(roll)."""
    cr, sr, cp, sp, cy, sy = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch), np.cos(yaw), np.sin(yaw)
    rows = (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def aligned(moving: Floats, fixed: Floats) -> tuple[Floats, Floats]:
    """The rotation and translation that bring points nearest to others (Umeyama 1991, without scale).

    Args:
        moving, fixed: (N, 3).
    """
    one, other = moving.mean(axis=0), fixed.mean(axis=0)
    left, _, right = np.linalg.svd((fixed - other).T @ (moving - one))
    signs = np.diag([1.0, 1.0, np.sign(np.linalg.det(left) * np.linalg.det(right)) or 1.0])
    rotation = left @ signs @ right
    return rotation, other - rotation @ one


def absolute_error(one: Trajectory, other: Trajectory, *, align: bool = False) -> Floats:
    """The distances between positions at the same times, m: the absolute pose error (Sturm et al. 2012).

    Args:
        align: whether the first trajectory is first moved as a whole to be nearest to the other one.
    """
    positions = one.positions
    if align:
        rotation, shift = aligned(positions, other.positions)
        positions = positions @ rotation.T + shift
    return np.asarray(np.linalg.norm(positions - other.positions, axis=1))


def relative_error(one: Trajectory, other: Trajectory, frames: int) -> Floats:
    """The errors of the motions over a number of samples, m: the relative pose error (Sturm et al. 2012)."""

    def motions(path: Trajectory) -> tuple[Floats, Floats]:
        before, after = slice(None, -frames), slice(frames, None)
        back = np.swapaxes(path.rotations[before], 1, 2)
        return back @ path.rotations[after], np.einsum(
            "nij,nj->ni", back, path.positions[after] - path.positions[before]
        )

    (turn, shift), (_, other_shift) = motions(other), motions(one)
    # inverse of the one times the other
    return np.asarray(np.linalg.norm(np.einsum("nji,nj->ni", turn, other_shift - shift), axis=1))


def rms(values: Floats) -> float:
    """The root of the mean of the squares of finite values."""
    finite = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(finite**2))) if len(finite) else math.nan
