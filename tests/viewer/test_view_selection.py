"""Several objects are selected in the page: moved, duplicated, scaled, deleted, and undone together."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from editor_desk import MODELS

import morse
from morse.viewer.catalog import Catalog
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Page

    from morse.simulation.simulation import Simulation

SCENE = """from morse.builder import *

left = PassiveObject("props/crates", object_name="small_crate")
left.translate(2.0, 2.0)
right = PassiveObject("props/crates", object_name="small_crate")
right.translate(4.0, 2.0)

env = Environment("empty")
env.set_camera_location((3.0, -6.0, 6.0))
env.set_camera_rotation((0.9, 0.0, 0.0))
"""
#: the middle of an object on the screen
PLACE = """(name) => {
    const { world, view, renderer } = morse.stage;
    const node = world.find(name), box = world.boxOf(node.walk());
    const middle = box.min.clone().add(box.max).multiplyScalar(0.5).project(view.camera);
    const frame = renderer.domElement.getBoundingClientRect();
    return [frame.left + frame.width * (middle.x + 1) / 2, frame.top + frame.height * (1 - middle.y) / 2];
}"""
CHOSEN = "morse.components.chosen"


@pytest.fixture
def edited(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, open_page: Callable[..., Page]
) -> Iterator[tuple[Simulation, Page, Path]]:
    monkeypatch.setattr(Catalog, "open", lambda catalog: catalog._take(MODELS))
    script = tmp_path / "scene.py"
    script.write_text(SCENE)
    with morse.load(script, view="web") as simulation:
        end = threading.Event()

        def run() -> None:
            while not end.is_set():
                simulation.step(1)
                end.wait(0.01)

        thread = threading.Thread(target=run)
        thread.start()
        try:
            yield simulation, open_page(simulation.view.url, width=1000, height=700), script
        finally:
            end.set()
            thread.join()


def place(simulation: Simulation, name: str) -> list[float]:
    return [float(value) for value in simulation.world.objects_by_name[name].position]


def test_several_are_moved_duplicated_deleted_and_undone_together(edited: tuple[Simulation, Page, Path]) -> None:
    simulation, page, script = edited
    page.mouse.click(*page.evaluate(PLACE, "left"))
    wait_until(lambda: page.evaluate(CHOSEN) == ["left"], "one")
    page.keyboard.down("Shift")
    page.mouse.click(*page.evaluate(PLACE, "right"))
    page.keyboard.up("Shift")
    wait_until(lambda: page.evaluate(CHOSEN) == ["left", "right"], "two")
    # the same in the tree, where both are marked; a second click takes one away
    right = page.locator('[role=treeitem][data-name="right"]')
    page.locator('[role=treeitem][data-name="objects"] .fold').click()
    assert page.locator("[role=treeitem][aria-selected=true]").count() == 2
    right.click(modifiers=["Control"])
    assert page.evaluate(CHOSEN) == ["left"]
    right.click(modifiers=["Shift"])
    assert page.evaluate(CHOSEN) == ["left", "right"]
    # the handles are on the last one, and the other keeps its place relative to it
    page.keyboard.press("m")
    page.get_by_role("toolbar", name="move").get_by_role("button", name="snap").click()
    proxy = "morse.panels.mover.proxy.position.x"
    wait_until(lambda: page.evaluate(proxy) == pytest.approx(4.0, abs=0.1), "the handles are at the object")
    begin = {name: place(simulation, name) for name in ("left", "right")}
    page.evaluate(
        """() => {
            const { mover } = morse.panels;
            mover.begin();
            mover.proxy.position.x += 1.5;
            mover.put(true);
        }"""
    )
    for name in ("left", "right"):
        x = begin[name][0] + 1.5
        wait_until(lambda name=name, x=x: abs(place(simulation, name)[0] - x) < 0.01, f"{name} is moved")
    page.keyboard.press("Control+z")
    for name in ("left", "right"):
        x = begin[name][0]
        wait_until(lambda name=name, x=x: abs(place(simulation, name)[0] - x) < 0.01, f"{name} is back")
    page.keyboard.press("Delete")
    wait_until(lambda: not {"left", "right"} & {root.name for root in simulation.scene.roots}, "both are gone")
    page.keyboard.press("Control+z")
    wait_until(lambda: {"left", "right"} <= {root.name for root in simulation.scene.roots}, "both are back")
    page.keyboard.press("Control+y")
    wait_until(lambda: not {"left", "right"} & {root.name for root in simulation.scene.roots}, "both are gone again")
    page.locator(".editor .save").wait_for()
    page.keyboard.press("Control+s")
    page.get_by_role("button", name="save", exact=True).click()
    wait_until(lambda: "PassiveObject" not in script.read_text(), "the script")


def test_handles_turn_in_steps_and_scale_what_was_added(edited: tuple[Simulation, Page, Path]) -> None:
    simulation, page, _ = edited
    page.get_by_role("button", name="add", exact=True).click()
    page.locator('[data-kind="props/crates#small_crate"]').click()
    (name,) = wait_until(lambda: page.evaluate(CHOSEN), "the crate that was added")
    page.evaluate("document.activeElement.blur()")
    page.keyboard.press("m")
    tools = page.get_by_role("toolbar", name="move")
    tools.get_by_role("button", name="scale").click()
    assert page.evaluate("morse.panels.mover.handles.mode") == "scale"
    page.keyboard.press("g")
    assert page.evaluate("morse.panels.mover.handles.rotationSnap") == pytest.approx(0.2618, abs=1e-4)
    page.evaluate("() => { const { mover } = morse.panels; mover.proxy.scale.set(1, 1, 2); mover.resize(); }")
    node = simulation.scene.find
    wait_until(lambda: (crate := node(name)) and crate.scale[2] == pytest.approx(2.0), "a higher crate")
    # the handles stay for the next change
    wait_until(lambda: page.evaluate("morse.panels.mover.node.value?.name") == name, "the handles")
    page.keyboard.press("Control+z")
    wait_until(lambda: (crate := node(name)) and crate.scale[2] == pytest.approx(1.0), "the crate as before")
