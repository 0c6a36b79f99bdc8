"""A page shows a row of a batch while it runs."""

import math
import struct
import sys
import time
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np
import pytest

import morse

sys.path.insert(0, str(Path(__file__).parents[1] / "viewer"))

from view_pages import Client

WALL_LIMIT = 60.0


def arena():
    from morse.builder import ATRV, Environment, MotionVW, Pose, Sick

    robot = ATRV("robot")
    for part in (MotionVW("motion"), Pose("pose"), Sick("laser")):
        robot.append(part)
    Environment("empty")


def driven(count=4):
    many = morse.batch(arena, count, seed=5)
    drive = many.command("robot.motion", "v", "w")
    pose = many.read("robot.pose", "x", "y", "yaw")
    drive[:] = [[0.2 * (row + 1), 0.1 * row] for row in range(count)]
    return many, pose


def seen(page, step, condition):
    """Step until a snapshot of the page fulfils a condition: tick, time and the position of the robot."""
    end = time.monotonic() + WALL_LIMIT
    while time.monotonic() < end:
        step()
        try:
            page.receive(timeout=0.01)
        except TimeoutError:
            continue
        for _, _, count, _, tick, now, *_, rest in page.poses:
            first = struct.unpack_from("<3f", rest) if count else (math.nan,) * 3
            if condition(tick, now, first):
                return
        page.poses.clear()
    raise AssertionError(f"the page has not seen it within {WALL_LIMIT} s")


def test_the_page_shows_the_row_and_then_another():
    many, pose = driven()
    with many:
        frame = many.show(2)
        assert urlsplit(frame.url).hostname == "127.0.0.1"
        track = {}

        def step():
            many.step(6, measure=True)
            track[many[0].ticks] = pose.copy()

        def is_row(row):
            return lambda tick, _, place: tick in track and np.allclose(place[:2], track[tick][row, :2], atol=1e-5)

        with Client(frame.url) as page:
            seen(page, step, is_row(2))
            assert many.show(1).url == frame.url
            seen(page, step, is_row(1))
            page.messages.clear()
            page.send("reset")
            # poses arrive as long as the request has not been answered
            seen(page, step, lambda *_: any(message["type"] == "refused" for message in page.messages))


def test_it_makes_no_difference_to_the_data():
    many, pose = driven()
    others, same = driven()
    with many, others:
        with Client(many.show(3).url) as page:

            def step():
                many.step(6, measure=True)
                others.step(6, measure=True)
                assert np.array_equal(pose, same)

            seen(page, step, lambda tick, _now, _place: tick > 60)
        assert [one.state_hash() for one in many] == [one.state_hash() for one in others]


def test_without_a_browser_nothing_is_copied_and_the_end_closes_the_page(monkeypatch):
    many, _ = driven(2)
    with many:
        frame = many.show(1)
        monkeypatch.setattr("morse.viewer.row_view.RowView._copy", lambda *_: pytest.fail("nobody looks"))
        for _ in range(20):
            many.step(6, measure=True)
    with pytest.raises(ConnectionRefusedError), Client(frame.url):
        pass


def test_a_page_that_fails_is_closed_and_the_batch_goes_on(monkeypatch, caplog):
    def fail(*_):
        raise ZeroDivisionError("of the page")

    monkeypatch.setattr("morse.viewer.row_view.RowView._copy", fail)
    many, _ = driven(2)
    with many, Client(many.show(1).url):
        end = time.monotonic() + WALL_LIMIT
        while "the page of row 1 is closed" not in caplog.text:
            many.step(6, measure=True)
            assert time.monotonic() < end
        assert "the page of row 1 is closed: ZeroDivisionError: of the page" in caplog.text
        many.step(6, measure=True)


def test_mistakes_are_named():
    with morse.batch(arena, 2) as many:
        with pytest.raises(IndexError, match="row"):
            many.show(2)
        with pytest.raises(ValueError, match="height"):
            many.show(0, height=3)
    with pytest.raises(RuntimeError, match="closed"):
        many.show(0)


def test_rows_with_other_scenes_are_shown():
    def wall():
        from morse.builder import Cube

        cube = Cube("Wall")
        cube.location = (3.0, 0.0, 1.0)
        arena()

    with morse.batch([arena, wall], 4) as many:
        first = many.show(0)
        assert many.show(2).url == first.url
        with Client(many.show(1).url) as page:
            seen(page, lambda: many.step(6), lambda tick, *_: tick >= 6)
