"""Worlds of very many objects."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from view_worlds import mesh_node, sphere

from morse.scene import Material, Scene
from morse.viewer.snapshot import MovingNode, Snapshot
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.browser

SIDE = 70  # 4900 balls, one metre apart
NEAR_AND_FAR = ("ball1", f"ball{SIDE * SIDE - 1}")
DRAWN = "(({ calls, triangles }) => [calls, triangles])(morse.stage.renderer.info.render)"
SHOWN = """morse.stage.world.batches.flatMap(({ levels }) => levels.map(({ mesh, nodes }) =>
    [mesh.geometry.index.count / 3, nodes.map((node) => node.name)]))"""
PLACE = """name => { const { levels } = morse.stage.world.batches[0];
    for (const { mesh, nodes } of levels) for (const [i, node] of nodes.entries()) if (node.name === name)
        return [...mesh.instanceMatrix.array.slice(16 * i + 12, 16 * i + 15)]; return null; }"""
STAND = "place => { morse.stage.view.position.set(...place); morse.stage.invalidate(); }"


@pytest.fixture(scope="module")
def page(shared_scenes) -> Page:
    """A field of balls on the ground, viewed from its corner."""
    ball = sphere("ball", Material("red", (0.7, 0.1, 0.1, 1.0)), 0.3)
    nodes = [mesh_node(f"ball{i}", ball, (i % SIDE, i // SIDE, 0.3)) for i in range(SIDE * SIDE)]
    scene = Scene("field", roots=nodes)
    scene.settings.view.camera_location = (-3.0, -3.0, 2.0)
    scene.settings.view.camera_rotation = (1.4, 0.0, -0.785)
    poses = np.zeros((len(nodes), 7), np.float32)
    poses[:, :3] = [node.location for node in nodes]
    poses[:, 3] = 1.0
    shared_scenes.fresh(failures=0)
    page: Page = shared_scenes.show(scene, [MovingNode(node, "world") for node in nodes])
    poses[0, 2] = 2.3

    def newest_is_drawn() -> bool:
        shared_scenes.server.publish(Snapshot(1, 1 / 60, shared_scenes.revision, poses, "running", 1.0, 1.0))
        return abs((page.evaluate(PLACE, "ball0") or [0, 0, 0])[2] - 2.3) < 1e-4

    wait_until(newest_is_drawn)
    return page


def test_they_are_drawn_in_few_calls_and_far_ones_with_few_triangles(page) -> None:
    calls, _ = page.evaluate(DRAWN)
    assert calls < 15
    fine = 16 * 24 * 2
    levels = page.evaluate(SHOWN)
    assert sum(triangles * len(names) for triangles, names in levels) < SIDE * SIDE * fine / 4
    assert [level[0] for level in levels] == sorted((level[0] for level in levels), reverse=True)
    assert levels[0][0] == fine
    assert levels[-1][0] < fine / 4
    near, far = (next(triangles for triangles, names in levels if name in names) for name in NEAR_AND_FAR)
    assert near > 2 * far


def test_each_is_drawn_once_where_it_is(page) -> None:
    shown = [name for _, names in page.evaluate(SHOWN) for name in names]
    assert len(shown) == len(set(shown))
    for name in NEAR_AND_FAR:
        number = int(name.removeprefix("ball"))
        assert page.evaluate(PLACE, name) == pytest.approx([number % SIDE, number // SIDE, 0.3], abs=1e-5)


def test_what_is_behind_is_not_drawn_and_comes_back(page) -> None:
    page.evaluate(STAND, [200.0, 200.0, 2.0])
    wait_until(lambda: page.evaluate(DRAWN)[1] < 5000)
    page.evaluate(STAND, [-3.0, -3.0, 2.0])
    wait_until(lambda: page.evaluate(DRAWN)[1] > 10_000)


def test_they_are_selected_by_a_click_however_they_are_drawn(page) -> None:
    for name in ("ball71", "ball2200"):
        x, y = page.evaluate(
            """name => { const p = morse.stage.world.find(name).frame.position.clone().project(morse.stage.view.camera);
            const b = morse.stage.element.getBoundingClientRect();
            return [b.left + (p.x + 1) / 2 * b.width, b.top + (1 - p.y) / 2 * b.height]; }""",
            name,
        )
        page.mouse.click(x, y)
        wait_until(lambda: (page.evaluate("morse.components.selected.value") or "").startswith("ball"))
        hit = int(page.evaluate("morse.components.selected.value").removeprefix("ball"))
        number = int(name.removeprefix("ball"))
        # the balls in front of it may hide it: then one of them is selected
        assert hit % SIDE <= number % SIDE
        assert hit // SIDE <= number // SIDE
        page.keyboard.press("Escape")
