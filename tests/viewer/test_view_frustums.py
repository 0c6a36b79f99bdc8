"""The fields of view of cameras, as pages are told."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from morse.rendering.distortion import lens_of
from morse.rendering.lens import Lens
from morse.viewer.feeds.sensors import SIDE, ViewFrustums, rim
from morse.viewer.hub import Wishes


def test_the_corners_of_a_pinhole_picture() -> None:
    lens = Lens.of_angle(64, 48, math.radians(90.0))
    corners = rim(lens)[::SIDE]
    # 45 degrees to the sides, and 48/64 of it up and down; clockwise from the upper left
    wanted = np.array([[-1, -0.75, 1], [1, -0.75, 1], [1, 0.75, 1], [-1, 0.75, 1]])
    np.testing.assert_allclose(corners / corners[:, 2:], wanted, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(rim(lens), axis=1), 1.0)


def test_a_fisheye_lens_looks_to_the_sides_as_far_as_it_sees() -> None:
    lens = lens_of(65, 65, 25.0, 180.0, 0.1, 100.0, "equidistant", "")
    directions = rim(lens)
    middle_of_right = directions[SIDE + SIDE // 2]
    assert math.degrees(math.acos(middle_of_right[2])) == pytest.approx(90.0, abs=2.0)
    assert middle_of_right[0] > 0.99


def test_a_lens_that_shows_nothing_in_its_corners_is_followed_inward() -> None:
    lens = lens_of(65, 65, 25.0, 340.0, 0.1, 100.0, "equidistant", "")
    directions = rim(lens)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0, atol=1e-6)
    # the corner is beyond half a turn: what is next to it looks almost straight back
    assert directions[0][2] < -0.9


def test_a_field_of_view_is_sent_once_for_each_lens() -> None:
    camera = SimpleNamespace(lens=Lens.of_angle(64, 48, 1.0, 0.1, 5.0))
    sent: list[Any] = []
    server = SimpleNamespace(wishes=Wishes(overlays=frozenset({"eye", "laser", "nobody"})), send=sent.append)
    context = SimpleNamespace(components={"eye": camera, "laser": SimpleNamespace()})
    feed = ViewFrustums(context, server)  # type: ignore[arg-type]
    feed.update()
    feed.update()
    assert [(one.component, one.near, one.far, len(one.rim)) for one in sent] == [("eye", 0.1, 5.0, 4 * SIDE)]
    camera.lens = Lens.of_angle(64, 48, 2.0)
    feed.update()
    assert len(sent) == 2
