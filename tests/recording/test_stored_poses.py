"""Poses of rigid groups are read from arrays of all groups, and from copies of some."""

from __future__ import annotations

import numpy as np
import pytest

from morse.recording.captures.poses import groups_of_arrays


@pytest.mark.parametrize(("first", "is_known"), [(0, True), (0, False), (2, False)])
def test_a_group_is_found_in_its_tick(first: int, is_known: bool) -> None:
    rng = np.random.default_rng(first)
    positions, rotations = rng.normal(size=(3, 6, 3)), rng.normal(size=(3, 6, 9))
    stored = [array[first:].copy() for array in positions], [array[first:].copy() for array in rotations]
    # of a copy, the distance of its first group from the begin of the whole array
    places = [[-24 * first] * 3, [-72 * first] * 3]
    if is_known:
        places = [[array.ctypes.data for array in arrays] for arrays in stored]
    groups = groups_of_arrays(*stored, *places)
    some = groups.some(np.array([2, 0]))
    for group in range(first, 6):
        assert groups.read(1, group) == (positions[1, group].tolist(), rotations[1, group].tolist())
        assert some.read(0, group) == (positions[2, group].tolist(), rotations[2, group].tolist())
