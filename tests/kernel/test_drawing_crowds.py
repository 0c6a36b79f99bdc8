"""More triangles in 32 x 32 pixels than are shaded at a time: images of the C functions and of numpy are the same."""

import numpy as np
from kernel_drawings import RandomDrawing

from morse.kernel.drawing.native import NativeDrawer
from tests.kernel.twins.drawing import ReferenceDrawer


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
