"""Rows of poses: what was shared never changes."""

import numpy as np
import pytest

from morse.physics.poses.rows import Rows


@pytest.mark.parametrize("count", [3, 20_000], ids=["small", "too large for copies in advance"])
def test_shared_arrays_keep_their_values(count: int) -> None:
    rows = Rows(np.zeros((count, 3)), 2)
    shared = []
    for tick in range(150):
        rows.take(np.full((2, 3), float(tick)))
        if tick == 100:
            rows[2] = (7.0, 8.0, 9.0)
        if tick % 3:
            shared.append((tick, rows.share()))
    for tick, array in shared:
        assert array.shape == (count, 3)
        assert np.all(array[:2] == tick)
        assert array[2].tolist() == ([7.0, 8.0, 9.0] if tick >= 100 else [0.0, 0.0, 0.0])
    assert [*rows[1]] == [149.0] * 3
