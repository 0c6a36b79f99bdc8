"""The script beside the scene: shown, changed by a page that may, and run when it is saved."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from editor_desk import SCENE, Desk
from view_pages import Client, fetch

import morse
from morse.testing.process import SimulationProcess
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Page

OTHER = SCENE.replace("robot.translate(1.0, 2.0)", "robot.translate(4.0, 2.0)")


@pytest.fixture
def desk(desk: Desk) -> Desk:
    """A page that may change the script."""
    desk.simulation.options.edit_script = True
    return desk


def version(desk: Desk) -> str:
    shown: str = desk.do("show_script")["version"]
    return shown


def test_a_text_is_shown_as_a_difference_then_written(desk: Desk, tmp_path: Path) -> None:
    now = version(desk)
    shown = desk.do("change_script", text=OTHER, version=now, write=False)
    assert "+robot.translate(4.0, 2.0)  # by the door" in shown["difference"].splitlines()
    assert (shown["error"], shown["line"], shown["runs"]) == ("", 0, True)
    assert (tmp_path / "scene.py").read_text() == SCENE
    desk.do("change_script", text=OTHER, version=now, write=True)
    assert (tmp_path / "scene.py").read_text() == OTHER
    assert desk.do("show_script")["text"] == OTHER


def test_nothing_is_written_without_the_permission_of_who_started_the_run(desk: Desk, tmp_path: Path) -> None:
    desk.simulation.options.edit_script = False
    shown = desk.do("show_script")
    assert "--edit-script" in shown["locked"]
    for write in (False, True):
        answer = desk.ask("change_script", text=OTHER, version=shown["version"], write=write)
        assert "--edit-script" in answer["error"]
    assert (tmp_path / "scene.py").read_text() == SCENE


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("from morse.builder import *\nrobot = = ATRV()\n", 2),
        ("x = (\n", 1),
        ("if True:\nx = 1\n", 2),
        ("x = '\0'\n", 1),
        ("(" * 5000 + ")" * 5000, 1),
        ("x = " + "-" * 100_000 + "1", 1),
        ("# -*- coding: nonsense -*-\n", 0),
    ],
)
def test_what_is_no_python_is_named_with_its_line_and_not_written(
    desk: Desk, text: str, line: int, tmp_path: Path
) -> None:
    answer = desk.ask("change_script", text=text, version=version(desk), write=True)
    if line:
        assert answer["ok"], answer
        assert answer["value"]["line"] == line
        assert answer["value"]["error"]
    assert (tmp_path / "scene.py").read_text() == SCENE or not line
    before = desk.simulation.clock.time
    desk.simulation.step(1)
    assert desk.simulation.clock.time > before


def test_changes_of_the_scene_and_of_the_text_do_not_overwrite_each_other(desk: Desk, tmp_path: Path) -> None:
    now = version(desk)
    desk.do("add_model", model="Morsy", position=[3, 1, 0])
    answer = desk.ask("change_script", text=OTHER, version=now, write=True)
    assert "changed meanwhile" in answer["error"]
    # the text that was shown has the addition: what is built on it keeps it
    text = desk.do("show_script")["text"]
    assert "Morsy()" in text
    desk.do("change_script", text=text + "# mine\n", version=version(desk), write=True)
    written = (tmp_path / "scene.py").read_text()
    assert "Morsy()" in written
    assert written.endswith("# mine\n")
    # until it runs, the editor does not write the scene that it knows over it
    answer = desk.ask("save_scene", write=True)
    assert "does not run yet" in answer["error"]
    assert (tmp_path / "scene.py").read_text() == written


def test_the_work_of_others_is_not_overwritten(desk: Desk, tmp_path: Path) -> None:
    (tmp_path / "scene.py").write_text(SCENE + "# of an editor\n")
    answer = desk.ask("change_script", text=OTHER, version=version(desk), write=True)
    assert "was changed since" in answer["error"]
    assert (tmp_path / "scene.py").read_text() == SCENE + "# of an editor\n"


def test_a_text_of_any_size_and_signs_is_answered(desk: Desk, tmp_path: Path) -> None:
    now = version(desk)
    assert not desk.ask("change_script", text=SCENE, version="x" * 500, write=True)["ok"]
    assert desk.ask("change_script", text="#" + "x" * 240_000, version=now, write=False)["ok"]
    assert (tmp_path / "scene.py").read_text() == SCENE
    with Client(desk.simulation.view.url) as other:
        other.expect("welcome")
        other.send("change_script", request=1, text=OTHER, version=now, write=True)
        assert "another page drives" in other.expect("answer", request=1)["error"]


def test_a_script_of_morse_itself_is_never_changed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    own = Path(morse.__file__).parent / "data" / "environments" / "sandbox.blend"
    with morse.load(own, view="web") as simulation, Client(simulation.view.url) as client:
        simulation.step(1)
        simulation.options.edit_script = True
        desk = Desk(simulation, client)
        shown = desk.do("show_script")
        done = desk.do("change_script", text=shown["text"] + "# mine\n", version=shown["version"], write=True)
    assert not done["runs"]
    assert Path(done["path"]).parent == tmp_path
    assert Path(done["path"]).read_text().endswith("# mine\n")


def test_the_script_is_edited_saved_and_run_in_the_page(tmp_path: Path, open_page: Callable[..., Page]) -> None:
    script = tmp_path / "scene.py"
    script.write_text(SCENE)
    process = SimulationProcess(script, tmp_path / "log", options=["--view-port", "0", "--edit-script"])
    try:
        process.wait_initialized(60.0)
        url = re.findall(r"the live view is at (http://\S+)", process.log.read_text())[0]
        # who may write the script is who has the address with its token, and not each user of the machine
        assert "?token=" in url
        assert fetch(url.partition("?")[0])[0] == 403
        page = open_page(url, width=1100, height=750)
        page.get_by_role("button", name="Script").click()
        code = page.locator(".script .cm-content")
        code.wait_for()
        assert "robot = ATRV()" in code.inner_text()
        # a click on a line selects, and what is selected is marked
        code.get_by_text("robot = ATRV()").click()
        wait_until(lambda: page.evaluate("morse.components.selected.value") == "robot")
        wait_until(lambda: page.locator(".script .marked").count() == 2, "two marked lines")
        page.evaluate("morse.components.selected.set(null)")
        wait_until(lambda: page.locator(".script .marked").count() == 0, "no marked line")
        # a mistake is marked at its line, and not written
        code.get_by_text("robot = ATRV()").click()
        page.keyboard.press("End")
        page.keyboard.type(" +")
        page.keyboard.press("Control+s")
        page.locator(".script .wrong").wait_for()
        assert "line 4" in page.locator(".script .error").inner_text()
        assert script.read_text() == SCENE
        page.keyboard.press("Backspace")
        page.keyboard.press("Backspace")
        page.keyboard.press("Enter")
        page.keyboard.type("robot.translate(3.0)")
        page.keyboard.press("Control+s")
        page.locator("dialog.save .added").get_by_text("robot.translate(3.0)").wait_for()
        page.get_by_role("button", name="save", exact=True).click()
        wait_until(lambda: "robot.translate(3.0)" in script.read_text(), "the script")
        x = "morse.world.value?.find('robot')?.frame.position.x ?? 0"
        wait_until(lambda: page.evaluate(x) > 3.5, "the robot of the script that was saved")
        # the page has been connected anew, and says nothing of that
        wait_until(lambda: not page.locator(".script .error").is_visible(), "no error")
        # an error that only shows when it runs
        page.locator(".script .cm-content").get_by_text("robot = ATRV()").click()
        page.keyboard.press("End")
        page.keyboard.press("Enter")
        page.keyboard.type("robot.trnslate(3.0)")
        page.get_by_role("button", name="save and run…").click()
        page.get_by_role("button", name="save", exact=True).click()
        page.locator(".script .wrong").wait_for()
        wait_until(lambda: "line 5" in page.locator(".script .error").inner_text(), "the line of the mistake")
        assert page.locator(".saved .primary").count() == 0  # there is nothing to reload
    finally:
        process.kill()
