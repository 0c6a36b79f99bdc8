"""Frames of messages in the axes of the earth are in the tree of frames."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

#: the X axis of the world points north
NORTH = "env.properties(longitude=1.4, latitude=43.6, altitude=100.0, angle_against_north=1.5707963267948966)"


def test_velocities_of_gps_are_in_a_frame_of_the_tree(start: Callable[..., Any]) -> None:
    simulation, desk = start('gps = GPS("gps"); gps.level("raw"); robot.append(gps)', NORTH)
    simulation.step(2)
    frame = desk.last("/robot/gps/vel").header.frame_id
    found = {t.child_frame_id: t for t in desk.last("/tf_static").transforms}
    assert found[frame].header.frame_id == "map"
    turn = found[frame].transform.rotation
    # east is the -Y axis of a world whose X axis points north
    east = (1.0 - 2.0 * turn.z**2, 2.0 * turn.w * turn.z)
    assert east == pytest.approx((0.0, -1.0), abs=1e-12)
    assert math.hypot(turn.x, turn.y) == pytest.approx(0.0, abs=1e-12)
