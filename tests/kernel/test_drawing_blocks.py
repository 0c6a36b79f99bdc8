"""Large triangles, which cover whole blocks of pixels: images of the C functions and of numpy are bit-identical."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from kernel_drawings import RandomDrawing

from morse.kernel.drawing.native import NativeDrawer
from tests.kernel.twins.drawing import ReferenceDrawer
from tests.kit.effort import examples

some = settings(max_examples=examples(12), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def large(seed, size, stretch=6.0):
    """A few triangles, most of them larger than the image, some nearly parallel to each other."""
    made = RandomDrawing(seed, clusters=2, triangles=5, instances=6)
    points = made.drawing.vertices["p"]
    points *= np.array([stretch, stretch, 1.0 if seed % 2 else 0.02], np.float32)
    made.drawing.spheres[:, 3] = np.linalg.norm(points, axis=1).max() * 1.01
    return made, made.cameras(sizes=(size,), near=0.05, far=30.0)


@some
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
