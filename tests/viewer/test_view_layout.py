"""The layout of the page at different sizes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from shared_page import FROM_THE_TOP
from view_worlds import playground

from morse.viewer.description import ComponentDescription, FieldDescription
from morse.viewer.view_messages import (
    DebugProperties,
    DebugProperty,
    Listening,
    Log,
    RecordingDescription,
    Recordings,
    SoundState,
    Tree,
    Values,
)
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.browser

#: of the page that tests share
SIZE = {"width": 1200, "height": 700}
#: a button is 2 rem high, and the header a little higher
ROW = 44
CUT_OFF = """() => [...document.querySelectorAll(".bar *")].filter((e) => e.checkVisibility())
    .map((e) => e.getBoundingClientRect()).filter((e) => e.right > innerWidth + 0.5 || e.left < -0.5).length"""
LINES = """[...document.querySelectorAll(".help dd")]
    .map((e) => Math.round(e.clientHeight / parseFloat(getComputedStyle(e).lineHeight)))"""


def header(page: Page) -> float:
    height: float = page.evaluate("morse.shell.header.getBoundingClientRect().height")
    return height


def test_the_header_is_one_row(running, open_page) -> None:
    driver, url = running
    driver.server.send(Listening(["a_robot_with_a_rather_long_name", "robot1"]))
    driver.server.send(SoundState("robot0", "stop", None, 0.0, 0.0))
    driver.server.send(Recordings([]))
    drives, watches = open_page(url), open_page(url)
    wait_until(lambda: watches.get_by_role("button", name="ask to drive").is_visible())
    wait_until(lambda: drives.get_by_text("you drive").is_visible())
    wait_until(lambda: all(page.evaluate("morse.poses.value !== null") for page in (drives, watches)))
    driver.shown = False  # nothing need move
    for width in (640, 760, 899, 900, 1000, 1100, 1280):
        for page in (drives, watches):
            page.set_viewport_size({"width": width, "height": 420})
            wait_until(lambda page=page, width=width: page.evaluate("innerWidth") == width)
            wait_until(
                lambda page=page: header(page) < ROW and page.evaluate(CUT_OFF) == 0, f"one row at {width} pixels"
            )


@pytest.mark.parametrize("touch", [False, True])
def test_a_telephone_has_one_row(running, open_page, touch: bool) -> None:
    driver, url = running
    driver.server.send(Listening(["a_robot_with_a_rather_long_name", "robot1"]))
    driver.server.send(SoundState("robot0", "stop", None, 0.0, 0.0))
    driver.server.send(Recordings([]))
    page = open_page(url, width=390, height=780, has_touch=touch, is_mobile=touch)
    assert header(page) < ROW * (1.35 if touch else 1.0)
    assert page.evaluate(CUT_OFF) == 0
    page.evaluate("document.querySelector('.more').click()")
    for name in ("One tick (.)", "Reset (F11)", "speed"):
        assert page.get_by_title(name, exact=True).is_visible()
    # a choice in a list does not close the menu before it is made
    page.locator(".extra select").first.click()
    assert page.locator(".extra").is_visible()
    page.set_viewport_size({"width": 1000, "height": 780})
    wait_until(lambda: page.locator(".clock select").is_visible())


def test_what_has_no_room_is_behind_a_button(running, open_page) -> None:
    _, url = running
    page = open_page(url, width=640)
    shot = page.get_by_role("button", name="Screenshot")
    more = page.get_by_role("button", name="More")
    assert not shot.is_visible()
    more.click()
    assert shot.is_visible()
    page.keyboard.press("Escape")
    assert not shot.is_visible()
    assert more.evaluate("button => button === document.activeElement")
    more.press("Enter")
    page.get_by_role("button", name="Light or dark").click()
    assert page.evaluate("document.documentElement.dataset.theme") == "dark"
    assert not shot.is_visible()
    page.set_viewport_size({"width": 1200, "height": 600})
    wait_until(lambda: shot.is_visible() and not more.is_visible())


def test_keys_are_listed_in_few_lines(shown) -> None:
    _, page = shown
    page.set_viewport_size({"width": 1280, "height": 720})
    wait_until(lambda: page.evaluate("innerWidth") == 1280)
    page.keyboard.press("h")
    heights = page.evaluate(LINES)
    assert len(heights) > 25
    assert max(heights) <= 2
    assert heights.count(2) <= 4
    assert page.evaluate("(e => e.scrollHeight <= e.clientHeight)(document.querySelector('.help'))")


def test_properties_that_the_script_asks_for_are_listed(shown) -> None:
    driver, page = shown
    panel = page.locator(".debug")
    assert not panel.is_visible()
    driver.server.send(DebugProperties([DebugProperty("door", "open", "True"), DebugProperty("<b>", "x", "1")], 3))
    wait_until(panel.is_visible)
    assert panel.locator("tr").all_inner_texts() == ["door.open\tTrue", "<b>.x\t1"]
    assert panel.locator("p").inner_text() == "and 3 more"
    driver.server.send(DebugProperties([]))
    wait_until(lambda: not panel.is_visible())


WHERE = """(e => [e.getAttribute("aria-label") || e.title || e.textContent, e.getClientRects().length > 0
    && getComputedStyle(e).outlineStyle === "solid"])(document.activeElement)"""


NAMED = """(name) => [...document.querySelectorAll("input, select")]
    .some((e) => (e.getAttribute("aria-label") || e.title) === name && e.checkVisibility())"""


NAMELESS = """[...document.querySelectorAll('button, select, input, summary')].filter((e) => e.checkVisibility() && !(
    e.ariaLabel || e.innerText?.trim() || e.labels?.length)).map((e) => e.outerHTML)"""


def test_everything_is_named_reached_by_tab_and_seen_to_be(shown) -> None:
    _, page = shown
    page.evaluate("morse.components.selected.set('robot0.lidar')")
    page.get_by_role("heading", name="robot0.lidar").wait_for()
    # the inspector requests the properties now: its last row appears after its heading
    page.wait_for_function(NAMED, arg="scan_window")
    assert page.evaluate(NAMELESS) == []
    page.evaluate(FROM_THE_TOP)
    wanted = page.evaluate(
        """[...document.querySelectorAll("button, select, summary, input, [tabindex='0']")]
        .filter((e) => e.checkVisibility() && !e.disabled).length"""
    )
    reached = []
    while len(reached) < 100:
        page.keyboard.press("Tab")
        focused = page.evaluate(f"document.activeElement === document.body ? null : {WHERE}")
        if focused is None:
            break
        name, seen = focused
        assert seen, name
        reached.append(name)
    assert len(reached) == wanted > 30
    assert {
        "Pause", "One tick", "Reset", "speed", "view", "Screenshot", "Keys", "robots and components",
        "find in the tree", "scan_window", "call",
    } <= set(reached)  # fmt: skip


def test_escape_leaves_menus_and_keeps_the_selection(shown) -> None:
    _, page = shown
    page.evaluate("morse.components.selected.set('robot0.lidar')")
    menu = page.locator("summary[title=view]")
    menu.press("Enter")
    page.get_by_label("names of robots").press("Space")
    assert page.evaluate("morse.panels.layers.list.find((layer) => layer.id === 'names').on")
    page.keyboard.press("Escape")
    assert not page.get_by_label("names of robots").is_visible()
    assert menu.evaluate("e => e === document.activeElement")
    assert page.evaluate("morse.components.selected.value") == "robot0.lidar"


def test_the_list_of_keys_keeps_the_focus_until_escape(shown) -> None:
    _, page = shown
    page.keyboard.press("h")
    inside = "(e => e === document.body || document.querySelector('dialog').contains(e))(document.activeElement)"
    for _ in range(6):
        page.keyboard.press("Tab")
        assert page.evaluate(inside)
    page.keyboard.press("Escape")
    assert not page.get_by_role("dialog", name="Keys").is_visible()


#: left, top, right and bottom of the first element that a selector finds
EDGES = """(selector) => { const box = document.querySelector(selector).getBoundingClientRect();
    return [box.left, box.top, box.right, box.bottom] }"""
SMALL = """[...document.querySelectorAll(".image button, .recording button, .popup label, .extra button")]
    .filter((e) => e.checkVisibility()).map((e) => [e.ariaLabel, e.getBoundingClientRect()])
    .filter(([, box]) => box.width < 43.5 || box.height < 43.5).map(([name]) => name)"""

#: largest distance of a menu from the header, pixels
GAP = 12
CUT_TEXTS = """[...document.querySelectorAll(".popup button")].filter((e) => e.checkVisibility())
    .filter((e) => e.scrollWidth > e.clientWidth).map((e) => e.textContent)"""


@pytest.mark.parametrize(("width", "height"), [(390, 780), (780, 360)])
def test_on_a_telephone_nothing_lies_over_what_a_thumb_needs(served, open_page, width, height) -> None:
    server, url = served
    scene, moving = playground()
    server.set_scene(scene, moving)
    image = [FieldDescription("image", "buffer")]
    camera = ComponentDescription("robot0.lidar", "sensor", "robot0", data=image, pictured=True)
    server.send(Tree([ComponentDescription("robot0", "robot", "robot0"), camera]))
    server.send(Listening(["robot0"]))
    server.send(Recordings([RecordingDescription("/a/run.mcap", 1.0, 500, stoppable=True)]))
    page = open_page(url, width=width, height=height, has_touch=True, is_mobile=True)
    page.evaluate("morse.components.selected.set('robot0.lidar')")
    wait_until(lambda: page.locator(".image").is_visible() and page.locator(".touchpad").is_visible())
    _, _, right, bottom = page.evaluate(EDGES, ".image")
    left, top, _, _ = page.evaluate(EDGES, ".touchpad")
    assert right <= left or bottom <= top
    assert page.evaluate(SMALL) == []
    header_end = page.evaluate(EDGES, ".bar")[3]
    page.evaluate("document.querySelector('summary[title=view]').click()")
    _, top, _, bottom = page.evaluate(EDGES, ".popup")
    assert header_end - 1 <= top <= header_end + GAP
    assert bottom <= height
    assert page.evaluate(SMALL) == []
    assert page.evaluate(CUT_TEXTS) == []
    page.evaluate("document.querySelector('.more').click()")
    wait_until(lambda: page.locator(".extra").is_visible())
    assert header_end - 1 <= page.evaluate(EDGES, ".extra")[1] <= header_end + GAP
    assert page.evaluate(SMALL) == []


@pytest.mark.parametrize(("width", "height"), [(390, 780), (780, 360)])
def test_on_a_telephone_plots_are_below_the_world_with_their_times(served, open_page, width, height) -> None:
    server, url = served
    server.set_scene(*playground())
    server.send(Listening(["robot0"]))
    values = [FieldDescription(name, "float") for name in ("x", "y", "z")]
    pose = ComponentDescription("robot0.pose", "sensor", "robot0", data=values)
    server.send(Tree([ComponentDescription("robot0", "robot", "robot0"), pose]))
    page = open_page(url, width=width, height=height, has_touch=True, is_mobile=True)
    wait_until(lambda: page.evaluate("morse.components.all.value.length > 1"))
    page.evaluate("for (const field of ['x', 'y', 'z']) morse.panels.plots.plot('robot0.pose', field)")
    wait_until(lambda: page.locator(".bottom").is_visible())
    for _ in range(2):
        server.send(Values("robot0.pose", 1.0, {"x": 1.0, "y": 2.0, "z": 3.0}))
    wait_until(lambda: page.locator(".plot canvas").count() == 3)
    # the world is above, in its whole height, and the pad can be reached
    _, view_top, _, view_bottom = page.evaluate(EDGES, ".view > canvas")
    _, bottom_top, _, bottom_end = page.evaluate(EDGES, ".bottom")
    assert view_bottom <= bottom_top + 1
    assert view_bottom - view_top >= 100
    assert bottom_end <= height + 1
    assert page.evaluate(EDGES, ".touchpad")[3] <= bottom_top
    # the lower edge of a chart has the times
    cut = """[...document.querySelectorAll(".plot .canvas")].map((box) => [box.scrollHeight, box.clientHeight])
        .filter(([whole, seen]) => whole > seen + 1)"""
    wait_until(lambda: page.evaluate(cut) == [], "whole charts")
    # the latest plot is in sight
    left, _, right, _ = page.evaluate(EDGES, ".plot:nth-of-type(3)")
    assert left >= -1
    assert right <= page.evaluate(EDGES, ".plots")[2] + 1


def test_on_a_telephone_messages_are_beside_plots_only_if_something_is_wrong(served, open_page) -> None:
    server, url = served
    server.set_scene(*playground())
    pose = ComponentDescription("robot0.pose", "sensor", "robot0", data=[FieldDescription("x", "float")])
    server.send(Tree([ComponentDescription("robot0", "robot", "robot0"), pose]))
    server.send(Log("info", "SCENE INITIALIZED", "", 0.0))
    page = open_page(url, width=390, height=780, has_touch=True, is_mobile=True)
    wait_until(lambda: page.evaluate("morse.components.all.value.length > 1"))
    page.evaluate("morse.panels.plots.plot('robot0.pose', 'x')")
    server.send(Values("robot0.pose", 1.0, {"x": 1.0}))
    page.locator(".plot canvas").wait_for()
    assert not page.locator(".log").is_visible()
    server.send(Log("error", "robot0.pose has failed", "", 1.0))
    page.locator(".log").get_by_text("robot0.pose has failed").wait_for()


@pytest.mark.parametrize(
    ("width", "height", "upward"), [(1200, 700, 0.8 * 700 / 1200), (390, 780, 1.1), (780, 390, 0.4)]
)
def test_a_high_picture_shows_more_of_the_width(served, open_page, width, height, upward) -> None:
    server, url = served
    server.set_scene(*playground())
    page = open_page(url, width=width, height=height)
    lens = """(aspect) => {
        const { view } = morse.stage;
        view.setLens(20, 0.1, 100);
        view.setAspect(aspect);
        return Math.tan(view.camera.fov * Math.PI / 360);
    }"""
    # a lens of 20 mm before 32 mm along the longer side
    assert page.evaluate(lens, width / height) == pytest.approx(upward)
