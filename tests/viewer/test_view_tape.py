"""`morse export --html`: a recorded run as one file."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any

import pytest
from view_pages import until

import morse as simulator
from morse.cli.app import execute
from morse.viewer.tape.html import page_of
from morse.viewer.tape.tape import Tape
from morse.viewer.view_messages import Picture, Values

if TYPE_CHECKING:
    from pathlib import Path

SCENE = """
from morse.builder import *
robot = FakeRobot("robot")
cube = Cube("Load"); cube.scale = (0.5, 0.5, 0.5); cube.color(1, 0, 0)
robot.append(cube)
motion = MotionXYW("motion"); robot.append(motion)
pose = Pose("pose"); robot.append(pose)
laser = Sick("laser"); robot.append(laser)
eye = VideoCamera("eye"); eye.properties(cam_width=32, cam_height=24); eye.translate(x=1); robot.append(eye)
wall = Cube("Wall"); wall.scale = (0.1, 9, 9); wall.location = (6, 0, 0)
wall._bpy_object.game.physics_type = "STATIC"
env = Environment("empty")
env.show(rays=[laser], images=[eye], plots=["robot.pose.x"], follow=robot)
"""
SPEED, SECONDS = 1.5, 2.0


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("tape")
    (folder / "scene.py").write_text(SCENE)
    with simulator.load(folder / "scene.py") as sim, sim.record(folder / "run.mcap"):
        sim.robot.motion.publish({"x": SPEED, "y": 0.0, "w": 0.0})
        sim.step(round(SECONDS * 60))
    assert execute(["export", str(folder / "run.mcap"), "--html", str(folder / "run.html")]) == 0
    return folder


@pytest.mark.browser
def test_a_page_plays_a_run_without_a_server(folder: Path, browser: Any) -> None:
    asked: list[str] = []
    errors: list[str] = []
    page = browser.new_page(viewport={"width": 1100, "height": 600})
    page.on("request", lambda request: asked.append(request.url))
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.goto((folder / "run.html").as_uri() + "?quality=low")
    until(lambda: page.evaluate("!!(window.morse?.world.value && morse.stage.frames > 0)"), "a world")
    until(lambda: page.evaluate("morse.poses.value.time") >= SECONDS - 0.01, "the run is played to its end")
    until(lambda: not page.evaluate("morse.poses.value.running"))
    place = "morse.world.value.find('robot').frame.position.x"
    assert page.evaluate(place) == pytest.approx(SPEED * SECONDS, abs=0.05)
    page.evaluate("morse.connection.send({ type: 'rewind', time: 1.0 })")
    until(lambda: page.evaluate("morse.poses.value.time") == pytest.approx(1.0, abs=1e-6))
    assert page.evaluate(place) == pytest.approx(SPEED, abs=0.05)
    # the data are those of the moment, too
    page.evaluate("morse.components.selected.set('robot.pose')")
    until(lambda: page.evaluate("morse.components.valuesOf('robot.pose').data.x") == pytest.approx(SPEED, abs=0.2))
    # what the script shows: the wall is straight ahead, 6 m from the origin less half of its thickness
    rays = "[...morse.panels.layers.rays.drawn.get('robot.laser').hits.geometry.attributes.position.array]"
    hits = page.evaluate(rays)
    assert max(hits[0::3]) == pytest.approx(5.9, abs=0.01)
    until(lambda: page.locator("[data-camera='robot.eye']").is_visible())
    assert page.evaluate("morse.panels.plots.plots.length") == 1
    answer = page.evaluate(
        "morse.connection.request({ type: 'set_property', component: 'robot.eye', name: 'cam_width', value: 9 })"
    )
    assert not answer["ok"]
    assert "recorded" in answer["error"]
    assert [url for url in asked if not url.startswith(("file:", "blob:", "data:"))] == []
    assert errors == []
    page.close()


def test_nothing_is_loaded_from_elsewhere(folder: Path) -> None:
    text = (folder / "run.html").read_text(encoding="utf-8")
    assert "default-src 'none'" in text
    markup = re.sub(r"<(script|style)[^>]*>.*?</\1>", "", text, flags=re.DOTALL)
    assert re.findall(r'(?:src|href)="(?!data:)[^"]*"', markup) == []
    assert "Leon Sorokin" in text  # the licences of the libraries


def test_a_part_of_the_run(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = str(folder / "part.html")
    assert execute(["export", str(folder / "run.mcap"), "--html", target, "--begin", "0.5", "--length", "0.5"]) == 0
    assert execute(["export", str(folder / "run.mcap"), "--html", target, "--begin", "60"]) == 1
    assert "ends after 2 s" in capsys.readouterr().err


def test_images_give_way_when_the_page_grows() -> None:
    tape = Tape("run")
    for number in range(100):
        tape.time = number / 10
        tape.send(Picture(bytes([number]) * 1000, "eye", 10, 10, "image/jpeg", tape.time))
        tape.send(Values("pose", tape.time, {"x": math.sin(number)}))
    everything = tape.to_bytes(0.0, 10.0, 60.0, 10_000_000)
    limit = len(everything) // 2
    assert len(tape.to_bytes(0.0, 10.0, 60.0, limit)) <= limit


def test_a_title_is_text(tmp_path: Path) -> None:
    (tmp_path / "assets").mkdir()
    (tmp_path / "assets" / "licences.txt").write_text("three --> free")
    (tmp_path / "assets" / "a.js").write_text('x = "</script>"')
    (tmp_path / "index.html").write_text(
        '<head><title>MORSE</title><script type="module" crossorigin src="./assets/a.js"></script></head>'
    )
    text = page_of(b"", "<b>&", tmp_path)
    assert "<title>&lt;b&gt;&amp;</title>" in text
    assert 'x = "<\\/script>"' in text
    assert text.count("-->") == 1
