"""What the driving page asks of components."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest

from morse.simulation.view_requests import ViewRequests
from morse.simulation.viewing import View
from morse.viewer import page_messages as page
from morse.viewer.page_messages import ViewEvent
from morse.viewer.protocol import page_message_types
from morse.viewer.view_messages import Capturing, PropertyValue, Refused

if TYPE_CHECKING:
    from collections.abc import Callable

SCENE = """
from morse.builder.creator import SensorCreator

class Camera(SensorCreator):
    _classpath = "view_parts.Camera"

robot = ATRV()
left, right, pose = Camera(), Camera(), Pose()
robot.append(left)
robot.append(right)
robot.append(pose)
env = Environment("empty", fastmode=True)
"""


class Asked:
    """The requests of a page to a simulation, and what is said in return."""

    def __init__(self, simulation: Any) -> None:
        self.said: list[Any] = []
        self.components = simulation.context.components
        self.requests = ViewRequests(simulation.context, SimpleNamespace(send=self.said.append))  # type: ignore[arg-type]

    def capturing(self) -> list[bool]:
        return [self.components[f"robot.{name}"].capturing for name in ("left", "right")]


@pytest.fixture
def asked(load: Callable[..., Any]) -> Asked:
    return Asked(load(SCENE))


def test_every_event_of_a_page_is_handled(load: Callable[..., Any]) -> None:
    view = View(load(SCENE, view="web", view_port=0))
    try:
        assert set(view._handlers) == {kind for kind in page_message_types() if issubclass(kind, ViewEvent)}
    finally:
        view.close()


def test_cameras_stop_and_go_on_together(asked: Asked) -> None:
    asked.requests.toggle_capturing(page.ToggleCapturing())
    assert asked.capturing() == [False, False]
    assert asked.said == [
        PropertyValue("robot.left", "capturing", False),
        PropertyValue("robot.right", "capturing", False),
        Capturing(False),
    ]
    asked.requests.toggle_capturing(page.ToggleCapturing())
    assert asked.capturing() == [True, True]
    assert asked.said[-1] == Capturing(True)
    assert not hasattr(asked.components["robot.pose"], "capturing")


def test_while_one_takes_pictures_the_key_stops_all(asked: Asked) -> None:
    asked.components["robot.left"].capturing = False
    asked.requests.toggle_capturing(page.ToggleCapturing())
    assert asked.capturing() == [False, False]


def test_pages_hear_of_cameras_that_are_stopped_one_by_one(asked: Asked) -> None:
    for name, expected in (("robot.left", True), ("robot.right", False)):
        asked.requests.set_property(page.SetProperty(1, name, "capturing", False))
        assert Capturing(expected) in asked.said
        asked.said.clear()


def test_without_cameras_the_key_says_so(load: Callable[..., Any]) -> None:
    asked = Asked(load("robot = ATRV()\nenv = Environment('empty', fastmode=True)"))
    asked.requests.toggle_capturing(page.ToggleCapturing())
    asked.requests.tell_capturing()
    assert asked.said == [Refused("toggle_capturing", "No robot has a camera.")]
