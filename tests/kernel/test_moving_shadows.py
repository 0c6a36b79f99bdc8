"""The shadows of parts that move: equal to those of a map that is drawn anew, in C and in numpy."""

from __future__ import annotations

import numpy as np
import pytest
from kernel_drawings import RandomDrawing

from morse.kernel.drawing.arrays import NO_SURFACE, bounds_for
from morse.kernel.drawing.native import NativeDrawer
from morse.kernel.drawing.reference import ReferenceDrawer

MOVERS, STILL = np.array([1, 2, 4]), np.array([0, 3])


def empty(light):
    shadow = np.full(light.shadow.shape, NO_SURFACE, np.float32)
    return light._replace(shadow=shadow, shadow_bounds=bounds_for(shadow))


def begun(drawer, made, light):
    """The shadows of the movers in a map that shows the other parts."""
    light = empty(light)
    drawer.cast_shadows(STILL, made.poses, light)
    drawer.bound_shadows(light)
    return light, drawer.moving_shadows(MOVERS, light)


def poses_of(made, step):
    """The third part moves at each step, the second one at every other step."""
    models = made.poses.models.copy()
    models[2, 3] += 0.4 * step
    models[1, 7] += 0.3 * (step // 2)
    return made.poses._replace(models=models)


def left_out_at(step):
    return np.array([False, False, step == 2])


@pytest.mark.parametrize("seed", range(3))
def test_both_are_those_of_a_new_map(build, seed):
    made = RandomDrawing(seed)
    light = made.light()
    drawers = NativeDrawer(build, made.drawing), ReferenceDrawer(made.drawing)
    maps = [begun(drawer, made, light) for drawer in drawers]
    before = light.shadow
    for step in range(5):
        poses, left_out = poses_of(made, step), left_out_at(step)
        for _, movers in maps:
            movers.update(poses, left_out)
        anew = empty(light)
        drawers[0].cast_shadows(np.concatenate([STILL, MOVERS[~left_out]]), poses, anew)
        drawers[0].bound_shadows(anew)
        for drawn, _ in maps:
            np.testing.assert_array_equal(drawn.shadow, anew.shadow)
        np.testing.assert_array_equal(maps[0][1].touched, maps[1][1].touched)
        np.testing.assert_array_equal(maps[0][0].shadow_bounds, anew.shadow_bounds)
        assert (anew.shadow != before).any()
        before = anew.shadow
