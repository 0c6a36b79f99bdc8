"""The image of a semantic camera, which only the live view shows."""

import io
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
from PIL import Image

from morse.core.requests import prepare
from morse.rendering import renderer
from morse.viewer.feeds.sensors import PicturesFeed
from morse.viewer.hub import Wishes

SCRIPT = """
robot = FakeRobot("robot"); robot.translate(z=10)
eye = SemanticCamera("eye"); eye.properties(cam_width=64, cam_height=64, cam_focal=16); robot.append(eye)
ball = Sphere("Ball"); ball.location = (4, 1, 10); ball.scale = (0.5, 0.5, 0.5)
ball.set_color(0.9, 0.0, 0.0); ball.properties(Object=True, Label="the ball")
env = Environment("empty")
"""


def test_a_page_gets_a_picture_with_the_visible_objects(simulate: Any) -> None:
    simulation = simulate(SCRIPT, sockets=False)
    server = SimpleNamespace(wishes=Wishes(images=frozenset({"robot.eye"})), sent=[])
    server.send = server.sent.append
    feed = PicturesFeed(simulation.context, cast("Any", server))
    feed.update()
    simulation.sleep(0.2)
    feed.update()
    (sent,) = server.sent
    assert sent.meaning == "color"
    (ball,) = sent.sightings
    assert ball.name == "the ball"
    # 90 degrees of view: 32 px for a slope of 1; the ball is at a slope of 1/4 to the left, 1/8 wide on each side
    x0, y0, x1, y1 = ball.box
    assert abs((x0 + x1) / 2 - (32 - 8)) <= 1
    assert abs((y0 + y1) / 2 - 32) <= 1
    assert abs((x1 - x0) - 8) <= 2
    red, green, _ = np.asarray(Image.open(io.BytesIO(sent.payload)))[32, 24]
    assert red > 2 * green
    # nobody looks any more: no colours are rendered
    server.wishes = Wishes()
    feed.update()
    simulation.sleep(0.2)
    assert not simulation.context.component("robot.eye").request.color


def test_the_first_image_has_been_prepared(simulate: Any, monkeypatch: Any) -> None:
    simulation = simulate(SCRIPT, sockets=False)
    prepare(simulation.context.components.values())

    def read_again(*_: object) -> None:
        raise AssertionError("the world is read in a tick")

    monkeypatch.setattr(renderer, "Stage", read_again)
    simulation.sleep(0.2)
    names = [seen["name"] for seen in simulation.context.component("robot.eye").local_data["visible_objects"]]
    assert names == ["the ball"]
