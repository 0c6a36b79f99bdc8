"""Images of the C functions and of numpy are bit-identical, with any build and any number of threads."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from kernel_drawings import RandomDrawing

from morse.kernel import threads
from morse.kernel.drawing.arrays import NO_SURFACE, bounds_for
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
