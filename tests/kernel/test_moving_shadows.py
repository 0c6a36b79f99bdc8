"""The shadows of parts that move: equal to those of a map that is drawn anew, in C and in numpy."""

import numpy as np
import pytest
from kernel_drawings import RandomDrawing

from morse.kernel.drawing.arrays import CAMERA, NO_SURFACE, bounds_for
from morse.kernel.drawing.native import NativeDrawer
from tests.kernel.twins.drawing import ReferenceDrawer

MOVERS, STILL = np.array([1, 2, 4]), np.array([0, 3])
NO_CAMERAS = np.zeros(0, CAMERA)


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
            movers.update(poses, NO_CAMERAS, left_out)
        anew = empty(light)
        drawers[0].cast_shadows(np.concatenate([STILL, MOVERS[~left_out]]), poses, anew)
        drawers[0].bound_shadows(anew)
        for drawn, _ in maps:
            np.testing.assert_array_equal(drawn.shadow, anew.shadow)
        np.testing.assert_array_equal(maps[0][1].touched, maps[1][1].touched)
        np.testing.assert_array_equal(maps[0][0].shadow_bounds, anew.shadow_bounds)
        assert (anew.shadow != before).any()
        before = anew.shadow


@pytest.mark.parametrize("seed", [3, 6, 11])
def test_shadows_out_of_sight_are_left_out_and_images_remain_the_same(build, seed):
    """The movers are spread over more space than a camera sees, with a map of fine texels around all of them."""
    made = RandomDrawing(seed)
    rng = made.rng
    light = made.light()
    light.sun[:8] *= 4
    light.sun[3], light.sun[7] = 400, 400
    light.sun[12] = 0.025
    light.lamps["towards"][0] = light.sun[8:11]
    light = light._replace(shadow=np.full((800, 800), NO_SURFACE, np.float32))
    drawer = NativeDrawer(build, made.drawing)
    shown, movers = begun(drawer, made, light)
    left_out = different = 0
    for _ in range(60):
        camera = made.cameras(((40, 33),), far=30.0)
        camera["color"], camera["normals"] = 1, 0
        models = made.poses.models.copy()
        models[MOVERS, 3::4] = rng.normal(size=(len(MOVERS), 3)) * rng.choice([1.0, 4.0])
        poses = made.poses._replace(models=models)
        movers.update(poses, camera)
        absent = ~movers.touched.any(axis=1)
        left_out += absent.sum()
        complete, without = empty(light), empty(light)
        drawer.cast_shadows(np.concatenate([STILL, MOVERS]), poses, complete)
        drawer.cast_shadows(STILL, poses, without)
        for anew in (complete, without):
            drawer.bound_shadows(anew)
        images = [drawer.draw(camera, poses, one, 5) for one in (shown, complete, without)]
        np.testing.assert_array_equal(images[0].rgba, images[1].rgba)
        different += (images[1].rgba != images[2].rgba).any()
    assert left_out > 10
    assert different > 10
