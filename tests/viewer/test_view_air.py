"""Fog, rain and snow in the view itself."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image
from view_worlds import mesh_node, plane

from morse.scene import Material, Scene
from morse.viewer.view_messages import AirLook, AirPart
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from pathlib import Path

    from playwright.sync_api import Page

pytestmark = pytest.mark.browser

HEIGHT = 20.0
CALM = AirLook([], (0.0, 0.0, 0.0), 0.0, 0.0)


def air(*parts: AirPart) -> AirLook:
    return AirLook(list(parts), (0.0, 0.0, 0.0), 0.0, 0.0)


def part(fog: float, rain: float = 0.0, corners: tuple[tuple[float, float], ...] = ()) -> AirPart:
    extinction = 2.996 / fog
    return AirPart((0.8, 0.8, 0.8), extinction, 200.0 * extinction, rain, 0.0, list(corners), None)


def code(page: Page, folder: Path) -> float:
    page.screenshot(path=folder / "view.png")
    picture = np.asarray(Image.open(folder / "view.png").convert("L"), float)
    height, width = picture.shape
    return float(picture[height // 2 - 4 : height // 2 + 4, width // 2 - 4 : width // 2 + 4].mean())


def shown(scenes, look: AirLook) -> None:
    page = scenes._page.page
    scenes.server.send(look)
    wait_until(lambda: page.evaluate("morse.air.look?.parts.length") == len(look.parts))
    drawn = page.evaluate("(morse.stage.invalidate(), morse.stage.frames)")
    wait_until(lambda: page.evaluate("morse.stage.frames") > drawn)


@pytest.fixture
def page(scenes) -> Page:
    black = Material("black", (0.0, 0.0, 0.0, 1.0), shadeless=True)
    scene = Scene("field", roots=[mesh_node("floor", plane("floor", black, 200.0))])
    scene.settings.view.camera_location = (0.0, 0.0, HEIGHT)
    scene.settings.view.camera_rotation = (0.0, 0.0, 0.0)
    yield scenes.show(scene)
    scenes.server.send(CALM)


def test_a_black_floor_in_fog_has_the_light_of_koschmieder(scenes, page, tmp_path) -> None:
    """1 - exp(-2.996 d / range) of the light of the air, in the part of the world where the camera is."""
    light = ((0.8 + 0.055) / 1.055) ** 2.4
    here, there = ((-5.0, -5.0), (5.0, -5.0), (0.0, 5.0)), ((40.0, -5.0), (50.0, -5.0), (45.0, 5.0))
    for look, fog in (
        (air(part(60.0)), 60.0),
        (air(part(20.0), part(100.0, corners=here)), 100.0),
        (air(part(30.0), part(200.0, corners=there)), 30.0),
    ):
        shown(scenes, look)
        expected = light * (1.0 - math.exp(-2.996 * HEIGHT / fog))
        assert code(page, tmp_path) == pytest.approx(255.0 * (1.055 * expected ** (1.0 / 2.4) - 0.055), abs=2.0)
    shown(scenes, CALM)
    assert code(page, tmp_path) < 2.0


def test_drops_fall_unless_the_user_wants_no_motion(scenes, page) -> None:
    falls = "morse.air.falling.map(({ object }) => object.visible)"
    shown(scenes, air(part(1000.0, rain=10.0)))
    assert page.evaluate(falls) == [True, False]
    page.emulate_media(reduced_motion="reduce")
    shown(scenes, air(part(1000.0, rain=11.0)))
    assert page.evaluate(falls) == [False, False]
    page.emulate_media(reduced_motion="no-preference")
    shown(scenes, CALM)
    assert page.evaluate(falls) == [False, False]


def test_snow_covers_level_ground_also_without_gloss(scenes, tmp_path) -> None:
    """Soil reflects 2 % of the light, and snow 83 %: 41 times as much, more than 4 times the code of sRGB."""
    soil = Material("soil", (0.02, 0.02, 0.02, 1.0), roughness=1.0)
    scene = Scene("field", roots=[mesh_node("floor", plane("floor", soil, 200.0))])
    scene.settings.view.camera_location = (0.0, 0.0, HEIGHT)
    scene.settings.view.camera_rotation = (0.0, 0.0, 0.0)
    page = scenes.show(scene)
    bare = code(page, tmp_path)
    scenes.server.send(AirLook([], (0.0, 0.0, 0.0), 0.0, 1.0))
    wait_until(lambda: page.evaluate("morse.air.look?.snow_cover") == 1)
    drawn = page.evaluate("(morse.stage.invalidate(), morse.stage.frames)")
    wait_until(lambda: page.evaluate("morse.stage.frames") > drawn)
    assert page.evaluate("morse.stage.surfaces.matt") is True
    assert code(page, tmp_path) > 4.0 * bare
    scenes.server.send(CALM)
