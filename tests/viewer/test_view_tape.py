"""`morse export --html`: a recorded run as one file."""

import gzip
import itertools
import json
import math
import re
from datetime import UTC, datetime
from pathlib import Path
from random import Random
from typing import Any

import pytest

import morse as simulator
from morse.cli.app import execute
from morse.viewer.exported_page import PageRecording, page_of
from morse.viewer.view_messages import History, Picture, Values
from tests.kit.waiting import wait_until

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
DOCS = Path(__file__).parents[2] / "docs"


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
    wait_until(lambda: page.evaluate("!!(window.morse?.world.value && morse.stage.frames > 0)"), "a world")
    wait_until(lambda: page.evaluate("morse.poses.value.time") >= SECONDS - 0.01, "the run is played to its end")
    wait_until(lambda: not page.evaluate("morse.poses.value.running"))
    place = "morse.world.value.find('robot').frame.position.x"
    assert page.evaluate(place) == pytest.approx(SPEED * SECONDS, abs=0.05)
    page.evaluate("morse.connection.send({ type: 'rewind', time: 1.0 })")
    wait_until(lambda: page.evaluate("morse.poses.value.time") == pytest.approx(1.0, abs=1e-6))
    assert page.evaluate(place) == pytest.approx(SPEED, abs=0.05)
    # the data are those of the moment, too
    page.evaluate("morse.components.selected.set('robot.pose')")
    wait_until(lambda: page.evaluate("morse.components.valuesOf('robot.pose').data.x") == pytest.approx(SPEED, abs=0.2))
    # what the script shows: the wall is straight ahead, 6 m from the origin less half of its thickness
    rays = "[...morse.panels.layers.rays.drawn.get('robot.laser').hits.geometry.attributes.position.array]"
    hits = page.evaluate(rays)
    assert max(hits[0::3]) == pytest.approx(5.9, abs=0.01)
    wait_until(lambda: page.locator("[data-camera='robot.eye']").is_visible())
    assert page.evaluate("morse.panels.plots.plots.length") == 1
    answer = page.evaluate(
        "morse.connection.request({ type: 'set_property', component: 'robot.eye', name: 'cam_width', value: 9 })"
    )
    assert not answer["ok"]
    assert "recorded" in answer["error"]
    assert [url for url in asked if not url.startswith(("file:", "blob:", "data:"))] == []
    assert errors == []
    page.close()


def test_a_run_in_a_document_moves_only_itself(folder: Path, browser: Any) -> None:
    frame = (
        '<p style="height: {}px">text</p>'
        '<span class="run"><iframe width="600" height="400" data-src="run.html?quality=low#loop"></iframe></span>'
    )
    document = "".join(frame.format(height) for height in (900, 60, 3000))
    script = f'<script defer src="{(DOCS / "_static" / "runs.js").as_uri()}"></script>'
    (folder / "document.html").write_text("<!doctype html>" + script + document)
    page = browser.new_page(viewport={"width": 1000, "height": 600})
    page.goto((folder / "document.html").as_uri())
    loaded = "[...document.querySelectorAll('iframe')].map((frame) => frame.hasAttribute('src'))"
    assert page.evaluate(loaded) == [False, False, False]
    entries = page.evaluate("history.length")
    page.evaluate("scrollTo(0, 500)")
    wait_until(lambda: page.evaluate(loaded) == [True, False, False])
    shown = page.frame_locator("iframe >> nth=0").locator(".plot").first
    shown.wait_for(state="attached")
    # the plot of the script is out of sight in so small a frame; the document stays where the reader has scrolled it
    wait_until(lambda: page.frames[1].evaluate("!!morse.world.value && morse.panels.plots.plots.length === 1"))
    page.frames[1].evaluate("morse.panels.plots.plot('robot.pose', 'y')")
    assert page.evaluate("scrollY") == 500
    # a run that is out of sight is given up, and only those in sight are there
    page.evaluate("scrollTo(0, 1100)")
    wait_until(lambda: page.evaluate(loaded) == [True, True, False])
    page.evaluate("scrollTo(0, document.body.scrollHeight)")
    wait_until(lambda: page.evaluate(loaded) == [False, False, True])
    assert page.evaluate("[history.length, document.querySelectorAll('iframe').length]") == [entries, 3]
    page.close()


def test_the_slider_is_as_wide_as_a_telephone(folder: Path, browser: Any) -> None:
    context = browser.new_context(viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True)
    page = context.new_page()
    page.goto((folder / "run.html").as_uri() + "?quality=low")
    page.locator(".history").wait_for()
    slider, *tools = (page.locator(f".history {one}").bounding_box() for one in ("input", "button >> nth=0", "output"))
    assert slider["width"] > 0.9 * 390
    assert len({round(tool["y"] + tool["height"] / 2) for tool in tools}) == 1
    context.close()


def test_a_run_in_a_page_begins_again_without_a_question_and_has_nothing_to_end(folder: Path, browser: Any) -> None:
    page = browser.new_page()
    page.set_viewport_size({"width": 1280, "height": 400})
    page.goto((folder / "run.html").as_uri() + "?quality=low")
    page.locator(".history").wait_for()
    assert not page.get_by_role("button", name="End the simulation").is_visible()
    slider = page.locator(".history input")
    page.evaluate("morse.connection.send({ type: 'pause' })")
    slider.evaluate("one => { one.value = one.max; one.dispatchEvent(new Event('input')); }")
    wait_until(lambda: float(page.evaluate("morse.poses.value?.time ?? 0")) > 0)
    late = page.evaluate("morse.poses.value.time")
    page.get_by_role("button", name="Reset").click()
    wait_until(lambda: page.evaluate("morse.poses.value.time") < late)
    assert page.locator("dialog[open]").count() == 0
    page.close()


def test_numbers_keep_what_a_run_resolves() -> None:
    tape = PageRecording("run")
    values = {"utm": 4831234.5671234, "latitude": 43.604261234567, "x": 1.23456789012345, "fine": 1.25e-7}
    tape.time = 1790000000.0166667
    tape.send(Values("pose", tape.time, values))
    tape.send(History([1790000000.0 + tick / 60 for tick in range(4)], recorded=True))
    data = gzip.decompress(tape.to_bytes(1790000000.0, 1790000001.0, 60.0, 10_000))
    head = json.loads(data[4 : 4 + int.from_bytes(data[:4], "little")])
    messages = {message["type"]: message for _, _, message, _ in head["messages"]}
    kept = messages["values"]["data"]
    assert kept["utm"] == pytest.approx(values["utm"], abs=1e-4)
    assert kept["latitude"] == pytest.approx(values["latitude"], abs=1e-8)
    assert kept["x"] == pytest.approx(values["x"], abs=1e-9)
    assert kept["fine"] == values["fine"]
    times = messages["history"]["times"]
    assert [b - a for a, b in itertools.pairwise(times)] == pytest.approx([1 / 60] * 3, abs=2e-5)


DATED = """
from morse.builder import *
robot = FakeRobot("robot")
gps = GPS("gps"); gps.level("extended"); robot.append(gps)
env = Environment("empty")
env.properties(longitude=1.48, latitude=43.56, altitude=150.0)
env.use_relative_time(False)
"""


def test_a_dated_run_has_times_of_its_own(tmp_path: Path, browser: Any) -> None:
    (tmp_path / "scene.py").write_text(DATED)
    with simulator.load(tmp_path / "scene.py") as sim, sim.record(tmp_path / "run.mcap"):
        sim.step(120)
        begin = sim.time() - 2.0  # of tick 0
        place = sim.robot.gps.get()
    assert begin > 1e9
    assert execute(["export", str(tmp_path / "run.mcap"), "--html", str(tmp_path / "run.html")]) == 0
    page = browser.new_page(viewport={"width": 1100, "height": 600})
    page.goto((tmp_path / "run.html").as_uri() + "?quality=low")
    wait_until(lambda: page.evaluate("!!window.morse?.world.value && morse.poses.value !== null"))
    page.evaluate("morse.connection.send({ type: 'pause' })")
    page.evaluate(f"morse.connection.send({{ type: 'rewind', time: {begin + 1.0} }})")
    label = page.locator(".history output")
    wait_until(lambda: label.text_content() == "0:01.00 / 0:02.02", label.text_content)
    clock = datetime.fromtimestamp(round(begin + 1.0, 2), tz=UTC)
    assert page.locator(".clock .time").text_content() == clock.strftime("%H:%M:%S.%f")[:11]
    page.evaluate("morse.components.selected.set('robot.gps')")
    value = page.locator(".inspector tr:has-text('latitude') td.value").first
    wait_until(lambda: re.fullmatch(r"43\.\d{8}", value.text_content() or ""), value.text_content)
    assert float(value.text_content()) == pytest.approx(place["latitude"], abs=1e-7)
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
    tape, random = PageRecording("run"), Random(1)
    for number in range(100):
        tape.time = number / 10
        tape.send(Picture(random.randbytes(1000), "eye", 10, 10, "image/jpeg", tape.time))
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
