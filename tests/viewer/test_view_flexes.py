"""The page shows deformable bodies as they are."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

import morse
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.browser

MODEL = """<mujoco model="soft"><option timestep="0.001"/><worldbody><geom name="floor" type="plane" size="0 0 .1"/>
<body pos="0 0 .3"><geom type="sphere" size=".2"/></body>
<flexcomp name="cloth" type="grid" count="7 7 1" spacing=".1 .1 .1" pos="0 0 1" radius=".01" mass="1" dim="2">
<edge equality="true" damping="0.01"/><contact selfcollide="none"/></flexcomp>
<flexcomp name="rope" type="grid" count="6 1 1" spacing=".1 .1 .1" pos="0 1 1" radius=".02" mass="1" dim="1">
<pin id="0"/><edge equality="true"/></flexcomp></worldbody></mujoco>"""
SCENE = """
from morse.builder import *
robot = Robot({path!r})
robot.translate(x=2)
robot.rotate(z=1.0)
Environment("empty")
"""
#: the vertices of a geometry in the world, of a node that is not turned
VERTICES = """name => {
    const { drawn, frame } = morse.world.value.find(name);
    const places = drawn.geometry.getAttribute("position").array;
    return Array.from(places, (value, k) => value + frame.position.getComponent(k % 3));
}"""


def test_their_vertices_are_those_of_the_simulation(tmp_path: Path, open_page: Callable[..., "Page"]) -> None:
    (tmp_path / "soft.xml").write_text(MODEL)
    script = tmp_path / "scene.py"
    script.write_text(SCENE.format(path=str(tmp_path / "soft.xml")))
    with morse.load(script, view="web") as sim:

        def places(name: str) -> np.ndarray:
            world = sim.world
            children = world.game_object(name).node.children
            return np.array([world.object_of(child).world_pose()[0] for child in children])

        def nearest(page: "Page", name: str) -> float:
            """The largest distance of a vertex of the page from the nearest one of the simulation, m."""
            shown = np.array(page.evaluate(VERTICES, name)).reshape(-1, 3)
            assert len(shown) == {"cloth": 49, "rope": 36}[name]
            return float(np.linalg.norm(shown[:, None] - places(name), axis=2).min(axis=1).max())

        page = open_page(sim.view.url)
        sim.step(60)
        assert np.ptp(places("cloth")[:, 2]) > 0.1
        # the page is some ticks behind; the cloth hangs on the ball and hardly moves
        wait_until(lambda: sim.step() or nearest(page, "cloth") < 0.01, "the cloth on the page")  # type: ignore[func-returns-value]
        wait_until(lambda: sim.step() or abs(nearest(page, "rope") - 0.02) < 0.01, "the rope on the page")  # type: ignore[func-returns-value]
        shown = np.array(page.evaluate(VERTICES, "cloth")).reshape(-1, 3)
        assert np.ptp(shown[:, 2]) > 0.1
