"""An earlier run beside the one that a page shows: two recordings over each other."""

from __future__ import annotations

import base64
import zlib
from pathlib import Path
from typing import Any

import pytest

import morse
from morse.cli.app import execute
from tests.kit.waiting import wait_until

pytestmark = pytest.mark.browser

SCENE = """
from morse.builder import *
robot = ATRV("robot")
motion = MotionXYW("motion"); robot.append(motion)
box = PassiveObject("props/crates", object_name="small_crate"); box.translate(8.0, 4.0)
env = Environment("empty")
"""
SECONDS = 2.0
X = "morse.panels.ghost.shown?.find('robot').frame.position.x ?? -1"


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of two exported runs of a robot: at 1 m/s and at 2 m/s."""
    folder = tmp_path_factory.mktemp("runs")
    (folder / "scene.py").write_text(SCENE)
    for name, speed in (("slow", 1.0), ("fast", 2.0)):
        recording = folder / f"{name}.mcap"
        with morse.load(folder / "scene.py") as sim, sim.record(recording):
            sim.robot.motion.publish({"x": speed, "y": 0.0, "w": 0.0})
            sim.step(round(SECONDS * 60))
        assert execute(["export", str(recording), "--html", str(recording.with_suffix(".html"))]) == 0
    return folder


@pytest.fixture
def page(runs: Path, browser: Any) -> Any:
    errors: list[str] = []
    page = browser.new_page(viewport={"width": 1000, "height": 600})
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.goto((runs / "slow.html").as_uri() + "?quality=low")
    wait_until(lambda: page.evaluate("!!(window.morse?.world.value && morse.stage.frames > 0)"), "a world")
    yield page
    page.close()
    assert errors == []


def bomb() -> bytes:
    """A gzip file of 0.6 GB of zeros."""
    packer, zeros = zlib.compressobj(1, wbits=31), bytes(16 << 20)
    return b"".join(packer.compress(zeros) for _ in range(38)) + packer.flush()


def choose(page: Any, file: Path) -> None:
    page.get_by_label("an exported run").set_input_files(str(file))


def test_two_runs_are_seen_at_the_same_time_since_their_beginning(page: Any, runs: Path) -> None:
    choose(page, runs / "fast.html")
    page.locator(".beside").get_by_text("fast.html").wait_for()
    for time in (1.0, 1.5, 0.5):
        page.evaluate(f"morse.connection.send({{ type: 'rewind', time: {time} }})")
        wait_until(lambda time=time: page.evaluate(X) == pytest.approx(2.0 * time, abs=0.06), "the earlier run")
        assert page.evaluate("morse.world.value.find('robot').frame.position.x") == pytest.approx(time, abs=0.06)
    # translucent, no obstacle for the pointer, and only what moves
    drawn = page.evaluate(
        """() => {
            const found = [];
            morse.panels.ghost.shown.root.traverse((one) => one.isMesh && found.push(one.material.opacity));
            return found;
        }"""
    )
    assert drawn
    assert max(drawn) < 0.5
    assert page.evaluate("morse.panels.ghost.shown.root.parent === morse.stage.scene")
    page.get_by_role("button", name="Close the earlier run").click()
    assert page.evaluate("morse.panels.ghost.shown") is None


def test_what_is_no_exported_run_is_named_and_never_executed(page: Any, runs: Path, tmp_path: Path) -> None:
    whole = (runs / "fast.html").read_text()
    begin = whole.index('<script id="tape"')
    script = "<script>window.hit = 1</script><img src=x onerror='window.hit = 1'>"
    files = {
        "nothing.html": "",
        "script.html": script,
        "half.html": whole[: begin + 5000],
        "odd.html": f'<script id="tape">{script}',
        "letters.html": '<script id="tape">%%%%</script>',
        "zeros.html": f'<script id="tape">{"A" * 4000}</script>',
        "bomb.html": f'<script id="tape">{base64.b64encode(bomb()).decode()}</script>',
        "cut.html": whole[: begin + 3000] + "</script>",
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text)
        choose(page, tmp_path / name)
        told = page.locator(".toast.error").get_by_text(f"{name} cannot be shown")
        told.wait_for()
        assert name != "bomb.html" or "more than 512 MB" in told.inner_text()
        assert page.evaluate("[window.hit, morse.panels.ghost.shown]") == [None, None], name
    # a file with a script beside its run is read, not run
    (tmp_path / "both.html").write_text(script + whole)
    choose(page, tmp_path / "both.html")
    page.locator(".beside").get_by_text("both.html").wait_for()
    assert page.evaluate("window.hit ?? null") is None
