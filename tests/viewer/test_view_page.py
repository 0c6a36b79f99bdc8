"""The page in a real browser: moving objects, saving the view, accessibility."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image
from view_pages import toasts
from view_worlds import playground

from morse.viewer.page_messages import ChangeScript, Drag, DragEnd, Teleport
from morse.viewer.view_messages import Log
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.browser

WIDE = {"width": 1200, "height": 700}
SIZE = WIDE  # of the page that tests share


def events(driver: Any, kind: type) -> list[Any]:
    return [event for event in driver.events if isinstance(event, kind)]


def place_of(page: Page, name: str) -> tuple[float, float]:
    x, y = page.evaluate(
        """(name) => { const p = morse.world.value.find(name).frame.position.clone().project(morse.stage.view.camera);
        const b = morse.stage.element.getBoundingClientRect();
        return [b.left + (p.x + 1) / 2 * b.width, b.top + (1 - p.y) / 2 * b.height] }""",
        name,
    )
    return x, y


# moving and saving ---------------------------------------------------------------------------------------


def test_pulling_is_a_force_while_time_runs_and_a_teleport_while_it_stands(shown) -> None:
    driver, page = shown
    driver.speed = 1.0
    page.evaluate("morse.panels.images.follows.set(false)")  # a picture would lie over the robot
    page.locator('[data-name="robot2"]').click()
    driver.time = 0.0
    driver.running = False
    wait_until(lambda: page.evaluate("morse.poses.value?.running === false"))
    page.keyboard.press("c")
    page.keyboard.press("m")
    wait_until(lambda: page.evaluate("morse.panels.mover.node.value?.name") == "robot2")
    page.evaluate("morse.panels.mover.handles.detach()")  # its handles cover the robot
    x, y = place_of(page, "robot2")
    page.mouse.move(x + 12, y + 6)
    page.mouse.down()
    page.mouse.move(x + 80, y - 30, steps=5)
    page.mouse.up()
    wait_until(lambda: events(driver, Teleport))
    last = events(driver, Teleport)[-1]
    assert last.node == "robot2"
    assert np.linalg.norm(last.quaternion) == pytest.approx(1.0, abs=1e-4)
    assert not events(driver, Drag)
    # the answer to a request comes after all requests before it
    add = "morse.connection.request({ type: 'call_service', component: 'robot0', service: 'add', arguments: [1, 2] })"
    assert page.evaluate(add)["value"] == 3
    count = len(events(driver, Teleport))
    driver.pace = 0.0  # a robot that stands where it is clicked, however late
    driver.running = True
    wait_until(lambda: page.evaluate("morse.poses.value?.running"))
    page.keyboard.press("3")
    page.keyboard.press("0")

    def held() -> tuple[float, float] | None:
        x, y = place_of(page, "robot2")  # the camera flies there
        page.mouse.move(x, y)
        page.mouse.down()
        if page.evaluate("morse.panels.mover.held !== null"):
            return x, y
        page.mouse.up()
        return None

    x, y = wait_until(held, "the robot is held")
    page.mouse.move(x + 60, y, steps=4)
    wait_until(lambda: events(driver, Drag))
    page.mouse.up()
    wait_until(lambda: events(driver, DragEnd))
    assert len(events(driver, Teleport)) == count
    assert np.linalg.norm(events(driver, Drag)[0].anchor) < 1.0


def test_handles_put_things_somewhere(shown) -> None:
    driver, page = shown
    page.locator('[data-name="robot0"]').click()
    page.keyboard.press("m")
    wait_until(lambda: page.evaluate("morse.panels.mover.node.value?.name") == "robot0")
    page.evaluate(
        """() => { const m = morse.panels.mover; m.handles.dragging = true; m.proxy.position.set(1, 2, 3);
        m.handles.dispatchEvent({type: 'mouseUp'}); m.handles.dragging = false }"""
    )
    wait_until(lambda: events(driver, Teleport))
    assert events(driver, Teleport)[0].position == pytest.approx((1.0, 2.0, 3.0))
    page.keyboard.press("Escape")
    wait_until(lambda: page.evaluate("morse.panels.mover.node.value") is None)


def test_screenshot_film_and_pose_as_code(shown, tmp_path) -> None:
    _, page = shown
    with page.expect_download() as shot:
        page.keyboard.press("x")
    shot.value.save_as(tmp_path / "view.png")
    pixels = np.asarray(Image.open(tmp_path / "view.png").convert("RGB"))
    assert pixels.std() > 10  # not a blank image
    page.get_by_role("button", name="Film the view").click()
    wait_until(lambda: page.evaluate("morse.panels.capture.recorder !== null"))
    frames = page.evaluate("morse.stage.frames")
    wait_until(lambda: page.evaluate("morse.stage.frames") > frames + 5)
    with page.expect_download() as film:
        page.get_by_role("button", name="Film the view").click()
    film.value.save_as(tmp_path / "view.webm")
    assert Path(tmp_path / "view.webm").read_bytes()[:4] == b"\x1aE\xdf\xa3"  # EBML, the container of WebM
    wait_until(lambda: page.locator('[data-name="robot0"]').count() == 1)
    code = page.evaluate("morse.panels.object.code(morse.world.value.find('ball'))")
    assert code == "ball.translate(-2, 1.5, 0.7)\nball.rotate(0, 0, 0)\n"


def test_the_gamepad_is_told(shown) -> None:
    driver, page = shown
    page.evaluate(
        "navigator.getGamepads = () => [{axes: [0.03, -0.5], buttons: [{pressed: true}]}];"
        "document.hasFocus = () => true"
    )
    wait_until(lambda: driver.server.gamepad() == ((0.0, -0.5), (True,)))
    page.evaluate("navigator.getGamepads = () => [{axes: [0, 0], buttons: [{pressed: false}]}]")
    wait_until(lambda: driver.server.gamepad() == ((0.0, 0.0), (False,)))
    page.evaluate("delete navigator.getGamepads; delete document.hasFocus")


# accessibility -------------------------------------------------------------------------------------------


def test_messages_are_listed_and_errors_pop_up(running, open_page) -> None:
    driver, url = running
    page = open_page(url, **WIDE)
    page.get_by_role("button", name="Plots and messages").click()
    lines = page.get_by_role("log").locator("p")
    assert lines.all_inner_texts() == ["No messages yet."]
    driver.server.send(Log("info", "wheels are on", "robot0", 1.5, 0))
    driver.server.send(Log("warning", "<img src=x onerror=alert(1)>", "", 2.0, 1))
    driver.server.send(Log("error", "wheels came off\n  File 'rover.py', line 3", "robot0.lidar", 2.5, 2))
    driver.server.send(Log("warning", "2.0 s lost", time=3.0, place=3, shown=True))
    wait_until(lambda: lines.count() == 4)
    assert lines.first.inner_text().split() == ["1.50", "robot0", "wheels", "are", "on"]
    assert lines.nth(1).locator("span").inner_text() == "<img src=x onerror=alert(1)>"
    wait_until(lambda: toasts(page, "error") == ["wheels came off"])
    assert "2.0 s lost" not in toasts(page)
    mark = page.locator('[data-name="robot0.lidar"] .mark.error')
    wait_until(lambda: mark.is_visible())
    assert page.locator('[data-name="robot0"] .mark').count() == 0
    lines.nth(2).get_by_role("button", name="robot0.lidar").click()
    wait_until(lambda: "came off" in page.locator(".complaint").inner_text())
    driver.server.send(driver.tree())  # as after a reset
    wait_until(lambda: mark.count() == 0)


def test_a_message_that_the_page_shows_elsewhere_leaves_the_messages_beside_plots_closed(running, open_page) -> None:
    driver, url = running
    page = open_page(url, **WIDE)
    page.locator('[data-name="robot0.lidar"]').click()
    page.get_by_role("rowheader", name="x", exact=True).last.press("Enter")
    wait_until(lambda: page.locator(".plot").count() == 1)
    log = page.locator(".log")
    driver.server.send(Log("warning", "2.0 s lost", place=0, shown=True))
    wait_until(lambda: log.locator("p.warning").count() == 1)
    assert not log.is_visible()
    driver.server.send(Log("warning", "wheels are loose", place=1))
    wait_until(log.is_visible)


def test_a_request_that_is_too_long_is_answered_and_the_page_stays(running, open_page) -> None:
    driver, url = running
    page = open_page(url, **WIDE)
    text = page.evaluate(
        """() => morse.connection
        .request({ type: 'change_script', text: '\u20ac'.repeat(90_000), version: '', write: false })
        .then((answer) => answer.error)"""
    )
    assert "263 KiB of at most 256" in text
    add = "morse.connection.request({ type: 'call_service', component: 'robot0', service: 'add', arguments: [1, 2] })"
    assert page.evaluate(add)["value"] == 3
    assert not events(driver, ChangeScript)


def test_a_page_that_is_loaded_again_reads_the_log_without_news(running, open_page) -> None:
    driver, url = running
    driver.server.send(Log("error", "wheels came off", "robot0.lidar", 2.5))
    page = open_page(url, **WIDE)
    wait_until(lambda: page.locator('[data-name="robot0.lidar"] .mark.error').count() == 1)
    assert toasts(page) == []
    assert page.evaluate("document.querySelectorAll('.log p').length") == 1


def test_a_page_that_the_browser_keeps_for_the_back_button_does_not_drive_on(served, open_page) -> None:
    server, url = served
    scene, moving = playground()
    server.set_scene(scene, moving)
    page = open_page(url)
    wait_until(lambda: server.watched)
    # browsers for tests keep no pages: the events are those of a browser that does
    page.evaluate("void dispatchEvent(new PageTransitionEvent('pagehide', { persisted: true }))")
    wait_until(lambda: not server.watched, "the page has left")
    with page.expect_navigation():
        page.evaluate("void dispatchEvent(new PageTransitionEvent('pageshow', { persisted: true }))")
    wait_until(lambda: page.evaluate("Boolean(window.morse?.seat.drives.value)"), "it drives again")


@pytest.mark.parametrize(("width", "height"), [(390, 780), (640, 360)])
def test_small_screens_scroll_nowhere_and_keep_the_view(running, open_page, width, height) -> None:
    _, url = running
    page = open_page(url, width=width, height=height)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    view = page.locator("main").bounding_box()
    assert view is not None
    assert view["width"] == width
    assert view["height"] > height * 0.6
    page.get_by_role("button", name="Robots and components").click()
    wait_until(lambda: page.locator('[data-name="robot0"]').is_visible())
    page.get_by_role("button", name="Plots and messages").click()
    wait_until(lambda: not page.locator('[data-name="robot0"]').is_visible())


def test_twice_the_text_size_still_fits(shown) -> None:
    _, page = shown
    page.set_viewport_size({"width": 1280, "height": 800})
    page.evaluate("document.documentElement.style.fontSize = '28px'")
    wait_until(lambda: page.evaluate("document.documentElement.scrollWidth") <= 1280)
    view = page.locator("main").bounding_box()
    assert view is not None
    assert view["width"] > 400
    assert view["height"] > 300
    page.keyboard.press("h")
    box_of = page.get_by_role("dialog").bounding_box()
    assert box_of is not None
    assert box_of["height"] <= 800
    page.evaluate("document.documentElement.style.fontSize = ''")


def test_the_bundle_stays_small_and_names_its_libraries() -> None:
    import gzip

    from morse.viewer.site import STATIC

    assert "Leon Sorokin" in (STATIC / "assets" / "licences.txt").read_text()
    packed = {path.name: len(gzip.compress(path.read_bytes())) for path in STATIC.rglob("*") if path.is_file()}
    # fetched when the script is opened
    (editor,) = (name for name in packed if name.startswith("codeeditor"))
    assert "codeeditor" not in (STATIC / "index.html").read_text()
    assert packed.pop(editor) <= 140_000
    assert sum(packed.values()) <= 300_000


def test_a_browser_without_webgl_is_told(served, open_page) -> None:
    server, url = served
    page = open_page(url, wait=False)
    page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    page.goto(url)
    wait_until(lambda: "needs WebGL 2" in page.inner_text("body"))
    wait_until(lambda: not server.watched)  # it drives nothing, either


def test_what_the_script_asks_of_the_view(running, open_page) -> None:
    driver, url = running
    scene, moving = playground()
    scene.settings.view.display.images = ("robot2.lidar",)
    scene.settings.view.show_framerate = True
    driver.server.set_scene(scene, moving)
    page = open_page(url, **WIDE)
    wait_until(lambda: driver.server.wishes.images == {"robot2.lidar"})
    wait_until(lambda: "frames/s" in page.locator(".rate").inner_text())
