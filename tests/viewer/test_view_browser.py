"""The page in a real browser: world, camera, keys, time."""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image as Picture
from view_worlds import box, mesh_node, playground

from morse.scene import Material, Scene
from morse.viewer.page_messages import Reset
from morse.viewer.view_messages import Appearance, Listening, Pace
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.browser


def colors(page: Page) -> np.ndarray:
    """(H, W, 3) pixels of the canvas."""
    shot = page.locator("main > canvas").screenshot(timeout=60_000)
    return np.asarray(Picture.open(io.BytesIO(shot)).convert("RGB")).astype(int)


def reds(page: Page) -> np.ndarray:
    """Mask of the pixels that are clearly red."""
    shown = colors(page)
    return (shown[..., 0] > 90) & (shown[..., 0] > 2 * shown[..., 1]) & (shown[..., 0] > 2 * shown[..., 2])


def project(point: tuple[float, float, float], camera: tuple[float, float, float], turn: tuple[float, float, float],
            size: tuple[int, int], focal: float) -> tuple[float, float]:  # fmt: skip
    """Pixel of a point, by the pinhole model: a sensor 32 mm wide, the camera looks along -Z, Y is up."""
    (cx, sx), (cy, sy), (cz, sz) = ((math.cos(a), math.sin(a)) for a in turn)
    rotation = (
        np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
        @ np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
        @ np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    )
    x, y, z = rotation.T @ (np.array(point) - np.array(camera))
    pixels = focal / 32.0 * max(size)
    return size[0] / 2 + pixels * x / -z, size[1] / 2 - pixels * y / -z


@pytest.mark.parametrize(
    ("place", "camera", "turn", "focal"),
    [
        ((0.0, 0.0, 0.5), (5.0, -5.0, 5.0), (0.7854, 0.0, 0.7854), 20.0),
        ((1.0, 2.0, 0.5), (-18.0, -6.7, 10.8), (1.09, 0.0, -1.14), 35.0),
        ((-1.0, 0.5, 0.5), (0.0, 0.0, 12.0), (0.0, 0.0, 0.6), 20.0),
        ((2.0, 1.0, 0.5), (8.0, 0.0, 2.0), (1.3, 0.2, 1.6), 30.0),
    ],
)
def test_a_red_box_is_where_the_camera_of_the_script_sees_it(scenes, place, camera, turn, focal) -> None:
    red = Material("red", (1.0, 0.0, 0.0, 1.0), shadeless=True)
    scene = Scene("s", roots=[mesh_node("box", box("b", red), place)])
    view = scene.settings.view
    view.camera_location, view.camera_rotation, view.camera_focal_length = camera, turn, focal
    page = scenes.show(scene)
    page.evaluate("morse.stage.ground.mesh.visible = false; morse.stage.invalidate()")  # its X axis is red, too
    wait_until(lambda: reds(page).any(), "something red")
    mask = reds(page)
    page.evaluate("morse.stage.ground.mesh.visible = true")
    height, width = mask.shape
    rows, columns = np.nonzero(mask)
    corners = [np.add(place, (dx, dy, dz)) for dx in (-0.5, 0.5) for dy in (-0.5, 0.5) for dz in (-0.5, 0.5)]
    seen = [project(tuple(c), camera, turn, (width, height), focal) for c in corners]
    (left, top), (right, bottom) = np.min(seen, axis=0), np.max(seen, axis=0)
    # low quality renders at 0.6 of the pixels
    assert (columns.min(), columns.max()) == (pytest.approx(left, abs=3), pytest.approx(right, abs=3))
    assert (rows.min(), rows.max()) == (pytest.approx(top, abs=3), pytest.approx(bottom, abs=3))


def test_hidden_things_are_not_seen_until_they_are_shown(served, open_page) -> None:
    server, url = served
    red = Material("red", (1.0, 0.0, 0.0, 1.0), shadeless=True)
    scene = Scene(
        "s", roots=[mesh_node("box", box("b", red), properties={"visible": 0}), mesh_node("c", box("c"), (0, 3, 0))]
    )
    server.set_scene(scene, [])
    page = open_page(url)
    assert not reds(page).any()
    server.send(Appearance("box", visible=True))
    wait_until(lambda: reds(page).any())
    server.send(Appearance("box", visible=True, color=(0.0, 1.0, 0.0, 1.0)))
    wait_until(lambda: not reds(page).any())
    shown = colors(page)
    assert ((shown[..., 1] > 90) & (shown[..., 1] > 2 * shown[..., 0])).any()


def test_many_alike_are_drawn_in_one_go_and_each_where_it_is(served, open_page) -> None:
    server, url = served
    red = Material("red", (1.0, 0.0, 0.0, 1.0), shadeless=True)
    mesh = box("b", red, size=0.4)
    nodes = [mesh_node(f"n{i}", mesh, (i * 1.0 - 2.0, 0.0, 0.0)) for i in range(5)]
    scene = Scene("s", roots=nodes)
    scene.settings.view.camera_location = (0.0, 0.0, 8.0)
    scene.settings.view.camera_rotation = (0.0, 0.0, 0.0)
    server.set_scene(scene, [])
    page = open_page(url)
    wait_until(lambda: reds(page).any(), "something red")
    columns = reds(page).any(axis=0)
    assert np.count_nonzero(np.diff(columns.astype(int)) == 1) == 5
    before = page.evaluate("morse.stage.renderer.info.render.calls")
    server.send(Appearance("n2", visible=False))
    wait_until(lambda: np.count_nonzero(np.diff(reds(page).any(axis=0).astype(int)) == 1) == 4)
    assert before < 8


def test_the_world_moves(shown) -> None:
    driver, page = shown
    seen = {tuple(page.evaluate("morse.world.value.find('robot0').frame.position.toArray()"))}
    wait_until(
        lambda: (
            seen.add(tuple(page.evaluate("morse.world.value.find('robot0').frame.position.toArray()"))) or len(seen) > 5
        )
    )
    for x, y, z in list(seen)[1:]:
        assert math.hypot(x, y) == pytest.approx(2.0, abs=1e-4)
        assert z == pytest.approx(0.25)
    x, y, z = page.evaluate(
        "morse.world.value.find('robot0.lidar').frame.getWorldPosition(morse.stage.target.clone()).toArray()"
    )
    assert z == pytest.approx(0.65)
    assert driver.server.watched


def test_time_is_shown_and_controlled(shown) -> None:
    driver, page = shown
    driver.server.send(Pace("Best Effort", 2.5, "most time goes to robot0.camera: 31.0 ms a tick"))
    said = "2.5 s behind; most time goes to robot0.camera: 31.0 ms a tick"
    wait_until(lambda: page.locator(".late").inner_text() == said)
    driver.server.send(Pace("Best Effort", 3.5))
    wait_until(lambda: page.locator(".late").inner_text() == "3.5 s behind")
    driver.server.send(Pace("Best Effort"))
    wait_until(lambda: not page.locator(".late").is_visible())
    page.get_by_role("button", name="Pause").click()
    wait_until(lambda: not driver.running)
    wait_until(lambda: page.locator(".factor").inner_text() == "paused")
    tick = driver.tick
    page.get_by_role("button", name="One tick").click()
    wait_until(lambda: driver.tick == tick + 1)
    page.keyboard.press(".")
    wait_until(lambda: driver.tick == tick + 2)
    minutes, seconds = page.locator(".time").inner_text().split(":")
    wait_until(
        lambda: float(page.locator(".time").inner_text().split(":")[1]) == pytest.approx(driver.time % 60, abs=0.006)
    )
    assert int(minutes) == 0
    assert float(seconds) > 0
    page.get_by_role("button", name="Reset").click()
    page.get_by_role("button", name="cancel").click()
    page.keyboard.press("F11")
    page.get_by_role("dialog").get_by_role("button", name="reset").click()
    wait_until(lambda: driver.time == 0.0)
    assert len([event for event in driver.events if isinstance(event, Reset)]) == 1
    page.get_by_role("button", name="Play").click()
    wait_until(lambda: driver.running)
    speed = page.get_by_label("speed")
    speed.select_option("×5")
    wait_until(lambda: driver.speed == 5.0)
    # the page has to learn that another speed holds, also if it was never shown the one that it has requested
    wait_until(lambda: page.evaluate("morse.poses.value.speed") == 5.0)
    driver.shown = False
    speed.select_option("×10")
    wait_until(lambda: driver.speed == 10.0)
    driver.speed, driver.shown = 5.0, True
    wait_until(lambda: speed.input_value() == "5")
    speed.select_option("max")
    wait_until(lambda: driver.speed == math.inf)
    wait_until(
        lambda: page.locator(".factor").inner_text() != "paused"
    )  # the key does the opposite of what the page knows
    page.keyboard.press("p")
    wait_until(lambda: not driver.running)


def test_a_page_that_is_paused_rests(shown, monkeypatch) -> None:
    driver, page = shown
    published = []
    publish = driver.server.publish
    monkeypatch.setattr(driver.server, "publish", lambda snapshot: (published.append(snapshot), publish(snapshot)))
    driver.running = False
    wait_until(lambda: page.locator(".factor").inner_text() == "paused")
    page.evaluate(
        """() => {
            const { onPoses } = morse.connection;
            window.seen = 0;
            morse.connection.onPoses = (frame) => { seen += 1; onPoses(frame); };
        }"""
    )
    begin = len(published)
    wait_until(lambda: len(published) > begin + 40)
    tick, driver.steps = driver.tick, 1
    wait_until(lambda: page.evaluate("morse.poses.value.tick") == tick + 1)
    assert 1 <= page.evaluate("seen") <= 3
    # what is refused is told, although no new poses come
    speed = page.get_by_label("speed")
    before = speed.input_value()
    driver.shown = False
    speed.select_option("×0.2")
    wait_until(lambda: driver.speed == 0.2)
    driver.speed, driver.shown = float(before), True
    wait_until(lambda: speed.input_value() == before)


def test_keys_drive_with_chords_and_release(shown) -> None:
    driver, page = shown
    page.keyboard.down("ArrowUp")
    wait_until(lambda: driver.keys[-1] == {"ArrowUp"})
    wait_until(lambda: driver.x > 0.2)
    page.keyboard.down("ArrowLeft")
    wait_until(lambda: driver.keys[-1] == {"ArrowUp", "ArrowLeft"})
    page.keyboard.up("ArrowUp")
    wait_until(lambda: driver.keys[-1] == {"ArrowLeft"})
    page.keyboard.up("ArrowLeft")
    wait_until(lambda: driver.keys[-1] == frozenset())
    x = driver.x
    tick = driver.tick
    wait_until(lambda: driver.tick > tick + 10)
    assert driver.x == x


def test_a_held_key_stays_held_while_the_page_draws_slowly(shown) -> None:
    driver, page = shown
    page.set_viewport_size({"width": 1200, "height": 800})
    page.keyboard.down("ArrowUp")
    wait_until(lambda: driver.keys[-1] == {"ArrowUp"})
    count, tick = len(driver.keys), driver.tick

    def held_for_long() -> bool:
        # a machine that lets the page wait releases the key, too: then the time begins anew
        nonlocal count, tick
        if len(driver.keys) != count or driver.keys[-1] != {"ArrowUp"}:
            count, tick = len(driver.keys), driver.tick
        return driver.tick > tick + 150

    wait_until(held_for_long)
    page.keyboard.up("ArrowUp")


def test_keys_are_let_go_when_the_page_loses_the_focus_or_is_closed(running, open_page) -> None:
    driver, url = running
    page = open_page(url)
    page.keyboard.down("ArrowUp")
    wait_until(lambda: driver.keys[-1] == {"ArrowUp"})
    page.evaluate("dispatchEvent(new Event('blur'))")
    wait_until(lambda: driver.keys[-1] == frozenset())
    page.keyboard.up("ArrowUp")
    page.keyboard.down("ArrowDown")
    wait_until(lambda: driver.keys[-1] == {"ArrowDown"})
    page.close()
    wait_until(lambda: driver.keys[-1] == frozenset())


def test_a_page_that_hangs_lets_go(running, open_page) -> None:
    driver, url = running
    page = open_page(url)
    page.keyboard.down("ArrowUp")
    wait_until(lambda: driver.keys[-1] == {"ArrowUp"})
    # a script that stands still in a debugger, and one that never ends, are the same to all others
    debugger = page.context.new_cdp_session(page)
    debugger.send("Debugger.enable")
    stopped: list[object] = []
    debugger.on("Debugger.paused", lambda event: stopped.append(event))
    debugger.send("Debugger.pause")
    wait_until(lambda: page.wait_for_timeout(1) or stopped, "a script that stands still")
    wait_until(lambda: driver.keys[-1] == frozenset())
    assert driver.server.watched
    debugger.send("Debugger.resume")


def camera(page: Page) -> dict[str, Any]:
    return page.evaluate("morse.stage.view.pose")


def test_the_camera_flies_by_keys_and_looks_around_with_ctrl(shown) -> None:
    driver, page = shown
    start = camera(page)
    assert start["position"] == pytest.approx([10.0, -10.0, 8.0])
    assert start["yaw"] == pytest.approx(0.78 + math.pi / 2)
    assert start["pitch"] == pytest.approx(1.05 - math.pi / 2)
    ahead = np.array([math.cos(start["yaw"]) * math.cos(start["pitch"]),
                      math.sin(start["yaw"]) * math.cos(start["pitch"]), math.sin(start["pitch"])])  # fmt: skip
    for key, way in (("w", ahead), ("z", ahead), ("s", -ahead), ("r", [0, 0, 1]), ("f", [0, 0, -1])):
        before = np.array(camera(page)["position"])
        page.keyboard.down(key)
        wait_until(lambda: np.linalg.norm(np.array(camera(page)["position"]) - before) > 0.3)  # noqa: B023
        page.keyboard.up(key)
        moved = np.array(camera(page)["position"]) - before
        assert np.dot(moved, way) / np.linalg.norm(moved) > 0.9, key
        wait_until(lambda: page.evaluate("morse.navigation.velocity.length()") == 0)
    for left, right in (("a", "d"), ("q", "d")):
        before = np.array(camera(page)["position"])
        page.keyboard.down(left)
        wait_until(lambda: np.linalg.norm(np.array(camera(page)["position"]) - before) > 0.3)  # noqa: B023
        page.keyboard.up(left)
        side = np.array(camera(page)["position"]) - before
        assert np.dot(np.cross(ahead, [0, 0, 1]), side) < 0
        page.keyboard.down(right)
        wait_until(lambda: np.dot(np.array(camera(page)["position"]) - before, side) < 0)  # noqa: B023
        page.keyboard.up(right)
        wait_until(lambda: page.evaluate("morse.navigation.velocity.length()") == 0)
    before = camera(page)
    page.mouse.move(300, 250)
    page.keyboard.down("Control")
    page.mouse.move(400, 250, steps=4)
    page.keyboard.up("Control")
    wait_until(lambda: camera(page)["yaw"] < before["yaw"] - 0.1)
    assert camera(page)["position"] == before["position"]
    assert frozenset() in driver.keys
    page.keyboard.press("F8")
    wait_until(lambda: camera(page)["position"] == pytest.approx([10.0, -10.0, 8.0]))


def test_ctrl_keys_of_the_browser_do_not_drive(shown) -> None:
    driver, page = shown
    page.keyboard.press("Control+KeyK")
    page.keyboard.press("ArrowUp")
    wait_until(lambda: any("ArrowUp" in keys for keys in driver.keys))
    assert not any("KeyK" in keys for keys in driver.keys)


def test_f7_and_f9(shown) -> None:
    _, page = shown
    names = []
    for _ in range(4):
        page.keyboard.press("F7")
        x, y, _ = camera(page)["position"]
        place = page.evaluate(
            "morse.world.value.nodes.filter(n => n.description.kind === 'robot').map(n => n.frame.position.toArray())"
        )
        names.append(int(np.argmin([math.hypot(px - x, py - y) for px, py, _ in place])))
    assert set(names) == {0, 1, 2}
    page.keyboard.press("F9")
    wait_until(lambda: camera(page)["position"] == pytest.approx([0, 0, 6]))
    page.keyboard.press("F9")
    wait_until(lambda: camera(page)["position"] == pytest.approx([10.0, -10.0, 8.0]))


def test_orbit_keeps_what_is_under_the_pointer_and_zoom_comes_closer(shown) -> None:
    _, page = shown
    distance = "morse.stage.view.position.distanceTo(morse.navigation.pivot)"
    page.mouse.move(320, 250)
    page.mouse.down()
    page.mouse.move(330, 252)
    before = page.evaluate(distance)
    page.mouse.move(420, 280, steps=3)
    page.mouse.up()
    assert page.evaluate(distance) == pytest.approx(before, rel=1e-6)
    height = camera(page)["position"][2]
    page.mouse.wheel(0, -300)
    wait_until(lambda: camera(page)["position"][2] < height - 0.3)


def test_help_lists_the_keys(shown) -> None:
    _, page = shown
    page.keyboard.press("h")
    dialog = page.get_by_role("dialog", name="Keys")
    text = dialog.inner_text()
    for key in ("F7", "F8", "F9", "F11", "Ctrl", "Space", "↑"):
        assert key in text
    page.keyboard.press("Escape")
    wait_until(lambda: not dialog.is_visible())
    page.keyboard.press("?")
    wait_until(dialog.is_visible)


def test_arrow_keys_that_no_robot_obeys_are_answered(shown) -> None:
    driver, page = shown
    said = page.get_by_text("No robot obeys the arrow keys: add the actuator Keyboard to one.")
    driver.server.send(Listening(["robot0"], "robot0"))
    wait_until(lambda: page.get_by_label("the robot that obeys the keys").input_value() == "robot0")
    page.keyboard.press("ArrowUp")
    assert said.count() == 0
    driver.server.send(Listening([]))
    wait_until(lambda: not page.get_by_label("the robot that obeys the keys").is_visible())
    page.keyboard.press("ArrowUp")
    wait_until(said.is_visible)


def test_the_robot_that_listens(shown) -> None:
    driver, page = shown
    driver.server.send(Listening(["robot0", "robot1"], "robot1"))
    select = page.get_by_label("the robot that obeys the keys")
    wait_until(lambda: select.input_value() == "robot1")
    select.select_option("robot0")
    wait_until(lambda: any(getattr(event, "robot", "") == "robot0" for event in driver.events))
    driver.server.send(Listening([]))


def test_one_drives_and_hands_over(running, open_page) -> None:
    driver, url = running
    one, two = open_page(url), open_page(url)
    wait_until(lambda: two.get_by_role("button", name="ask to drive").is_visible())
    assert two.get_by_role("button", name="Pause").is_disabled()
    two.keyboard.down("ArrowUp")
    one.bring_to_front()
    two.get_by_role("button", name="ask to drive").click()
    wait_until(
        lambda: (
            one.get_by_text("would like to drive").is_visible()
            or one.get_by_role("button", name="ask to drive").is_visible()
        )
    )
    if one.get_by_text("would like to drive").is_visible():
        one.get_by_role("button", name="hand over").click()
    wait_until(lambda: two.get_by_text("you drive").is_visible())
    # a key that was pressed before does not drive
    two.keyboard.down("ArrowDown")
    wait_until(lambda: any("ArrowDown" in keys for keys in driver.keys))
    two.keyboard.up("ArrowDown")
    assert not any("ArrowUp" in keys for keys in driver.keys)
    two.get_by_role("button", name="Pause").click()
    wait_until(lambda: not driver.running)
    wait_until(lambda: one.get_by_role("button", name="Play").is_disabled())


def test_connection_lost_and_found(make_server, open_page) -> None:
    server, url = make_server()
    red = Material("red", (1.0, 0.0, 0.0, 1.0), shadeless=True)
    server.set_scene(Scene("s", roots=[mesh_node("box", box("b", red))]), [])
    page = open_page(url)
    server.send(Pace("Best Effort", 2.5))
    wait_until(lambda: page.locator(".late").is_visible())
    server.stop()
    wait_until(lambda: "simulation has ended" in page.locator(".link").inner_text())
    assert not page.locator(".late").is_visible()  # what has ended is not late
    again, other = make_server(port=int(url.rsplit(":", 1)[1].strip("/")))
    assert other == url
    again.set_scene(Scene("s", roots=[mesh_node("box", box("b", red)), mesh_node("new", box("n", red))]), [])
    wait_until(lambda: page.locator(".link").is_hidden())
    wait_until(lambda: page.evaluate("!!morse.world.value.find('new')"))


def test_wrong_token_is_said(make_server, open_page) -> None:
    server, url = make_server(token="secret")
    server.set_scene(Scene("s", roots=[mesh_node("box", box("b"))]), [])
    page = open_page(url.replace("secret", "wrong"), wait=False)
    assert "requires the token" in page.inner_text("body")
    page = open_page(url)
    assert "token" not in page.url


def test_an_old_page_is_told_to_reload(served, open_page, monkeypatch) -> None:
    _, url = served
    monkeypatch.setattr("morse.viewer.hub.VERSION", 99)
    page = open_page(url, wait=False)
    wait_until(lambda: "the simulator 99: reload the page" in page.locator(".link").inner_text())
    reload = page.locator(".link").get_by_role("button", name="reload").element_handle()
    assert reload is not None
    for _ in range(10):  # in a second, the page asks at least once more
        page.wait_for_timeout(100)
        assert reload.is_visible()


def test_a_world_that_changes_keeps_the_point_of_view_and_the_selection(running, open_page) -> None:
    driver, url = running
    page = open_page(url, width=1000)
    page.locator('[data-name="robot1"]').click()
    page.keyboard.press("1")
    wait_until(lambda: page.evaluate("morse.follow.mode.value") == "third")
    scene, moving = playground()
    scene.roots.append(mesh_node("parcel", box("parcel"), (1, 2, 3)))
    scene.roots.remove(scene.find("ball"))  # type: ignore[arg-type]
    driver.server.set_scene(scene, moving)
    wait_until(lambda: page.evaluate("!!morse.world.value.find('parcel') && !morse.world.value.find('ball')"))
    assert page.evaluate("morse.follow.mode.value") == "third"
    assert page.evaluate("morse.components.selected.value") == "robot1"
    revision = page.evaluate("morse.poses.value.revision")
    assert page.evaluate("morse.world.value.description.revision") >= revision
    where = "morse.world.value.find('robot0').frame.position.toArray().join()"
    seen: set[str] = set()
    wait_until(lambda: seen.add(page.evaluate(where)) or len(seen) > 3, "the new world moves")
    near = "morse.stage.view.position.distanceTo(morse.world.value.find('robot1').frame.position)"
    wait_until(lambda: page.evaluate(near) < 7)


def test_light_and_dark(served, open_page) -> None:
    server, url = served
    server.set_scene(Scene("s", roots=[mesh_node("box", box("b"))]), [])
    page = open_page(url, width=1200, color_scheme="dark")
    assert page.evaluate("document.documentElement.dataset.theme") == "dark"
    dark = colors(page).mean()
    ink = page.evaluate("getComputedStyle(document.body).color")
    page.get_by_role("button", name="Light or dark").click()
    wait_until(lambda: page.evaluate("getComputedStyle(document.body).color") != ink)
    # the world is the same: it is that of the cameras
    assert colors(page).mean() == pytest.approx(dark, abs=2)
    page.reload()
    assert page.evaluate("document.documentElement.dataset.theme") == "light"


# the first frame -----------------------------------------------------------------------------------------


def test_without_a_world_the_empty_ground_is_drawn(served, open_page) -> None:
    _, url = served
    page = open_page(url, wait=False)
    wait_until(lambda: page.evaluate("morse.stage.frames > 0"))
    assert page.evaluate("morse.stage.world") is None
    assert colors(page).std() > 5


FIRST = """Object.defineProperty(window, "morse", { set(app) {
    Object.defineProperty(window, "morse", { value: app });
    app.stage.onDrawn(() => { window.first ??= [performance.now(), app.stage.world !== null]; });
}, configurable: true });"""


def test_nothing_is_drawn_before_the_world_is_there(running, profile) -> None:
    _, url = running
    page = profile.new_page()
    page.set_viewport_size({"width": 300, "height": 200})
    try:
        page.add_init_script(FIRST)
        page.goto(url)
        wait_until(lambda: page.evaluate("!!window.first"))
        milliseconds, with_world = page.evaluate("window.first")
        assert with_world or milliseconds > 700  # on a slow machine, the empty ground is shown in the meantime
    finally:
        page.close()


def test_edges_are_smooth_and_surfaces_have_gloss_where_that_is_asked_for(running, shown, open_page) -> None:
    (_, url), (_, low) = running, shown
    high = open_page(f"{url}?quality=high")
    smooth = "morse.stage.renderer.getContext().getContextAttributes().antialias"
    assert (low.evaluate(smooth), high.evaluate(smooth)) == (False, True)
    gloss = """() => {
        const found = [];
        morse.stage.world.root.traverse(({ material }) => found.push(...[material].flat().filter(Boolean)));
        return found.some(({ roughness }) => roughness !== undefined);
    }"""
    assert (low.evaluate(gloss), high.evaluate(gloss)) == (False, True)


def test_a_processor_in_place_of_a_graphics_card_draws_plain_edges(running, profile) -> None:
    _, url = running
    page = profile.new_page()
    page.set_viewport_size({"width": 300, "height": 200})
    try:
        for _ in ("found out", "remembered"):
            page.goto(url)
            wait_until(lambda: page.evaluate("!!window.morse?.world.value"))
            assert page.evaluate("localStorage.getItem('morse.drawnBy')") == "software"
            assert page.evaluate("morse.stage.renderer.getContext().getContextAttributes().antialias") is False
    finally:
        page.close()
