"""The light of lamps."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image
from view_pages import toasts
from view_worlds import mesh_node, plane

from morse.scene import Light, Material, Node, NodeKind, Scene
from morse.viewer.describe import describe_light
from morse.viewer.view_messages import Appearance
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.browser

GREY = Material("grey", (0.5, 0.5, 0.5, 1.0), roughness=1.0)


def lamp(name: str, kind: str, place: tuple[float, float, float], turn: float = 0.0, **settings: float) -> Node:
    light = Light(kind, casts_shadow=False, **settings)  # type: ignore[arg-type]
    return Node(name, NodeKind.LIGHT, location=list(place), rotation_euler=[turn, 0.0, 0.0], light=light)


def brightness(page: Page, folder: Path) -> float:
    """Colour of the centre of the view."""
    page.screenshot(path=folder / "view.png")
    picture = np.asarray(Image.open(folder / "view.png").convert("L"), float)
    height, width = picture.shape
    return float(picture[height // 2 - 20 : height // 2 + 20, width // 2 - 20 : width // 2 + 20].mean())


@pytest.mark.parametrize(("kind", "one_sided"), [("AREA", True), ("POINT", False)])
def test_an_area_lamp_lights_what_is_before_it(scenes, tmp_path, kind, one_sided) -> None:
    seen = []
    for turn in (0.0, math.pi):  # down, up
        scene = Scene("room", roots=[mesh_node("floor", plane("floor", GREY, 20.0))])
        scene.roots.append(lamp("lamp", kind, (0.0, 0.0, 2.0), turn, energy=1.5))
        scene.settings.view.camera_location = (0.0, -4.0, 4.0)
        scene.settings.view.camera_rotation = (math.pi / 4, 0.0, 0.0)
        seen.append(brightness(scenes.show(scene), tmp_path))
    down, up = seen
    assert (down > up + 20) is one_sided


def test_a_night_is_dark_but_for_its_lamps(scenes, tmp_path) -> None:
    seen = []
    for lamps in (0, 1):
        scene = Scene("room", roots=[mesh_node("floor", plane("floor", GREY, 20.0))])
        scene.roots += [lamp("lamp", "POINT", (0.0, 0.0, 2.0), energy=1.5)] * lamps
        scene.settings.view.daylight = 0.0
        scene.settings.view.camera_location = (0.0, -4.0, 4.0)
        scene.settings.view.camera_rotation = (math.pi / 4, 0.0, 0.0)
        seen.append(brightness(scenes.show(scene), tmp_path))
    night, lit = seen
    assert night < 10
    assert lit > 40


def test_of_too_many_lamps_those_that_light_the_view_are_kept(scenes) -> None:
    scene = Scene("hall", roots=[mesh_node("floor", plane("floor", GREY, 20.0))])
    scene.roots += [lamp(f"far{i}", "POINT", (300.0, 0.0, 3.0), energy=1.0, distance=10.0) for i in range(9)]
    scene.roots.append(lamp("near", "POINT", (2.0, 0.0, 3.0), energy=0.2, distance=10.0))
    scene.roots.append(lamp("sky", "HEMI", (300.0, 0.0, 3.0), energy=0.1))
    scene.settings.view.camera_location = (0.0, -4.0, 4.0)
    page = scenes.show(scene)
    wait_until(lambda: toasts(page))
    (toast,) = toasts(page)
    assert toast.startswith("3 lamps are not shown: far")
    assert "near" not in toast
    assert "sky" not in toast


def test_a_lamp_changes_on_the_page(served, open_page, tmp_path) -> None:
    server, url = served
    scene = Scene("room", roots=[mesh_node("floor", plane("floor", GREY, 20.0))])
    scene.roots.append(lamp("lamp", "POINT", (0.0, 0.0, 2.0), energy=0.1))
    scene.settings.view.camera_location = (0.0, -4.0, 4.0)
    scene.settings.view.camera_rotation = (math.pi / 4, 0.0, 0.0)
    server.set_scene(scene, [])
    page = open_page(url)
    dim = brightness(page, tmp_path)
    change = Appearance("lamp", True, None, describe_light(Light("POINT", energy=2.0, casts_shadow=False)))
    server.send(change)
    wait_until(lambda: brightness(page, tmp_path) > dim + 20)
    # a page that comes later is told, too, although the world was described before
    late = open_page(url)
    wait_until(lambda: brightness(late, tmp_path) > dim + 20)


def test_beside_lamps_a_sun_still_casts_shadows_that_are_seen(scenes, tmp_path) -> None:
    seen = []
    for height in (3.0, -3.0):  # a board above the floor, or below it
        scene = Scene("hall", roots=[mesh_node("floor", plane("floor", GREY, 20.0))])
        scene.roots.append(mesh_node("board", plane("board", GREY, 2.0), (0.0, 0.0, height)))
        scene.roots.append(lamp("sun", "SUN", (0.0, 0.0, 10.0), energy=0.7))
        scene.roots += [lamp(f"lamp{i}", "POINT", (x, 0.0, 7.0), energy=0.5) for i, x in enumerate((-10.0, 0.0, 10.0))]
        scene.settings.view.camera_location = (0.0, -4.0, 1.5)
        scene.settings.view.camera_rotation = (math.atan2(4.0, 1.5), 0.0, 0.0)
        seen.append(brightness(scenes.show(scene), tmp_path))
    shade, light = seen
    assert shade < 0.88 * light


def test_a_floor_hides_the_lines_on_the_ground(scenes, tmp_path) -> None:
    scene = Scene("hall", roots=[mesh_node("floor", plane("floor", GREY, 60.0))])
    scene.settings.view.camera_location = (1.3, -1.7, 1.4)
    scene.settings.view.camera_rotation = (1.0, 0.0, 0.4)
    page = scenes.show(scene)

    def lines(on: bool) -> np.ndarray:
        drawn = page.evaluate("morse.stage.frames")
        page.evaluate("on => { morse.stage.ground.mesh.visible = on; morse.stage.invalidate(); }", on)
        wait_until(lambda: page.evaluate("morse.stage.frames") > drawn)
        page.locator("main > canvas").screenshot(path=tmp_path / "view.png")
        return np.asarray(Image.open(tmp_path / "view.png").convert("RGB"), int)

    floor = slice(200, None)  # above it is the horizon
    without = lines(False)
    assert np.abs(lines(True)[floor] - without[floor]).max() < 6
