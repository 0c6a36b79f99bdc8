"""Panels of cameras on the page."""

from __future__ import annotations

import io
import zlib
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image
from shared_views import SharedScenes
from view_worlds import playground

from morse.core.image_colors import as_colors, as_heat, depth_levels
from morse.viewer.description import ComponentDescription, FieldDescription, PropertyDescription
from morse.viewer.feeds.sensors import as_jpeg, rim
from morse.viewer.server import ViewServer
from morse.viewer.view_messages import (
    Cloud,
    Frustum,
    Picture,
    Sighting,
    Tree,
)
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Page


pytestmark = pytest.mark.browser

WIDE = {"width": 1200, "height": 700}
TAKEN = "(name) => morse.panels.images.panels.get(name).taken"
EYES = [f"robot{i}.{name}" for i in range(2) for name in ("left", "right")]


def camera(name: str) -> ComponentDescription:
    robot = name.partition(".")[0]
    lens = [PropertyDescription("cam_width", "integer", "", 64)]
    return ComponentDescription(
        name, "sensor", robot, "Camera", data=[FieldDescription("image", "buffer")], properties=lens, pictured=True
    )


ROBOTS = Tree([*(ComponentDescription(f"robot{i}", "robot", f"robot{i}") for i in range(2)), *map(camera, EYES)])


@pytest.fixture
def cameras(scenes: SharedScenes) -> tuple[ViewServer, Page]:
    """A server with two robots that have two cameras each, and a page."""
    page = scenes.show(*playground())
    scenes.server.send(ROBOTS)
    page.set_viewport_size(WIDE)  # type: ignore[arg-type]
    wait_until(lambda: page.evaluate("morse.components.all.value.length") == 6)
    return scenes.server, page


def shown(page: Page) -> list[str]:
    found: list[str] = page.evaluate("[...document.querySelectorAll('.image')].map((e) => e.dataset.camera)")
    return found


def pixels(page: Page, name: str) -> np.ndarray:
    """(H, W, 3) of a panel."""
    found = page.evaluate(
        """(name) => { const c = document.querySelector(`[data-camera='${name}'] canvas`);
        return [c.height, c.width, [...c.getContext('2d').getImageData(0, 0, c.width, c.height).data]] }""",
        name,
    )
    return np.array(found[2], int).reshape(found[0], found[1], 4)[..., :3]


def test_what_the_cameras_of_the_selected_robot_see(served, open_page) -> None:
    server, url = served
    server.set_scene(*playground())
    server.send(ROBOTS)
    page = open_page(url, **WIDE)
    wait_until(lambda: page.evaluate("morse.components.all.value.length") == 6)
    page.evaluate("morse.components.selected.set('robot0')")
    wait_until(lambda: shown(page) == EYES[:2])
    wait_until(lambda: server.wishes.images == set(EYES[:2]))
    page.locator(f"[data-camera='{EYES[0]}']").get_by_role("button", name="Close").click()
    wait_until(lambda: shown(page) == EYES[1:2])
    page.evaluate("morse.components.selected.set('robot0.left')")
    assert shown(page) == []  # closed for as long as the robot is selected
    page.evaluate("morse.components.selected.set('robot1')")
    assert shown(page) == EYES[2:]
    page.evaluate("morse.components.selected.set('robot0.left')")
    assert shown(page) == EYES[:1]
    # two that were chosen stay, side by side, whatever is selected
    page.locator("summary[title=view]").click()
    page.get_by_label(EYES[3]).check()
    page.get_by_label(EYES[1]).check()
    page.keyboard.press("Escape")
    page.evaluate("morse.components.selected.set(null)")
    assert shown(page) == [EYES[3], EYES[1]]
    boxes = page.evaluate("[...document.querySelectorAll('.image')].map((e) => e.getBoundingClientRect().toJSON())")
    assert boxes[0]["top"] == boxes[1]["top"]
    assert boxes[1]["right"] < boxes[0]["left"]
    # and they are there again after the page was loaded again
    page.reload()
    wait_until(lambda: page.evaluate("!!window.morse?.world.value") and shown(page) == [EYES[3], EYES[1]])
    page.locator("summary[title=view]").click()
    page.get_by_label("of the selected robot").uncheck()
    page.evaluate("morse.components.selected.set('robot0.left')")
    assert shown(page) == [EYES[3], EYES[1]]


def test_ids_have_colours_boxes_and_names(cameras, tmp_path) -> None:
    server, page = cameras
    page.evaluate("morse.components.selected.set('robot0.left')")
    wait_until(lambda: server.wishes.images == {EYES[0]})
    ids = np.zeros((40, 60), np.uint16)
    ids[5:35, 10:50] = 300
    ids[36:, :] = 9
    box = Sighting(300, "crate", "box", (10.0, 5.0, 50.0, 35.0))
    for i in range(3):
        rows = zlib.compress(ids.tobytes())
        server.send(Picture(rows, EYES[0], 60, 40, "image/x-u16", i / 20, "ids", sightings=[box]))
        wait_until(lambda i=i: page.evaluate(TAKEN, EYES[0]) == i + 1)
    assert page.locator(".facts").inner_text() == "60×40 · 20 Hz"
    assert np.abs(pixels(page, EYES[0]) - as_colors(ids).astype(int)).max() <= 1
    frame = page.evaluate(
        """(() => { const of = (s) => document.querySelector(s).getBoundingClientRect();
        const [c, m] = [of('.image canvas'), of('.mark-box')];
        return [m.left - c.left, m.top - c.top, m.right - c.left, m.bottom - c.top].map((x) => x / c.width * 60) })()"""
    )
    assert frame == pytest.approx([10, 5, 50, 35], abs=0.2)
    assert page.locator(".mark-box").inner_text() == "crate"
    picture = page.locator(".image .shown").bounding_box()
    assert picture is not None
    for column, row, meaning in ((30, 20, "crate: box"), (2, 2, "nothing"), (30, 38, "id 9")):
        page.mouse.move(picture["x"] + column / 60 * picture["width"], picture["y"] + row / 40 * picture["height"])
        assert page.locator(".reading").inner_text() == meaning
    for visible in (True, False):
        with page.expect_download() as download:
            page.get_by_role("button", name="Save the picture").click()
        download.value.save_as(tmp_path / "ids.png")
        saved = np.asarray(Image.open(tmp_path / "ids.png").convert("RGB"), int)
        assert saved.shape == (40, 60, 3)
        # the edge of the box is drawn in another colour than its inside
        assert bool((saved[20, 10] != saved[20, 30]).any()) is visible
        page.get_by_role("button", name="Boxes with names").click()


def test_depths_have_colours_and_a_scale(cameras) -> None:
    server, page = cameras
    page.evaluate("morse.components.selected.set('robot0.left')")
    wait_until(lambda: server.wishes.images == {EYES[0]})
    depth = np.full((16, 64), 2.0, np.float32)
    depth[:, 16:32], depth[:, 32:48], depth[:, 48:] = 3.0, 6.0, np.inf
    levels = depth_levels(depth)
    server.send(
        Picture(as_jpeg(levels.grey), EYES[0], 64, 16, "image/jpeg", 0.0, "depth", levels.low, levels.high, "m")
    )
    wait_until(lambda: page.locator(".image .scale").is_visible())
    assert page.locator(".image .scale").inner_text().split("\n") == ["2.00 m", "6.00 m"]
    seen = pixels(page, EYES[0])[8, [8, 24, 40, 56]]
    # the farther, the darker; black where nothing is seen
    assert (np.diff(seen @ (0.299, 0.587, 0.114)) < -20).all()
    assert seen[3].tolist() == [0, 0, 0]
    picture = page.locator(".image .shown").bounding_box()
    assert picture is not None
    readings = []
    for column in (8, 24, 40, 56):
        page.mouse.move(picture["x"] + column / 64 * picture["width"], picture["y"] + picture["height"] / 2)
        readings.append(page.locator(".reading").inner_text())
    assert readings.pop() == "nothing"
    assert [float(text.strip("≈ m")) for text in readings] == pytest.approx([2.0, 3.0, 6.0], abs=0.1)


def test_hot_surfaces_are_bright(cameras) -> None:
    server, page = cameras
    page.evaluate("morse.components.selected.set('robot0.left')")
    wait_until(lambda: server.wishes.images == {EYES[0]})
    heat = np.full((16, 48), 15.0, np.float32)
    heat[:, 16:32], heat[:, 32:] = 36.5, 60.0
    levels = depth_levels(heat)
    server.send(
        Picture(as_jpeg(levels.grey), EYES[0], 48, 16, "image/jpeg", 0.0, "temperature", levels.low, levels.high, "°C")
    )
    wait_until(lambda: page.locator(".image .scale").is_visible())
    assert page.locator(".image .scale").inner_text().split("\n") == ["15.0 °C", "60.0 °C"]
    seen = pixels(page, EYES[0])[8, [8, 24, 40]]
    assert (np.diff(seen @ (0.299, 0.587, 0.114)) > 20).all()
    np.testing.assert_allclose(seen, as_heat(heat)[8, [8, 24, 40]], atol=12)


def test_the_points_of_a_cloud_are_drawn_where_they_are(cameras) -> None:
    server, page = cameras
    layer = "morse.panels.layers.list.find((one) => one.id === 'rays')"
    page.evaluate("morse.panels.layers.switch('rays', true)")
    wait_until(lambda: set(EYES) <= server.wishes.overlays)
    cloud = np.array([[1, 2, 3], [4, 5, 6.5]], np.float32)
    server.send(Cloud(cloud.tobytes(), EYES[1]))
    wait_until(lambda: page.evaluate(f"{layer}.drawn.has('{EYES[1]}')"))
    drawn = page.evaluate(f"[...{layer}.drawn.get('{EYES[1]}').hits.geometry.attributes.position.array]")
    assert drawn == cloud.ravel().tolist()
    page.evaluate("morse.panels.layers.switch('rays', false)")
    assert page.evaluate(f"{layer}.root.children.length") == 0


def test_a_panel_grows_and_shrinks(cameras) -> None:
    _, page = cameras
    page.evaluate("morse.components.selected.set('robot0.left')")
    width = "document.querySelector('.image').clientWidth"
    small = page.evaluate(width)
    page.get_by_role("button", name="Larger").click()
    assert page.evaluate(width) > 1.8 * small
    page.get_by_role("button", name="Smaller").click()
    assert page.evaluate(width) == small


def test_fields_of_view_start_at_their_cameras_in_their_colours(running, open_page) -> None:
    from morse.rendering.lens import Lens

    driver, url = running
    driver.running = False
    lens = Lens.of_angle(64, 48, 1.2, 0.1, 2.0)
    driver.server.send(Frustum("robot0.lidar", [(x, y, z) for x, y, z in rim(lens).tolist()], lens.near, lens.far))
    page = open_page(url, **WIDE)
    page.evaluate("morse.panels.layers.switch('frustums', true)")
    layer = "morse.panels.layers.list.find((one) => one.id === 'frustums')"
    wait_until(lambda: page.evaluate(f"{layer}.root.children.length") == 1)
    wait_until(lambda: "robot0.lidar" in driver.server.wishes.overlays)
    corner = page.evaluate(
        f"""(() => {{ const parts = {layer}.root.children[0]; morse.stage.draw(); parts.updateMatrixWorld(true);
        const lines = parts.children[0]; const box = lines.geometry.attributes.position;
        const eye = morse.world.value.find('robot0.lidar').frame.getWorldPosition(morse.stage.target.clone());
        const points = Array.from({{length: box.count}}, (_, i) => eye.clone().fromBufferAttribute(box, i));
        const first = points.find((p) => p.length() === 0).clone().applyMatrix4(parts.matrixWorld);
        return [first.distanceTo(eye), Math.max(...points.map((p) => p.z)), Math.max(...points.map((p) => p.x)),
            Math.max(...points.map((p) => p.y))] }})()"""
    )
    # 2 m along the axis, tan(0.6 rad) of it to each side, 48/64 of that up and down
    across = 2.0 * float(np.tan(0.6))
    assert corner == pytest.approx([0.0, 2.0, across, 0.75 * across], abs=1e-4)
    used = page.evaluate(
        f"""(() => {{ const c = {layer}.root.children[0].children[0].geometry.attributes.color;
        const color = morse.stage.scene.fog?.color.clone() ?? new morse.stage.lights.sun.color.constructor();
        return '#' + color.setRGB(c.getX(0), c.getY(0), c.getZ(0)).getHexString() }})()"""
    )
    assert used == page.evaluate("morse.components.colorOf('robot0.lidar')")
    page.evaluate("morse.panels.layers.switch('frustums', false)")
    assert page.evaluate(f"{layer}.root.children.length") == 0


def test_a_damaged_picture_does_not_stop_the_panel(cameras) -> None:
    server, page = cameras
    page.evaluate("morse.components.selected.set('robot0.left')")
    wait_until(lambda: server.wishes.images == {EYES[0]})
    data = io.BytesIO()
    Image.new("RGB", (8, 8), (0, 200, 0)).save(data, "JPEG")
    for i, mime in enumerate(("image/jpeg", "image/x-u16", "image/x-rgba")):
        server.send(Picture(b"not a picture", EYES[0], 8, 8, mime))
        wait_until(lambda i=i: page.evaluate(TAKEN, EYES[0]) == i + 1)
    server.send(Picture(data.getvalue(), EYES[0], 8, 8, "image/jpeg", 1.0))
    wait_until(lambda: pixels(page, EYES[0])[4, 4].tolist() == pytest.approx([0, 200, 0], abs=6))
