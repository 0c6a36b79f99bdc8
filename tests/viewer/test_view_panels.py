"""The page in a real browser: components, plots, overlays, the viewpoint."""

from __future__ import annotations

import csv
import itertools
import math
import re
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image
from view_pages import toasts
from view_worlds import box, mesh_node

from morse.scene import CollisionShape, Scene, ShapeKind
from morse.viewer.page_messages import Activate, CallService, SetProperty, ToggleCapturing
from morse.viewer.view_messages import Capturing, Cone, Log, MassCentre, PropertyValue, Task, TaskPoint
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.browser

WIDE = {"width": 1200, "height": 700}
SIZE = WIDE  # of the page that tests share


def select(page: Page, robot: str = "robot0", part: str = "lidar") -> None:
    page.locator(f'[data-name="{robot}.{part}"]').click()
    page.get_by_role("heading", name=f"{robot}.{part}").wait_for()


def events(driver: Any, kind: type) -> list[Any]:
    return [event for event in driver.events if isinstance(event, kind)]


def place_of(page: Page, name: str, above: float = 0.0) -> tuple[float, float]:
    x, y = page.evaluate(
        """([name, above]) => {
        const p = morse.world.value.find(name).frame.position.clone();
        p.setZ(p.z + above).project(morse.stage.view.camera);
        const b = morse.stage.element.getBoundingClientRect();
        return [b.left + (p.x + 1) / 2 * b.width, b.top + (1 - p.y) / 2 * b.height] }""",
        [name, above],
    )
    return x, y


# tree and inspector --------------------------------------------------------------------------------------


def test_the_tree_lists_robots_components_and_objects(shown) -> None:
    _, page = shown
    items = page.get_by_role("treeitem")
    assert [item.strip() for item in items.all_inner_texts()] == [
        "robot0",
        "lidar",
        "robot1",
        "lidar",
        "robot2",
        "lidar",
        "objects",
    ]
    page.get_by_label("find in the tree").fill("robot1")
    wait_until(lambda: [item.strip() for item in items.all_inner_texts()] == ["robot1", "lidar"])
    page.get_by_label("find in the tree").fill("crate7")
    wait_until(lambda: [item.strip() for item in items.all_inner_texts()] == ["objects", "crate7"])
    page.get_by_label("find in the tree").fill("nonsense")
    wait_until(lambda: page.get_by_text("Nothing of that name.").is_visible())


def test_the_tree_is_walked_by_keyboard(shown) -> None:
    driver, page = shown
    page.get_by_role("tree").focus()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowDown")
    wait_until(lambda: page.evaluate("morse.components.selected.value") == "robot0.lidar")
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowLeft")
    wait_until(lambda: page.locator('[data-name="robot0.lidar"]').count() == 0)
    page.keyboard.press("ArrowRight")
    wait_until(lambda: page.locator('[data-name="robot0.lidar"]').count() == 1)
    assert not any(driver.keys)  # no key drove a robot


def test_values_are_shown_live_with_their_units(shown) -> None:
    driver, page = shown
    select(page)
    assert "Measures distances" in page.get_by_label("inspector").inner_text()
    wait_until(lambda: driver.server.wishes.values == {"robot0.lidar"})
    rows = page.locator("table.data tr")
    x = rows.filter(has=page.get_by_role("rowheader", name="x", exact=True)).last
    assert x.locator(".unit").inner_text() == "m"
    seen = set()
    wait_until(lambda: seen.add(x.locator(".value").inner_text()) or len(seen - {"–"}) > 3)
    assert all(abs(float(value)) <= 1.0 for value in seen - {"–"})
    texts = page.get_by_label("inspector").inner_text()
    assert "20 values" in texts
    assert "fine" in texts
    page.keyboard.press("Escape")
    wait_until(lambda: driver.server.wishes.values == frozenset())


def test_a_click_in_the_view_selects(shown) -> None:
    driver, page = shown
    driver.running, driver.time = False, 0.0
    wait_until(lambda: page.evaluate("morse.poses.value?.running === false"))
    wait_until(lambda: page.evaluate("morse.navigation.velocity.length()") == 0)
    page.mouse.click(*place_of(page, "crate3"))
    wait_until(lambda: page.evaluate("morse.components.selected.value") == "crate3")
    assert page.get_by_role("heading", name="crate3").is_visible()
    for robot in ("robot0", "robot1"):

        def hit(robot: str = robot) -> bool:
            page.mouse.click(*place_of(page, robot))  # the view shrinks when the right panel opens
            return str(page.evaluate("morse.components.selected.value")).startswith(robot)

        wait_until(hit)


def test_properties_are_edited_and_wrong_ones_refused(shown) -> None:
    driver, page = shown
    select(page)
    field = page.get_by_label("scan_window")
    field.fill("90.5")
    field.press("Enter")
    wait_until(
        lambda: (
            [(e.component, e.name, e.value) for e in events(driver, SetProperty)]
            == [("robot0.lidar", "scan_window", 90.5)]
        )
    )
    field.fill("wide")
    field.press("Enter")
    wait_until(lambda: page.get_by_role("alert").filter(has_text="given 'wide'").is_visible())
    wait_until(lambda: field.get_attribute("aria-invalid") == "true")
    field.fill("30")
    field.press("Enter")
    wait_until(lambda: field.get_attribute("aria-invalid") == "false")
    assert not any(driver.keys)  # typing does not drive


def test_what_is_true_or_not_is_ticked(shown) -> None:
    driver, page = shown
    select(page)
    box = page.get_by_role("checkbox", name="upside_down")
    assert not box.is_checked()
    box.focus()
    page.keyboard.press("Space")
    wait_until(lambda: [(e.name, e.value) for e in events(driver, SetProperty)] == [("upside_down", True)])
    driver.server.send(PropertyValue("robot0.lidar", "upside_down", False))
    wait_until(lambda: not box.is_checked())
    near = page.locator("table.data tr").filter(has=page.get_by_role("rowheader", name="near", exact=True))
    wait_until(lambda: near.locator(".value").inner_text() == "none")


def test_services_are_called_with_arguments_and_their_results_shown(shown) -> None:
    driver, page = shown
    select(page)
    add = page.get_by_role("form", name="add", exact=True)
    add.get_by_label("a", exact=True).fill("2")
    add.get_by_label("b", exact=True).fill("0.5")
    add.get_by_role("button", name="call").click()
    wait_until(lambda: add.locator(".result").inner_text() == "2.500")
    assert events(driver, CallService)[0].arguments == [2, 0.5]
    add.get_by_label("b", exact=True).fill("")
    add.get_by_role("button", name="call").click()
    wait_until(lambda: add.locator(".result").inner_text() == "2")  # an empty argument uses its default
    fail = page.get_by_role("form", name="fail", exact=True)
    fail.get_by_role("button", name="call").click()
    wait_until(lambda: "no power" in fail.locator(".result").inner_text())
    goto = page.get_by_role("form", name="goto", exact=True)
    goto.get_by_role("button", name="call").click()
    goto.get_by_role("button", name="stop").click()
    wait_until(lambda: goto.locator(".result").inner_text() == "PREEMPTED")
    page.get_by_label("active").uncheck()
    wait_until(lambda: [(e.component, e.active) for e in events(driver, Activate)] == [("robot0.lidar", False)])
    wait_until(lambda: "asleep" in (page.locator('[data-name="robot0.lidar"]').get_attribute("class") or ""))


# plots ---------------------------------------------------------------------------------------------------


def test_fields_are_dragged_into_plots_and_kept_as_files(shown, tmp_path) -> None:
    driver, page = shown
    select(page)
    page.get_by_role("button", name="Plots and messages").click()
    wait_until(lambda: page.evaluate("morse.components.valuesOf('robot0.lidar') !== null"))
    source = page.get_by_role("rowheader", name="x", exact=True)
    source.drag_to(page.get_by_label("plots", exact=True))
    wait_until(lambda: page.locator("figure.plot").count() == 1)
    page.get_by_role("rowheader", name="position", exact=True).last.drag_to(page.locator("figure.plot"))
    wait_until(lambda: page.locator(".legend li").count() == 4)
    select(page, "robot1")  # plotted values are still received
    wait_until(lambda: driver.server.wishes.values == {"robot0.lidar", "robot1.lidar"})
    wait_until(lambda: page.evaluate("morse.panels.plots.plots[0].times.length") > 40)
    page.get_by_role("button", name="Hold").click()
    with page.expect_download() as table:
        page.get_by_role("button", name="CSV").click()
    table.value.save_as(tmp_path / "plot.csv")
    rows = list(csv.DictReader((tmp_path / "plot.csv").open(encoding="utf-8")))
    assert list(rows[0]) == ["time (s)", "robot0.lidar.x (m)", *(f"robot0.lidar.position.{axis} (m)" for axis in "xyz")]
    for row in rows[1:]:
        assert float(row["robot0.lidar.x (m)"]) == pytest.approx(math.cos(float(row["time (s)"])))
    assert [float(row["time (s)"]) for row in rows] == sorted(float(row["time (s)"]) for row in rows)
    with page.expect_download() as picture:
        page.get_by_role("button", name="PNG").click()
    picture.value.save_as(tmp_path / "plot.png")
    assert Image.open(tmp_path / "plot.png").width > 100
    page.locator("figure.plot").get_by_role("button", name="Close").click()
    wait_until(lambda: driver.server.wishes.values == {"robot1.lidar"})


def test_a_field_without_a_value_is_plotted_as_soon_as_it_has_one(shown) -> None:
    driver, page = shown
    driver.measures = False
    select(page)
    for name in ("x", "note", "points"):
        page.get_by_role("rowheader", name=name, exact=True).last.press("Enter")
    assert page.locator(".legend li").all_inner_texts() == [
        f"robot0.lidar.{name} has no value yet…" for name in ("x", "note", "points")
    ]
    driver.measures = True
    wait_until(lambda: page.evaluate("morse.panels.plots.plots[0].times.length") > 3)
    # a field without numbers is removed, with a message
    wait_until(lambda: page.locator("figure.plot").count() == page.locator(".legend li").count() == 1)
    wait_until(lambda: len(toasts(page)) == 2)
    assert toasts(page) == [
        "robot0.lidar.note cannot be plotted: it is not a number.",
        "robot0.lidar.points cannot be plotted: 20 values.",
    ]
    page.get_by_role("rowheader", name="image", exact=True).last.press("Enter")  # its value stays null
    wait_until(lambda: page.locator("figure.plot").count() == 2)
    assert page.locator(".legend").last.inner_text() == "robot0.lidar.image has no value yet…"


def test_one_field_is_plotted_over_another_with_one_scale_for_one_unit(shown) -> None:
    _, page = shown
    page.evaluate("morse.panels.plots.plot('robot0.lidar', 'x')")
    wait_until(lambda: page.locator(".legend li").count() == 1)
    axis = page.get_by_label("horizontal axis")
    assert axis.is_hidden()  # there is nothing to choose
    page.evaluate("morse.panels.plots.plot('robot0.lidar', 'position', morse.panels.plots.plots[0])")
    wait_until(lambda: page.locator(".legend li").count() == 4)
    # the components of a vector are called as its axes
    names = ["robot0.lidar.x", *(f"robot0.lidar.position.{one}" for one in "xyz")]
    assert axis.locator("option").all_inner_texts() == ["over time", *(f"over {name}" for name in names)]
    inner, outer = axis.bounding_box(), page.locator("figure.plot .head").bounding_box()
    assert inner
    assert outer
    assert outer["y"] <= inner["y"] <= inner["y"] + inner["height"] <= outer["y"] + outer["height"]
    axis.select_option("robot0.lidar.position.0")  # the time, as a position
    chart = "morse.panels.plots.plots[0].chart"
    wait_until(lambda: page.evaluate(f"{chart}.data[1][0].length") > 40)
    xs, ys = page.evaluate(f"{chart}.data[1]")
    assert ys == pytest.approx(np.cos(xs))
    assert page.evaluate(f"{chart}.data.length") == 4  # the base is the axis, no curve
    scales = "(({ bbox, scales: { x, y } }) => [(x.max - x.min) / bbox.width, (y.max - y.min) / bbox.height])"

    def is_round() -> bool:
        across, up = page.evaluate(f"{scales}({chart})")
        return across == pytest.approx(up, rel=0.02)  # the chart rounds its size to pixels

    wait_until(is_round)
    # the choice is kept for a page that is loaded again
    assert page.evaluate("morse.session.recall('plots')[0].horizontal") == "robot0.lidar.position.0"
    page.evaluate("morse.panels.plots.plots[0].setOver('robot0.lidar.nothing')")  # as anybody may store
    assert page.evaluate("morse.panels.plots.plots[0].horizontal") == ""
    assert page.evaluate(f"{chart}.data.length") == 5


def test_points_of_a_plot_take_the_latest_value_of_the_other_field_and_end_with_a_restart(shown) -> None:
    _, page = shown
    # values of two components come at different times; some are missing or no numbers
    points = page.evaluate(
        """() => {
        const plot = morse.panels.plots.create();
        plot.add({ component: "a", path: "x", unit: "m" });
        plot.add({ component: "b", path: "y", unit: "rad" });
        plot.setOver("a.x");
        plot.take("b", 1.0, { y: 5 });
        plot.take("a", 1.1, { x: 1 });
        plot.take("b", 1.2, { y: 6 });
        plot.take("a", 1.3, { x: null });
        plot.take("b", 1.4, { y: "none" });
        plot.take("b", 1.5, { y: 7 });
        const all = JSON.stringify(plot.content()[1]);
        plot.take("b", 1.2, { y: 8 });
        plot.setWindow(5);
        plot.take("a", 9.0, { x: 2 });
        const late = JSON.stringify(plot.content()[1]);
        plot.draw();
        plot.onEmpty();
        return [all, late];
    }"""
    )
    assert points == ["[[1,1],[6,7]]", "[[],[]]"]


def test_an_error_opens_the_messages_at_it_unless_the_user_has_closed_them(shown) -> None:
    driver, page = shown
    places = itertools.count()

    def said(level: Any, text: str) -> None:
        driver.server.send(Log(level, text, place=next(places)))

    assert page.evaluate("morse.shell.bottom.hidden")
    said("warning", "a warning")
    wait_until(lambda: toasts(page) == ["a warning"])
    assert page.evaluate("morse.shell.bottom.hidden")
    said("error", "the first fault")
    for number in range(200):
        said("info", f"line {number}")
    wait_until(lambda: page.locator(".log p.info").count() >= 200)
    assert not page.evaluate("morse.shell.bottom.hidden")
    assert page.locator(".log .found").inner_text().endswith("the first fault")
    page.get_by_role("button", name="Plots and messages").click()  # the user closes them
    said("error", "the second fault")
    said("error", "the third fault")
    for number in range(200):
        said("info", f"later line {number}")
    wait_until(lambda: page.locator(".log p.info").count() >= 400)
    assert page.evaluate("morse.shell.bottom.hidden")
    assert page.evaluate("morse.shell.toggles.bottom.dataset.news") == "error"
    page.get_by_role("button", name="Plots and messages").click()
    # what is seen first is the first fault that was not read, not the end
    wait_until(lambda: page.locator(".log .found").inner_text().endswith("the second fault"))
    seen = """() => {
        const [line, box] = [".log .found", ".log"].map((e) => document.querySelector(e).getBoundingClientRect());
        return line.top >= box.top && line.bottom <= box.bottom;
    }"""
    wait_until(lambda: page.evaluate(seen))


def test_plots_take_the_colours_of_the_theme(shown) -> None:
    _, page = shown
    select(page)
    page.get_by_role("rowheader", name="x", exact=True).last.press("Enter")
    wait_until(lambda: page.evaluate("morse.panels.plots.plots[0]?.times.length > 3"))
    stroke = "morse.panels.plots.plots[0].chart.axes[1].grid.stroke()"
    line = "getComputedStyle(document.documentElement).getPropertyValue('--line')"
    light = page.evaluate(stroke)
    assert light == page.evaluate(line)
    page.get_by_role("button", name="Light or dark").click()
    wait_until(lambda: page.evaluate(stroke) == page.evaluate(line) != light)
    newest = page.evaluate("morse.panels.plots.plots[0].times.at(-1)")
    wait_until(lambda: page.evaluate("morse.panels.plots.plots[0].times.at(-1)") > newest)
    assert page.evaluate("morse.panels.plots.plots[0].times[0]") < newest  # nothing was lost
    page.get_by_role("button", name="Light or dark").click()
    wait_until(lambda: page.evaluate(stroke) == light)


# overlays of sensors -------------------------------------------------------------------------------------


def layer(page: Page, name: str) -> None:
    page.evaluate("name => morse.panels.layers.switch(name, true)", name)


def test_rays_are_asked_for_and_drawn_where_they_are(shown) -> None:
    driver, page = shown
    assert driver.server.wishes.overlays == frozenset()
    page.locator("summary[title=view]").click()
    page.get_by_label("rays and points").check()
    wait_until(lambda: driver.server.wishes.overlays == {"robot0.lidar", "robot1.lidar", "robot2.lidar"})
    rays = "morse.panels.layers.list.find(l => l.id === 'rays').drawn.get('robot1.lidar')"
    wait_until(lambda: page.evaluate(f"!!{rays}"))
    ends = np.array(page.evaluate(f"[...{rays}.beams.geometry.attributes.position.array]")).reshape(61, 2, 3)
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    # every second ray has a hit
    assert lengths[1::2] == pytest.approx(3.0 + np.sin(np.arange(61) * 0.7)[1::2], abs=1e-3)
    assert lengths[::2].max() <= 5.0
    assert np.hypot(ends[0, 0, 0], ends[0, 0, 1]) == pytest.approx(3.0, abs=1e-3)
    assert page.evaluate(f"{rays}.hits.geometry.attributes.position.count") == 30
    page.get_by_label("rays and points").uncheck()
    wait_until(lambda: driver.server.wishes.overlays == frozenset())
    wait_until(lambda: page.evaluate("morse.panels.layers.list.find(l => l.id === 'rays').root.children.length") == 0)


def test_contacts_cones_frames_names_trails_and_masses(running, open_page) -> None:
    driver, url = running
    driver.server.send(Cone("robot1.lidar", 3.0, 1.2, ["ball"]))
    driver.server.send(MassCentre("robot0", 10.0, (0.0, 0.0, 1.0)))
    page = open_page(url, **WIDE)
    for name in ("contacts", "cones", "frames", "names", "trails", "masses"):
        layer(page, name)
    wait_until(lambda: "contacts" in driver.server.wishes.overlays)
    part = "morse.panels.layers.list.find(l => l.id === '{}').root.children".format
    wait_until(lambda: page.evaluate(part("contacts") + "[0].geometry.attributes.position.count") == 1)
    wait_until(lambda: page.evaluate(part("cones") + "[0]?.name") == "robot1.lidar")
    wait_until(lambda: page.evaluate(part("frames") + ".length") == 6)
    wait_until(lambda: page.locator(".names span").all_inner_texts() == ["robot0", "robot1", "robot2"])
    wait_until(lambda: page.evaluate(part("trails") + "[0].geometry.drawRange.count") > 5)
    # in one question: the trail grows meanwhile
    drawn = "(({ drawRange, attributes }) => [...attributes.position.array.slice(0, 3 * drawRange.count)])"
    dots = page.evaluate(f"{drawn}({part('trails')}[0].geometry)")
    trail = np.array(dots).reshape(-1, 3)[:, :2]
    # it drives in a circle: trail points are exact, and the trail is straight between two frames
    radius = np.hypot(*trail.T)
    assert radius.max() < 2.001
    assert np.count_nonzero(radius > 1.999) >= 2
    assert np.linalg.norm(np.diff(trail, axis=0), axis=1).max() < 0.07
    wait_until(lambda: page.evaluate(part("masses") + "[0].position.z") == pytest.approx(1.25))
    page.reload()
    wait_until(lambda: page.evaluate("!!window.morse?.world.value"))
    wait_until(lambda: page.evaluate(part("frames") + ".length") == 6)  # restored


def test_collision_shapes_are_shown_when_the_script_says_so(scenes) -> None:
    quarter = (0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    shapes = [
        CollisionShape(ShapeKind.BOX, (1.0, 0.5, 0.25), (0.0, 0.0, 1.0), quarter),
        CollisionShape(ShapeKind.SPHERE, (0.5,)),
        CollisionShape(ShapeKind.CYLINDER, (0.5, 1.0)),
        CollisionShape(ShapeKind.CAPSULE, (0.5, 1.0)),
        CollisionShape(ShapeKind.ELLIPSOID, (0.5, 1.0, 2.0)),
        CollisionShape(ShapeKind.CONVEX, (), vertices=corners),
    ]
    scene = Scene("s", roots=[mesh_node("box", box("b"), (5, 0, 0), shapes=shapes)])
    scene.settings.view.show_physics = True
    page = scenes.show(scene)
    wait_until(lambda: page.evaluate("morse.panels.layers.list.find(l => l.id === 'shapes').root.children.length") == 6)
    measure = """morse.panels.layers.list.find(l => l.id === 'shapes').root.children.map(c => {
        c.updateWorldMatrix(true, false);
        c.geometry.computeBoundingBox(); const b = c.geometry.boundingBox.clone().applyMatrix4(c.matrixWorld);
        return [...b.min.toArray(), ...b.max.toArray()] })"""
    # their positions are set when they are first drawn
    wait_until(lambda: page.evaluate(measure)[0] == pytest.approx([4.5, -1, 0.75, 5.5, 1, 1.25]))
    sizes = page.evaluate(measure)
    assert sizes[1] == pytest.approx([4.5, -0.5, -0.5, 5.5, 0.5, 0.5], abs=0.01)
    assert sizes[2] == pytest.approx([4.5, -0.5, -1, 5.5, 0.5, 1], abs=0.01)
    assert sizes[3] == pytest.approx([4.5, -0.5, -1.5, 5.5, 0.5, 1.5], abs=0.01)
    assert sizes[4] == pytest.approx([4.5, -1, -2, 5.5, 1, 2], abs=0.01)
    assert sizes[5] == pytest.approx([5, 0, 0, 6, 1, 1], abs=0.01)


# plan and ruler -------------------------------------------------------------------------------------------


def measured(page: Page) -> list[float]:
    """Distance, its parts along x, y and z, heading and rise, as the page says."""
    text = page.locator(".ruler").inner_text().partition(":")[2]
    return [float(number) for number in re.findall(r"-?\d+\.\d+", text)]


def click(page: Page, name: str) -> None:
    """Click the middle of the upper side of a box."""
    x, y = place_of(page, name, 0.5)
    page.mouse.click(x, y)


def test_a_plan_looks_straight_down_and_a_ruler_measures_in_it(scenes) -> None:
    places = {"a": (0.0, 0.0, 0.5), "b": (3.0, 4.0, 0.5), "high": (0.0, -4.0, 2.5)}
    scene = Scene("s", roots=[mesh_node(name, box(name), place) for name, place in places.items()])
    scene.settings.view.camera_location = (-20.0, 0.0, 1.0)
    page = scenes.show(scene)
    page.keyboard.press("5")
    wait_until(lambda: page.evaluate("morse.stage.view.pitch") == pytest.approx(-math.pi / 2))
    page.evaluate("morse.stage.draw()")
    ax, ay = place_of(page, "a")
    bx, by = place_of(page, "b")
    assert bx > ax
    assert by < ay  # +X is to the right, +Y up
    assert (ay - by) / (bx - ax) == pytest.approx(4 / 3, rel=0.02)
    page.keyboard.press("b")
    click(page, "a")
    wait_until(lambda: "From a" in page.locator(".ruler").inner_text())
    click(page, "b")
    wait_until(lambda: len(measured(page)) == 6)
    # the tops of the boxes: a triangle of 3, 4 and 5 m
    degrees = math.degrees(math.atan2(4, 3))
    assert measured(page) == pytest.approx([5.0, 3.0, 4.0, 0.0, degrees, 0.0], abs=0.1)
    assert page.evaluate("morse.components.selected.value") is None  # the clicks measure, they do not select
    click(page, "a")  # begins again
    click(page, "high")
    wait_until(lambda: "a → high" in page.locator(".ruler").inner_text() and len(measured(page)) == 6)
    # the higher box is nearer to the camera: only its own place is measured, not that of its picture
    assert measured(page) == pytest.approx(
        [math.sqrt(20), 0.0, -4.0, 2.0, -90.0, math.degrees(math.atan2(2, 4))], abs=0.15
    )
    page.mouse.click(bx, 2 * ay - by)  # where no box is
    wait_until(lambda: "There is nothing" in page.locator(".ruler").inner_text())
    page.keyboard.press("Escape")
    wait_until(lambda: page.locator(".ruler").is_hidden())
    click(page, "b")
    wait_until(lambda: page.evaluate("morse.components.selected.value") == "b")


def test_a_ruler_follows_objects_and_forgets_those_that_are_gone(scenes) -> None:
    roots = [mesh_node("a", box("a"), (0, 0, 0)), mesh_node("b", box("b"), (4, 0, 0))]
    page = scenes.show(Scene("s", roots=roots))
    page.evaluate("(morse.follow.plan(), morse.panels.ruler.on.set(true), morse.stage.draw())")
    click(page, "a")
    click(page, "b")
    wait_until(lambda: len(measured(page)) == 6)
    page.evaluate(
        """() => { const { frame } = morse.world.value.find("b");
        frame.position.x += 2; frame.updateMatrix(); frame.updateMatrixWorld(true); morse.stage.draw(); }"""
    )
    assert measured(page)[0] == pytest.approx(6.0, abs=0.1)
    page = scenes.show(Scene("t", roots=[mesh_node("a", box("a"), (0, 0, 0))]))
    wait_until(lambda: page.locator(".ruler").inner_text().startswith("Ruler: click two points"))
    assert page.evaluate("morse.panels.ruler.line.visible || morse.panels.ruler.dots.visible") is False


def test_what_a_camera_sees(shown) -> None:
    driver, page = shown
    select(page)
    wait_until(lambda: driver.server.wishes.images == {"robot0.lidar"})
    page.keyboard.press("v")
    wait_until(lambda: driver.server.wishes.images == frozenset())
    page.keyboard.press("v")
    wait_until(lambda: driver.server.wishes.images == {"robot0.lidar"})
    pixel = "[...document.querySelector('.image canvas').getContext('2d').getImageData({}, {}, 1, 1).data]".format
    wait_until(lambda: page.evaluate(pixel(63, 47))[:2] == [252, 235])
    assert page.evaluate(pixel(0, 0))[:2] == [0, 0]
    assert page.evaluate(pixel(10, 20))[:2] == [40, 100]
    driver.server.send(Capturing(False))
    wait_until(lambda: "stopped" in (page.locator(".images").get_attribute("class") or ""))
    page.keyboard.press("Space")
    wait_until(lambda: len(events(driver, ToggleCapturing)) == 1)
    page.get_by_role("button", name="Let the cameras take pictures").click()
    wait_until(lambda: len(events(driver, ToggleCapturing)) == 2)
    driver.server.send(Capturing(True))
    wait_until(lambda: page.get_by_role("button", name="Stop the cameras").is_visible())
    page.keyboard.press("v")
    wait_until(lambda: driver.server.wishes.images == frozenset())


# the viewpoint -------------------------------------------------------------------------------------------


def test_following_a_robot(shown) -> None:
    driver, page = shown
    page.locator('[data-name="robot1"]').click()
    apart = "morse.stage.view.position.distanceTo(morse.world.value.find('robot1').frame.position)"
    ahead = """(() => { const n = morse.world.value.find('robot1').frame; const v = n.position.clone().set(1, 0, 0);
        return v.transformDirection(n.matrixWorld).dot(morse.stage.view.ahead) })()"""
    page.keyboard.press("1")
    wait_until(lambda: page.evaluate("morse.follow.mode.value") == "third")
    wait_until(lambda: page.evaluate(apart) < 7 and page.evaluate(ahead) > 0.7)
    page.keyboard.press("2")
    wait_until(lambda: page.evaluate(apart) < 1.5 and page.evaluate(ahead) > 0.98)
    page.keyboard.press("3")
    wait_until(lambda: page.evaluate("morse.stage.view.pitch") < -1.4)
    page.keyboard.down("w")
    wait_until(lambda: page.evaluate("morse.follow.mode.value") == "free")
    page.keyboard.up("w")
    driver.running = False  # the camera does not follow a robot that drives on
    wait_until(lambda: page.evaluate("morse.poses.value.running === false"))
    page.locator("summary[title=view]").click()
    page.get_by_role("button", name="side").click()
    # the camera flies there
    wait_until(lambda: page.evaluate(apart) < 12 and abs(page.evaluate(ahead)) < 0.4)


def test_the_camera_is_remembered_and_forgotten(running, open_page) -> None:
    _, url = running
    page = open_page(url, **WIDE)
    page.keyboard.down("r")
    wait_until(lambda: page.evaluate("morse.stage.view.position.z") > 9)
    page.keyboard.up("r")
    wait_until(lambda: page.evaluate("morse.navigation.velocity.length()") == 0)
    height = page.evaluate("morse.stage.view.position.z")
    page.reload()
    wait_until(lambda: page.evaluate("!!window.morse?.world.value"))
    wait_until(lambda: page.evaluate("morse.stage.view.position.z") == pytest.approx(height))
    page.keyboard.press("F8")
    wait_until(lambda: page.evaluate("morse.stage.view.position.z") == pytest.approx(8.0))
    page.reload()
    wait_until(lambda: page.evaluate("!!window.morse?.world.value"))
    assert page.evaluate("morse.stage.view.position.z") == pytest.approx(8.0)


def test_a_task_is_shown_with_what_has_been_checked(shown) -> None:
    driver, page = shown
    points = [TaskPoint("It stops.", True), TaskPoint("<img src=x onerror=alert(1)>", False, "Turn earlier.")]
    text = "Write `step`.\n\n* Look at <b>one</b> row.\n* Turn left."
    driver.server.send(Task("Follow a line", text, points, True))
    task = page.locator(".task")
    task.get_by_text("1 of 2").wait_for()
    assert task.locator("code").all_inner_texts() == ["step"]
    assert task.locator(".text li").all_inner_texts() == ["Look at <b>one</b> row.", "Turn left."]
    assert task.locator(".points li").nth(1).inner_text().split("\n")[1:] == [
        "<img src=x onerror=alert(1)>",
        "Turn earlier.",
    ]
    assert task.locator("img, b b").count() == 0
    driver.server.send(Task("Follow a line", text, [TaskPoint("It stops.", True)], True))
    task.get_by_text("passed").wait_for()
    page.evaluate("document.querySelector('.task').replaceChildren(); document.querySelector('.task').hidden = true")


def test_lines_at_every_metre_are_drawn_if_somebody_wants_them(shown) -> None:
    _, page = shown
    drawn = "(morse.stage.invalidate(), morse.stage.ground.mesh.material.visible)"
    wait_until(lambda: page.evaluate(drawn) is False, "no lines")
    page.locator("summary[title=view]").click()
    page.get_by_label("grid").check()
    wait_until(lambda: page.evaluate(drawn) is True, "lines")
    page.get_by_label("grid").uncheck()
    wait_until(lambda: page.evaluate(drawn) is False, "no lines")
