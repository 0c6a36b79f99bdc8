"""Rays of sensors, as sent to pages."""

from types import SimpleNamespace

import numpy as np
import pytest

from morse.viewer.feeds.sensors import ViewRays

SCRIPT = """
wall = Cube("Wall")
wall.scale = (0.1, 40, 40)
wall.location = (4.1, 0, 0)
wall._bpy_object.game.physics_type = "STATIC"
robot = FakeRobot()
plain = Sick()
robot.append(plain)
arc = Infrared()
robot.append(arc)
fine = Hokuyo()
fine.properties(resolution=0.05)
robot.append(fine)
env = Environment("empty", fastmode=True)
"""


class Pages:
    """The requests of the pages, and the data sent to them."""

    def __init__(self):
        self.wishes = SimpleNamespace(overlays=frozenset())
        self.got = []

    def send(self, message):
        self.got.append(message)

    def take(self):
        got, self.got = self.got, []
        return {m.component: np.frombuffer(m.payload, dtype=np.float32).reshape(-1, 7) for m in got}


@pytest.fixture
def shown(simulate):
    simulation, pages = simulate(SCRIPT, sockets=False), Pages()
    rays = ViewRays(simulation.context, pages)

    def update(seconds):
        simulation.sleep(seconds)
        rays.update()
        return pages.take()

    update.pages = pages
    return update


def test_a_visible_arc_is_shown_unasked(shown):
    rows = shown(0.1)
    assert set(rows) == {"robot.arc"}
    assert rows["robot.arc"].shape == (21, 7)
    # 2 m, no echo
    assert rows["robot.arc"][10] == pytest.approx([0, 0, 0, 2, 0, 0, 0], abs=1e-6)


def test_what_a_page_looks_at_is_shown(shown):
    shown.pages.wishes.overlays = frozenset({"robot.plain"})
    rows = shown(0.1)["robot.plain"]
    assert rows[90] == pytest.approx([0, 0, 0, 4, 0, 0, 1], abs=1e-5)
    assert rows[0, 6] == 0
    assert np.linalg.norm(rows[0, 3:6]) == pytest.approx(30, abs=1e-4)


def test_the_same_rays_are_sent_once(shown):
    shown.pages.wishes.overlays = frozenset({"robot.plain"})
    assert set(shown(0.1)) == {"robot.arc", "robot.plain"}
    assert shown(0.0) == {}
    assert set(shown(0.1)) == {"robot.arc", "robot.plain"}


def test_of_very_many_rays_some_are_shown(shown):
    shown.pages.wishes.overlays = frozenset({"robot.fine"})
    rows = shown(0.1)["robot.fine"]
    assert 1000 < len(rows) <= 4000
    assert np.ptp(np.arctan2(rows[:, 4], rows[:, 3])) > np.radians(265)
