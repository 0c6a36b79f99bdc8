"""The bounds of the blocks of a shadow map: two planes with all texels that are read for a point of the block."""

import numpy as np
import pytest
from kernel_drawings import RandomDrawing

from morse.kernel.drawing.arrays import NO_SURFACE, bounds_for
from morse.kernel.drawing.native import NativeDrawer

SIDE, READ = 8, 4
ROWS, COLUMNS = 45, 60


def ramp(across, down):
    y, x = np.mgrid[0:ROWS, 0:COLUMNS]
    return (2.0 + across * x + down * y).astype(np.float32)


def steps(rng):
    made = ramp(0.02, -0.03)
    made[10:30, 7:41] += 3.0
    made[rng.random(made.shape) < 0.05] += 1.0
    made[33:, 50:] = NO_SURFACE
    return made


def bounds_of(build, shadow):
    made = RandomDrawing(1)
    light = made.light()._replace(shadow=shadow, shadow_bounds=bounds_for(shadow))
    NativeDrawer(build, made.drawing).bound_shadows(light)
    return light.shadow_bounds


def planes(bounds):
    """The lower and the upper bound at each texel from which a window of 4 x 4 texels begins."""
    y, x = np.mgrid[0 : ROWS - READ + 1, 0 : COLUMNS - READ + 1]
    across, down, low, high = np.moveaxis(bounds[y // SIDE, x // SIDE], -1, 0)
    rise = across * (x % SIDE) + down * (y % SIDE)
    return rise + low, rise + high


def windows(shadow):
    return np.lib.stride_tricks.sliding_window_view(shadow, (READ, READ))


@pytest.mark.parametrize("seed", range(3))
def test_all_texels_of_a_window_are_between_the_planes(build, seed):
    shadow = steps(np.random.default_rng(seed))
    low, high = planes(bounds_of(build, shadow))
    assert (windows(shadow).min(axis=(2, 3)) >= low).all()
    assert (windows(shadow).max(axis=(2, 3)) <= high).all()


def test_the_planes_touch_the_texels_of_an_inclined_surface(build):
    shadow = ramp(-0.04, 0.03)
    low, high = planes(bounds_of(build, shadow))
    np.testing.assert_allclose(low, windows(shadow).min(axis=(2, 3)), atol=1e-4)
    np.testing.assert_allclose(high, windows(shadow).max(axis=(2, 3)), atol=1e-4)


def test_the_smallest_maps_have_no_bounds():
    assert bounds_for(np.zeros((15, 40), np.float32)) is None
