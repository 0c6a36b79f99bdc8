"""Worlds of many bodies."""

import pytest
from worlds import box, node, rigid, run, world


def test_thousands_of_things_that_stand_still():
    stones = [node(f"stone{i}", box(0.5, 0.5, 0.5), at=(i % 60, i // 60, 0.25)) for i in range(3000)]
    w = world(*stones, rigid("ball", box(0.4, 0.4, 0.4), at=(30, 20, 1.0)))
    run(w, 1.0)
    assert w.game_object("ball").worldPosition.z == pytest.approx(0.7, abs=0.01)
