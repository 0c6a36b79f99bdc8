"""The page shows the true state, and no work is lost by accident."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from view_worlds import box, mesh_node

from morse.scene import ComponentDeclaration, Scene
from morse.viewer.description import ComponentDescription, FieldDescription, PropertyDescription
from morse.viewer.page_messages import Command, DragEnd, Quit, Rewind, StepBack
from morse.viewer.view_messages import (
    History,
    Listening,
    Rays,
    Tree,
    Values,
    Viewpoint,
)
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.browser

WIDE = {"width": 1100, "height": 700}
SIZE = WIDE  # of the page that tests share


def events(driver: Any, kind: type) -> list[Any]:
    return [event for event in driver.events if isinstance(event, kind)]


def select(page: Page, name: str) -> None:
    page.evaluate("name => morse.components.selected.set(name)", name)


def on_page(page: Page, place: list[float]) -> tuple[float, float]:
    """The pixel of a point of the world."""
    x, y = page.evaluate(
        """([x, y, z]) => {
            const { view } = morse.stage;
            view.update();
            const p = view.position.clone().set(x, y, z).project(view.camera);
            const r = morse.stage.renderer.domElement.getBoundingClientRect();
            return [r.left + ((p.x + 1) / 2) * r.width, r.top + ((1 - p.y) / 2) * r.height];
        }""",
        place,
    )
    return x, y


# the connection ------------------------------------------------------------------------------------------


def test_a_simulation_that_has_ended_is_not_called_lost(make_server, open_page) -> None:
    server, url = make_server()
    page = open_page(url, wait=False)
    link = page.locator(".link")
    wait_until(lambda: not link.is_visible())
    server.stop()
    wait_until(lambda: "has ended" in link.inner_text())
    # attempts to reconnect fail in the meantime
    for _ in range(20):
        page.wait_for_timeout(100)
        assert "has ended" in link.inner_text()


def test_the_last_page_that_is_left_takes_the_wheel(running, open_page) -> None:
    _, url = running
    first, second = open_page(url), open_page(url)
    wait_until(lambda: second.get_by_role("button", name="ask to drive").is_visible())
    first.close()
    wait_until(lambda: second.evaluate("morse.seat.drives.value"))


def test_a_page_that_watches_cannot_end_the_simulation(running, open_page) -> None:
    _, url = running
    first, second = open_page(url), open_page(url)
    # in narrow windows it is behind another button
    button = second.get_by_role("button", name="End the simulation", include_hidden=True)
    wait_until(lambda: second.get_by_role("button", name="ask to drive").is_visible())
    wait_until(button.is_disabled)
    assert "only the page that drives" in str(button.get_attribute("title"))
    first.close()
    wait_until(button.is_enabled)
    assert button.get_attribute("title") == "End the simulation"


def test_quit_asks(shown) -> None:
    driver, page = shown
    page.get_by_role("button", name="End the simulation").click()
    page.keyboard.press("Escape")
    wait_until(lambda: page.get_by_role("dialog").count() == 0)
    page.get_by_role("button", name="End the simulation").click()
    assert events(driver, Quit) == []
    page.get_by_role("dialog").get_by_role("button", name="end it").click()
    wait_until(lambda: len(events(driver, Quit)) == 1)


# accidents -----------------------------------------------------------------------------------------------


LEAVES = "!dispatchEvent(new Event('beforeunload', { cancelable: true }))"


def leave(page: Page) -> bool:
    """Whether the browser asks before it leaves the page."""
    return page.evaluate(LEAVES)


def test_a_page_is_not_left_by_accident_while_its_user_flies_or_looks_around(shown) -> None:
    driver, page = shown
    assert not leave(page)
    page.keyboard.down("w")
    assert leave(page)
    # in one question, because it lasts for a moment only: the next key may be late
    asks = "dispatchEvent(new KeyboardEvent('keyup', { code: 'KeyW', key: 'w' })) && " + LEAVES
    assert page.evaluate(asks)
    page.keyboard.up("w")
    wait_until(lambda: not leave(page))
    page.mouse.move(300, 250)
    page.keyboard.down("Control")
    page.mouse.move(320, 250)
    assert leave(page)
    height = page.evaluate("morse.stage.view.position.z")
    note = (
        "() => addEventListener('keydown', e => setTimeout(() => (window.taken = e.defaultPrevented)), { once: true })"
    )
    page.evaluate(note)
    page.keyboard.down("r")  # reloads the page elsewhere
    wait_until(lambda: page.evaluate("window.taken") is True)
    wait_until(lambda: page.evaluate("morse.stage.view.position.z") > height + 0.1)
    page.keyboard.up("r")
    page.keyboard.up("Control")
    wait_until(lambda: not leave(page))
    page.keyboard.down("Control")
    assert not leave(page)  # without flying or looking around, the key is for the browser
    page.evaluate(note)
    key = "{ code: 'KeyR', key: 'r', ctrlKey: true, cancelable: true }"
    page.evaluate(f"dispatchEvent(new KeyboardEvent('keydown', {key}))")
    wait_until(lambda: page.evaluate("window.taken") is False)
    page.keyboard.up("Control")
    assert driver.running


def test_a_click_on_the_ground_selects_nothing(scenes) -> None:
    ground = mesh_node("ground", box("g"), (0, 0, -1))
    ground.scale = (40.0, 40.0, 1.0)
    wall = mesh_node("wall", box("w"), (0, 4, 0))
    wall.scale = (12.0, 0.4, 4.0)
    scene = Scene("s", roots=[ground, mesh_node("crate", box("c"), (0, 0, 0)), wall])
    scene.settings.view.camera_location = (0.0, -9.0, 7.0)
    scene.settings.view.camera_rotation = (math.radians(52), 0.0, 0.0)
    page = scenes.show(scene)
    selected = "morse.components.selected.value"

    for place, wanted in (([0.0, 0.0, 0.5], "crate"), ([3.0, -2.0, 0.0], None), ([-3.0, 3.8, 1.0], "wall")):
        page.mouse.click(*on_page(page, place))
        wait_until(lambda wanted=wanted: page.evaluate(selected) == wanted, f"the selection of {wanted}")


# after a reload ------------------------------------------------------------------------------------------


def test_a_reload_keeps_selection_and_plots(running, open_page) -> None:
    driver, url = running
    page = open_page(url, **WIDE)
    select(page, "robot1.lidar")
    wait_until(lambda: page.evaluate("morse.components.valuesOf('robot1.lidar') !== null"))
    page.get_by_role("rowheader", name="x", exact=True).last.press("Enter")
    page.get_by_label("time shown").select_option("5 s")
    wait_until(lambda: page.locator(".legend li").count() == 1)
    select(page, "robot0.lidar")
    page.reload()
    wait_until(lambda: page.evaluate("!!window.morse?.world.value"))
    wait_until(lambda: page.evaluate("morse.components.selected.value") == "robot0.lidar")
    wait_until(lambda: page.locator(".legend li").count() == 1)
    assert page.locator(".legend li").inner_text().startswith("robot1.lidar.x")
    assert page.get_by_label("time shown").input_value() == "5"
    wait_until(lambda: page.evaluate("morse.panels.plots.plots[0].times.length") > 5)
    wait_until(lambda: driver.server.wishes.values == {"robot0.lidar", "robot1.lidar"})


# plots ---------------------------------------------------------------------------------------------------

PLACES = "(selector) => [...document.querySelectorAll(selector)].map((e) => e.getBoundingClientRect().toJSON())"


def test_plots_say_whose_field_it_is_and_show_a_window_of_time(shown) -> None:
    _, page = shown
    for robot in ("robot0", "robot1"):
        select(page, f"{robot}.lidar")
        wait_until(lambda name=robot: page.evaluate(f"morse.components.valuesOf('{name}.lidar') !== null"))
        page.evaluate(f"morse.panels.plots.plot('{robot}.lidar', 'x', morse.panels.plots.plots[0] ?? null)")
        page.evaluate(f"morse.panels.plots.plot('{robot}.lidar', 'position', morse.panels.plots.plots[0])")
    for i in range(3):
        page.evaluate(
            "i => morse.panels.plots.plots[0].add({ component: 'robot2.lidar', path: `position.${i}`, unit: 'm' })", i
        )
    labels = page.locator(".legend li")
    wait_until(lambda: labels.count() == 11)
    texts = labels.all_inner_texts()
    assert texts[0].startswith("robot0.lidar.x")
    assert texts[4].startswith("robot1.lidar.x")
    inks = [labels.nth(i).get_attribute("style") for i in range(11)]
    assert len(set(inks)) == 11
    page.get_by_label("time shown").select_option("5 s")
    scale = "(s => s.max - s.min)(morse.panels.plots.plots[0].chart.scales.x)"
    wait_until(lambda: page.evaluate(scale) == pytest.approx(5.0))
    # every button is within the area of the plots, also in narrow windows
    for width in (1100, 920):
        page.set_viewport_size({"width": width, "height": 700})
        wait_until(lambda width=width: page.evaluate("innerWidth") == width)
        room, *tools = page.evaluate(PLACES, ".plots, figure.plot .tools > *")  # at once: each question takes long
        assert len(tools) >= 4
        for place in tools:
            assert room["left"] <= place["left"] < place["right"] <= room["right"] + 0.5
            assert place["top"] < place["bottom"] <= room["bottom"]


def test_a_plot_forgets_what_is_no_longer_to_come(shown) -> None:
    driver, page = shown
    driver.measures = False
    select(page, "robot0.lidar")
    send = driver.server.send
    send(Values("robot0.lidar", 1.0, {"x": 1.0}))
    wait_until(lambda: page.evaluate("morse.components.valuesOf('robot0.lidar') !== null"))
    page.evaluate("morse.panels.plots.plot('robot0.lidar', 'x')")
    for time in (2.0, 3.0, 4.0, 2.5):
        send(Values("robot0.lidar", time, {"x": time}))
        wait_until(lambda t=time: page.evaluate("morse.panels.plots.plots[0].times.at(-1)") == t)
    assert page.evaluate("morse.panels.plots.plots[0].times") == [2.0, 2.5]


# what is drawn -------------------------------------------------------------------------------------------


def many_robots(scenes: Any, count: int) -> Page:
    """A page of robots in a row, half a metre apart, each with a sensor."""
    nodes = [mesh_node(f"robot{i}", box(f"b{i}"), (0.5 * i, 0, 0.5)) for i in range(count)]
    scene = Scene("s", roots=nodes)
    for node in nodes:
        node.scale = (0.2, 0.2, 0.2)
        scene.components.append(_declaration(node))
    scene.settings.view.camera_location = (0.0, -6.0, 2.0)
    scene.settings.view.camera_rotation = (math.radians(75), 0.0, 0.0)
    page: Page = scenes.show(scene)
    components = []
    for i in range(count):
        components.append(ComponentDescription(f"robot{i}", "robot", f"robot{i}"))
        components.append(ComponentDescription(f"robot{i}.eye", "sensor", f"robot{i}"))
    scenes.server.send(Tree(components))
    wait_until(lambda: page.evaluate("morse.components.all.value.length") == 2 * count)
    return page


def _declaration(node: Any) -> Any:
    return ComponentDeclaration(node, "robot", "test.Robot", node)


def test_names_of_robots_do_not_pile_up(scenes) -> None:
    page = many_robots(scenes, 20)
    page.set_viewport_size(WIDE)
    page.evaluate("morse.panels.layers.switch('names', true)")
    # all boxes of one frame: the visible names change while the camera moves
    shown = """[...document.querySelectorAll(".names span:not([hidden])")].map(label => {
        const {x, y, width, height} = label.getBoundingClientRect(); return {x, y, width, height}; })"""
    boxes = wait_until(lambda: len(found := page.evaluate(shown)) > 3 and found, "names of robots")
    for i, a in enumerate(boxes):
        for b in boxes[:i]:
            apart = (
                a["x"] >= b["x"] + b["width"] or b["x"] >= a["x"] + a["width"]
                or a["y"] >= b["y"] + b["height"] or b["y"] >= a["y"] + a["height"]
            )  # fmt: skip
            assert apart, (a, b)


def test_of_many_robots_the_nearest_show_rays_and_the_page_says_so(scenes) -> None:
    page, server = many_robots(scenes, 20), scenes.server
    page.set_viewport_size(WIDE)
    page.locator("summary[title=view]").click()
    page.get_by_label("rays and points").check()
    wait_until(lambda: server.wishes.overlays == {f"robot{i}.eye" for i in range(8)})
    assert page.get_by_text("Rays, cones and fields of view of 8 of 20 robots").is_visible()
    select(page, "robot19")
    wait_until(lambda: server.wishes.overlays == {f"robot{i}.eye" for i in (*range(7), 19)})


def test_a_ray_that_meets_nothing_fades_out(shown) -> None:
    driver, page = shown
    page.evaluate("morse.panels.layers.switch('rays', true)")
    rays = np.array([[0, 0, 1, 30, 0, 1, 0], [0, 0, 1, 0, 5, 1, 1], [0, 0, 1, 0.1, 0, 1, 0]], "<f4")
    # of sensors that the page does not know
    page.evaluate("morse.panels.layers.rays.keep(['other']); morse.panels.layers.rays.keep = () => {}")
    driver.server.send(Rays(component="other", payload=rays.tobytes()))
    drawn = "morse.panels.layers.rays.drawn.get('other')"
    wait_until(lambda: page.evaluate(f"!!{drawn}"))
    ends = np.array(page.evaluate(f"[...{drawn}.beams.geometry.attributes.position.array]")).reshape(3, 2, 3)
    assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) == pytest.approx([5.0, 5.0, 0.1], abs=1e-5)
    colors = np.array(page.evaluate(f"[...{drawn}.beams.geometry.attributes.color.array]")).reshape(3, 2, 4)
    assert (colors[:, 1, 3] > 0).tolist() == [False, True, False]
    assert (colors[:, 0, 3] > 0).all()
    assert page.evaluate(f"{drawn}.hits.geometry.attributes.position.count") == 1
    page.evaluate("delete morse.panels.layers.rays.keep")


def test_f7_does_not_end_behind_furniture(scenes) -> None:
    many_robots_scene = Scene("s", roots=[mesh_node("robot0", box("r"), (0, 0, 0.5))])
    (robot,) = many_robots_scene.roots
    robot.scale = (0.4, 0.4, 0.4)
    many_robots_scene.components.append(_declaration(robot))
    for name, place, scale in (
        ("behind", (-1.2, 0, 1), (0.1, 6, 6)), ("left", (0, 1.2, 1), (6, 0.1, 6)), ("above", (0, 0, 2.0), (6, 6, 0.1)),
    ):  # fmt: skip
        wall = mesh_node(name, box(name), place)
        wall.scale = scale
        many_robots_scene.roots.append(wall)
    page = scenes.show(many_robots_scene)
    page.keyboard.press("F7")
    place = page.evaluate("morse.stage.view.position.toArray()")
    # in the open quarter, under the roof
    assert place[0] > -1.2
    assert place[1] < 1.2
    assert place[2] < 2.0
    page.mouse.click(*on_page(page, page.evaluate("morse.world.value.find('robot0').frame.position.toArray()")))
    wait_until(lambda: page.evaluate("morse.components.selected.value") == "robot0")


def test_a_service_that_moves_the_camera_of_the_script_moves_that_of_the_page(running, open_page) -> None:
    driver, url = running
    page = open_page(url)
    driver.server.send(Viewpoint((1.0, 2.0, 3.0), (0.0, 0.0, 0.0), (0.1, 100.0)))
    wait_until(lambda: page.evaluate("morse.stage.view.position.toArray()") == [1.0, 2.0, 3.0])
    assert page.evaluate("morse.stage.view.ahead.z") == pytest.approx(-1.0, abs=1e-4)
    page.keyboard.down("r")
    wait_until(lambda: page.evaluate("morse.stage.view.position.z") > 3.2)
    page.keyboard.up("r")
    wait_until(lambda: page.evaluate("morse.navigation.velocity.length()") == 0)
    page.keyboard.press("F8")
    wait_until(lambda: page.evaluate("morse.stage.view.position.toArray()") == pytest.approx([1.0, 2.0, 3.0]))
    late = open_page(url)  # a later page has that viewpoint, too
    wait_until(lambda: late.evaluate("morse.stage.view.position.toArray()") == pytest.approx([1.0, 2.0, 3.0]))


def test_a_picture_that_stands_still_is_refined(served, open_page) -> None:
    server, url = served
    server.set_scene(Scene("s", roots=[mesh_node("crate", box("c"), (0, 0, 0))]), [])
    page = open_page(url, width=320, height=240)
    ratio = "morse.stage.renderer.getPixelRatio()"
    assert page.evaluate("morse.stage.quality.mayRefine") is False  # the address requests low quality
    usual = page.evaluate(ratio)
    # as on a quick machine, however long frames take here
    measure = "measure(began) { this.previous = began; }"
    page.evaluate(f"Object.assign(morse.stage.quality, {{ mayRefine: true, software: false, took: 16, {measure} }})")
    wait_until(lambda: page.evaluate(ratio) > 1.2 * usual)
    page.keyboard.down("w")
    wait_until(lambda: page.evaluate(ratio) == usual)
    page.keyboard.up("w")
    wait_until(lambda: page.evaluate(ratio) > 1.2 * usual)


# the inspector -------------------------------------------------------------------------------------------


def inspected(driver: Any, page: Page) -> None:
    """A robot with an actuator, and a scanner with a choice."""
    mode = PropertyDescription("ControlType", "string", "how", "Velocity", ["Velocity", "Position"])
    speed = PropertyDescription("Speed", "float", "how fast", 1.0, None, "m/s", 0.0, 5.0)
    window = PropertyDescription("scan_window", "float", "angle", 180.0)
    fields = [FieldDescription("v", "float", "speed ahead", "m/s"), FieldDescription("on", "bool", "whether")]
    scan = [FieldDescription("range_list", "list", "distances", "m")]
    driver.server.send(
        Tree([
            ComponentDescription("robot0", "robot", "robot0"),
            ComponentDescription("robot0.motion", "actuator", "robot0", data=fields, properties=[mode, speed]),
            ComponentDescription("robot0.scan", "sensor", "robot0", data=scan, properties=[window]),
        ])
    )  # fmt: skip
    wait_until(lambda: page.evaluate("morse.components.all.value.length") == 3)


def test_choices_are_offered_and_bounds_are_said(shown) -> None:
    driver, page = shown
    driver.measures = False
    inspected(driver, page)
    select(page, "robot0.motion")
    box_of_choices = page.get_by_role("combobox", name="ControlType")
    assert box_of_choices.locator("option").all_inner_texts() == ["Velocity", "Position"]
    box_of_choices.select_option("Position")
    wait_until(
        lambda: [(e.name, e.value) for e in driver.events if hasattr(e, "value")] == [("ControlType", "Position")]
    )
    assert "at least 0, at most 5" in page.get_by_role("textbox", name="Speed").get_attribute("title")


def test_data_of_actuators_are_set_and_those_of_sensors_are_not(shown) -> None:
    driver, page = shown
    driver.measures = False
    inspected(driver, page)
    select(page, "robot0.motion")
    driver.server.send(Values("robot0.motion", 1.0, {"v": 0.0, "on": False}))
    field = page.get_by_role("textbox", name="v", exact=True)
    field.fill("0.75")
    field.press("Enter")
    wait_until(lambda: [e.fields for e in events(driver, Command)] == [{"v": 0.75}])
    page.get_by_role("checkbox", name="on", exact=True).check()
    wait_until(lambda: [e.fields for e in events(driver, Command)][1:] == [{"on": True}])
    driver.server.send(Values("robot0.motion", 2.0, {"v": 0.5, "on": False}))
    page.get_by_role("checkbox", name="on", exact=True).focus()
    wait_until(lambda: field.input_value() == "0.5")
    select(page, "robot0.scan")
    driver.server.send(Values("robot0.scan", 3.0, {"range_list": [1.0, 2.0]}))
    assert page.locator("table.data input").count() == 0


def test_a_scan_is_drawn_from_above(shown) -> None:
    driver, page = shown
    driver.measures = False
    inspected(driver, page)
    select(page, "robot0.scan")
    # an obstacle 4 m ahead and 2 m to the left, nothing elsewhere
    ranges = [None] * 181
    ranges[90], ranges[180] = 4.0, 2.0
    driver.server.send(Values("robot0.scan", 1.0, {"range_list": ranges}))
    wait_until(lambda: "181 rays; a ring is 1 m" in page.locator(".scan figcaption").inner_text())
    pixel = """([x, y]) => [...document.querySelector('.scan canvas').getContext('2d')
        .getImageData(220 + 2 * x, 220 + 2 * y, 1, 1).data]""".strip()
    scale = (110 - 8) / 4.0
    ahead, left, right = (page.evaluate(pixel, p) for p in ([0, -4 * scale], [-2 * scale, 0], [2 * scale, 0]))
    accent = page.evaluate("getComputedStyle(document.documentElement).getPropertyValue('--accent')").strip()
    rgb = [int(accent[i : i + 2], 16) for i in (1, 3, 5)]
    assert ahead[:3] == pytest.approx(rgb, abs=3)
    assert left[:3] == pytest.approx(rgb, abs=3)
    assert right[:3] != pytest.approx(rgb, abs=30)


def test_icons_of_the_inspector_have_captions(shown) -> None:
    _, page = shown
    select(page, "robot0")
    captions = page.locator(".object .tools .caption")
    assert captions.all_inner_texts() == ["focus", "follow", "move", "duplicate", "delete", "copy"]


# going back ----------------------------------------------------------------------------------------------


def test_a_slider_goes_back_in_time_while_time_stands_still(shown) -> None:
    driver, page = shown
    driver.time = 2.0  # the slider moves if it is not at the beginning
    driver.server.send(History([0.5, 1.0, 1.5, 2.0]))
    slider = page.get_by_role("slider", name="go back in time")
    assert not slider.is_visible()
    page.keyboard.press("p")
    wait_until(lambda: slider.is_visible())
    slider.focus()
    page.keyboard.press("Home")
    wait_until(lambda: [e.time for e in events(driver, Rewind)][-1:] == [0.5])
    page.get_by_role("button", name="Back", exact=True).click()
    wait_until(lambda: len(events(driver, StepBack)) == 1)
    page.get_by_role("button", name="Play").click()
    wait_until(lambda: not slider.is_visible())
    driver.server.send(History([]))


# by touch ------------------------------------------------------------------------------------------------


def test_a_thumb_drives_and_lets_go(running, open_page) -> None:
    driver, url = running
    driver.server.send(Listening(["robot0"], "robot0"))
    page = open_page(url, width=390, height=780, has_touch=True, is_mobile=True)
    pad = page.get_by_role("group", name="drive")
    wait_until(lambda: pad.is_visible())
    place = pad.bounding_box()
    x, y = place["x"] + place["width"] / 2, place["y"] + place["height"] / 2
    session = page.context.new_cdp_session(page)

    def touch(kind: str, *points: tuple[float, float]) -> None:
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [{"x": a, "y": b} for a, b in points]})

    touch("touchStart", (x, y))
    touch("touchMove", (x, y - 50))
    wait_until(lambda: driver.keys[-1:] == [frozenset({"ArrowUp"})])
    # the hand that drives cannot move the camera
    assert page.evaluate("[morse.follow.mode.value, morse.follow.node.name]") == ["along", "robot0"]
    touch("touchMove", (x - 45, y - 45))
    wait_until(lambda: driver.keys[-1:] == [frozenset({"ArrowUp", "ArrowLeft"})])
    touch("touchEnd")
    wait_until(lambda: driver.keys[-1:] == [frozenset()])
    assert events(driver, DragEnd) == []


def test_a_telephone_reaches_every_panel_with_targets_for_fingers(running, open_page) -> None:
    _, url = running
    page = open_page(url, width=390, height=780, has_touch=True, is_mobile=True)
    select(page, "robot0.lidar")
    small = """() => [...document.querySelectorAll('button, select, summary, [role=treeitem], input')]
        .filter(e => e.checkVisibility() && e.type !== 'checkbox').map(e => [e, e.getBoundingClientRect()])
        .filter(([, r]) => r.width > 0 && (r.height < 43.5 || r.width < 43.5))
        .map(([e, r]) => `${e.tagName} ${e.ariaLabel ?? e.textContent} ${r.width}x${r.height}`)"""
    assert page.evaluate(small) == []
    # tapping a component opens its panel, and closes the tree
    page.get_by_role("button", name="Robots and components").tap()
    page.locator('[data-name="robot1.lidar"]').tap()
    wait_until(lambda: page.locator(".right").is_visible() and page.locator(".left").is_hidden())
    page.get_by_role("heading", name="robot1.lidar").wait_for()
    page.get_by_role("button", name="Details").tap()
    for name, panel in (("Robots and components", ".left"), ("Details", ".right"), ("Plots and messages", ".bottom")):
        page.get_by_role("button", name=name).tap()
        wait_until(lambda p=panel: page.locator(p).is_visible())
        assert page.evaluate(small) == [], name
        place = page.locator(panel).bounding_box()
        assert place["x"] >= 0
        assert place["x"] + place["width"] <= 390.5
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    plots, log = (page.locator(part).bounding_box() for part in (".plots", ".log"))
    assert log["y"] >= plots["y"] + plots["height"] - 1  # below each other
    assert min(plots["width"], log["width"]) >= 380
