"""Worlds of many bodies."""

import numpy as np
import pytest
from worlds import box, ground, node, rigid, run, world

from morse.scene import CollisionShape, ShapeKind

pytestmark = pytest.mark.long


def test_thousands_of_things_that_stand_still():
    stones = [node(f"stone{i}", box(0.5, 0.5, 0.5), at=(i % 60, i // 60, 0.25)) for i in range(3000)]
    w = world(*stones, rigid("ball", box(0.4, 0.4, 0.4), at=(30, 20, 1.0)))
    run(w, 1.0)
    assert w.game_object("ball").worldPosition.z == pytest.approx(0.7, abs=0.01)


@pytest.mark.slow
def test_thousands_of_things_that_fall():
    """The engine's own estimate of the memory for that many bodies exceeds the memory of machines."""
    boxes = [rigid(f"box{i}", box(0.4, 0.4, 0.4), at=(i % 60, i // 60, 1.0)) for i in range(4800)]
    w = world(ground(), *boxes)
    run(w, 0.2)
    heights = [z for _, _, z in w.positions[: w.moving]]
    assert heights == pytest.approx([1.0 - 9.81 * 0.2**2 / 2] * 4800, abs=0.01)


def test_a_heap_fits_into_the_memory():
    places = [(0.5 * (i % 12), 0.5 * (i // 12 % 12), 0.2 + 0.4 * (i // 144)) for i in range(1100)]
    boxes = [rigid(f"box{i}", box(0.4, 0.4, 0.4), at=place) for i, place in enumerate(places)]
    w = world(ground(), *boxes)
    run(w, 0.1)
    assert all(z > 0.15 for _, _, z in w.positions[: w.moving])


def test_equal_hulls_are_kept_once():
    corners = np.array([(x, y, z) for x in (-0.2, 0.2) for y in (-0.1, 0.1) for z in (-0.1, 0.2)], dtype=float)
    shapes = [CollisionShape(ShapeKind.CONVEX, (), vertices=size * corners) for size in (1.0, 1.0, 1.0, 2.0, 1.0)]
    bodies = [rigid(f"body{i}", shape, at=(i, 0, 1.0)) for i, shape in enumerate(shapes)]
    assert world(*bodies).model.nmesh == 2
