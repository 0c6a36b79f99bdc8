"""Images of the C functions and of numpy are bit-identical, with any build and any number of threads."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from kernel_drawings import RandomDrawing

from morse.kernel import threads
from morse.kernel.drawing.arrays import CAMERA, NO_SURFACE, bounds_for
from morse.kernel.drawing.native import NativeDrawer
from tests.kernel.twins.drawing import ReferenceDrawer
from tests.kit.effort import examples

some = settings(max_examples=examples(25), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def bounded(drawer, light):
    """The light with bounds of all shadow maps."""
    maps = {"shadow_bounds": light.shadow, "near_bounds": light.near_shadow, "lamp_bounds": light.lamp_shadow}
    made = {name: bounds_for(texels) for name, texels in maps.items() if texels is not None}
    for name, bounds in made.items():
        drawer.bound_shadows(light._replace(shadow=maps[name], shadow_bounds=bounds))
    return light._replace(**made)


def drawn(drawer, made, cameras, light, samples):
    lit, touched, parts = light, None, np.arange(len(made.drawing.parts))
    if light.shadow is not None:
        lit = light._replace(shadow=np.full_like(light.shadow, NO_SURFACE))
        touched = drawer.cast_shadows(parts, made.poses, lit)
    if light.near_shadow is not None:
        near = light._replace(sun=light.near_sun, shadow=np.full_like(light.near_shadow, NO_SURFACE))
        drawer.cast_shadows(parts, made.poses, near)
        lit = lit._replace(near_shadow=near.shadow)
    lit = bounded(drawer, lit)
    return drawer.draw(cameras.copy(), made.poses, lit, samples), lit.shadow, touched


def same(one, other):
    for a, b in zip((*one[0], *one[1:]), (*other[0], *other[1:]), strict=True):
        np.testing.assert_array_equal(a, b)


@some
@given(
    seed=st.integers(0, 10**6),
    samples=st.sampled_from([1, 5]),
    near=st.sampled_from([0.01, 1.0, 3.0]),
    shadow=st.sampled_from([(False, False), (True, False), (True, True)]),
)
def test_random_drawings(build, seed, samples, near, shadow):
    made = RandomDrawing(seed)
    cameras, light = made.cameras(near=near), made.light(*shadow)
    same(
        *[
            drawn(kind, made, cameras, light, samples)
            for kind in (NativeDrawer(build, made.drawing), ReferenceDrawer(made.drawing))
        ]
    )


def test_random_drawings_are_no_empty_ones(build):
    shares, shaded, dark = [], [], []
    for seed in range(10):
        made = RandomDrawing(seed)
        pictures, shadow, _ = drawn(NativeDrawer(build, made.drawing), made, made.cameras(), made.light(), 5)
        shares.append((pictures.ids >= 0).mean())
        shaded.append((shadow > NO_SURFACE).mean())
        dark.append(pictures.rgba[:, :3].std())
    assert 0.2 < np.mean(shares) < 0.98
    assert np.mean(shaded) > 0.05
    assert np.mean(dark) > 20


@pytest.mark.parametrize("samples", [1, 5])
def test_any_number_of_threads(build, monkeypatch, samples):
    made = RandomDrawing(3, clusters=20, triangles=200, instances=60)
    cameras, light = made.cameras(sizes=((320, 240), (100, 70), (33, 31))), made.light()
    results = []
    for count in (1, 2, 5):
        monkeypatch.setattr(threads, "count", lambda count=count: count)
        results.append(drawn(NativeDrawer(build, made.drawing), made, cameras, light, samples))
    same(results[0], results[1])
    same(results[0], results[2])


def test_depth_does_not_depend_on_colour(build):
    made = RandomDrawing(5)
    light, drawer = made.light(), NativeDrawer(build, made.drawing)
    cameras = made.cameras()
    without = cameras.copy()
    without["color"] = False
    one, other = (drawer.draw(some, made.poses, light, 5) for some in (cameras, without))
    np.testing.assert_array_equal(one.depth, other.depth)
    np.testing.assert_array_equal(one.ids, other.ids)
    assert len(other.rgba) == 0


def test_cameras_of_one_call_do_not_disturb_each_other(build):
    made = RandomDrawing(6)
    light, drawer = made.light(), NativeDrawer(build, made.drawing)
    cameras = made.cameras(sizes=((50, 40), (70, 30), (31, 65)))
    cameras["color"] = [True, False, True]
    whole, first = drawer.draw(cameras, made.poses, light, 5), 0
    for camera in cameras:
        alone = drawer.draw(camera.reshape(1).copy(), made.poses, light, 5)
        end = first + len(alone.ids)
        np.testing.assert_array_equal(whole.ids[first:end], alone.ids)
        np.testing.assert_array_equal(whole.depth[first:end], alone.depth)
        if camera["color"]:
            np.testing.assert_array_equal(whole.rgba[first:end], alone.rgba)
        first = end


@pytest.mark.parametrize("number", [np.nan, np.inf, -np.inf, 1e30, -1e20, 1e-40, 0.0])
@pytest.mark.parametrize(
    "what", ["vertices", "normals", "uv", "models", "turns", "eye", "axes", "lens", "lamps", "sky"]
)
def test_numbers_that_mean_nothing_harm_nothing(build, what, number):
    """Only the sanitizers can detect an error here."""
    made = RandomDrawing(8)
    d, cameras, light = made.drawing, made.cameras(), made.light()
    arrays = {
        "vertices": d.vertices["p"],
        "normals": d.vertices["n"],
        "uv": d.vertices["uv"],
        "models": made.poses.models,
        "turns": made.poses.turns,
        "eye": cameras["eye"],
        "axes": cameras["axes"],
        "lens": cameras["fx"],
        "lamps": light.lamps["place"],
        "sky": light.sky,
    }
    array = arrays[what]
    index = tuple(made.rng.integers(0, size, 5) for size in array.shape)
    array[index] = number
    pictures, _, _ = drawn(NativeDrawer(build, d), made, cameras, light, 5)
    assert len(pictures.ids) == 40 * 33 + 64 * 20
    assert pictures.ids.min() >= -1
    assert pictures.ids.max() < len(d.parts)


def test_nothing_to_draw(build):
    made = RandomDrawing(9)
    empty = made.drawing._replace(parts=made.drawing.parts[:0])
    light = made.light()
    one, other = (
        kind.draw(made.cameras(), made.poses, light, 5) for kind in (NativeDrawer(build, empty), ReferenceDrawer(empty))
    )
    assert (one.ids == -1).all()
    assert (one.depth == 0).all()
    assert len(other.ids) == len(one.ids)


# -- large triangles, which cover whole blocks of pixels: images of the C functions and of numpy are bit-identical

drawing_blocks_some = settings(
    max_examples=examples(12), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


def large(seed, size, stretch=6.0):
    """A few triangles, most of them larger than the image, some nearly parallel to each other."""
    made = RandomDrawing(seed, clusters=2, triangles=5, instances=6)
    points = made.drawing.vertices["p"]
    points *= np.array([stretch, stretch, 1.0 if seed % 2 else 0.02], np.float32)
    made.drawing.spheres[:, 3] = np.linalg.norm(points, axis=1).max() * 1.01
    return made, made.cameras(sizes=(size,), near=0.05, far=30.0)


@drawing_blocks_some
@given(seed=st.integers(0, 10**6), samples=st.sampled_from([1, 5]), width=st.integers(33, 100))
def test_random_large_triangles(build, seed, samples, width):
    made, cameras = large(seed, (width, 41))
    light = made.light(shadow=False)
    one, other = (
        kind.draw(cameras.copy(), made.poses, light, samples)
        for kind in (NativeDrawer(build, made.drawing), ReferenceDrawer(made.drawing))
    )
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("samples", [1, 5])
def test_blocks_are_covered_indeed(build, samples):
    """A check of the test above: in most images there are blocks of 8 x 4 pixels that show one instance."""
    whole = []
    for seed in range(10):
        made, cameras = large(seed, (96, 40))
        ids = NativeDrawer(build, made.drawing).draw(cameras, made.poses, made.light(shadow=False), samples).ids
        blocks = ids.reshape(10, 4, 12, 8).swapaxes(1, 2).reshape(120, 32)
        whole.append(((blocks == blocks[:, :1]).all(axis=1) & (blocks[:, 0] >= 0)).mean())
    assert np.mean(whole) > 0.15
    assert np.mean(whole) < 0.95


# -- more triangles in 32 x 32 pixels than are shaded at a time: images of the C functions and of numpy are the sam


def crowd(seed):
    """Small triangles of all materials beside each other."""
    made = RandomDrawing(seed, clusters=4, triangles=250, instances=4)
    d = made.drawing
    d.parts[:, 0], d.parts[:, 3] = np.arange(4), 0
    d.triangles[:, :3] = np.arange(750).reshape(250, 3)[np.arange(1000) % 250]
    d.closed[:], d.levels[:, 4:] = 0, (0, np.inf)
    d.slots[:] = made.rng.integers(1, 4, 8)
    centres = made.rng.uniform(-1, 1, (1000, 1, 3))
    d.vertices["p"] = (centres + made.rng.normal(size=(1000, 3, 3)) * 0.06).reshape(-1, 3)
    d.spheres[:, 3] = 3
    return made, made.cameras(sizes=((32, 32),))


def test_crowds(build):
    made, cameras = crowd(1)
    light = made.light(shadow=False)
    one, other = (
        kind.draw(cameras.copy(), made.poses, light, 5)
        for kind in (NativeDrawer(build, made.drawing), ReferenceDrawer(made.drawing))
    )
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(a, b)
    # many neighbours are of different colours
    colours = one.rgba.reshape(32, 32, 4)[..., :3].astype(int)
    assert (np.abs(np.diff(colours, axis=1)).max(axis=2) > 3).mean() > 0.4


# -- the shadows of parts that move: equal to those of a map that is drawn anew, in C and in numpy -

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


# -- the bounds of the blocks of a shadow map: two planes with all texels that are read for a point of the block

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
