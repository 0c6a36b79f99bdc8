"""Robots that share a map explore rooms."""

import runpy
from pathlib import Path

import pytest

pytestmark = pytest.mark.long

EXAMPLES = Path(__file__).parents[2] / "examples"
#: m^2: the floor between the outer walls, without the inner walls and the box in the hall
FLOOR = 15.8 * 9.8 - 0.2 * (4 * 2.5 + 2 * 1.6 + 2 * 4.8) - 1.0


def test_two_robots_that_share_a_map_know_all_rooms_sooner_than_one() -> None:
    explore = runpy.run_path(str(EXAMPLES / "shared_map" / "explore_together.py"))["explore"]
    (alone, mine, _), (together, ours, nearest) = explore(1), explore(2)
    # the cells that walls touch are no free ones: half a cell along all walls, on both sides
    for free in (mine, ours):
        assert 0.9 * FLOOR < free < FLOOR
    assert together < 0.7 * alone
    # the scanner is in the middle of a body of 0.38 m
    assert nearest > 0.19
