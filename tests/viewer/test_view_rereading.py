"""F11 reloads an edited scene script."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from view_pages import Client

from morse.testing.process import SimulationProcess
from pymorse import Morse
from tests.kit.waiting import wait_until

SCENE = """
from morse.builder import *
from places import START

robot = ATRV("rover")
robot.translate(START, 0.0, 0.0)
pose = Pose()
robot.append(pose)
robot.add_default_interface("socket")
env = Environment("empty", fastmode=True)
"""


class Edited:
    """A simulation that watches its files, and its driving page."""

    def __init__(self, folder: Path) -> None:
        self.script, self.places = folder / "scene.py", folder / "places.py"
        self.script.write_text(SCENE)
        self.places.write_text("START = 1.0\n")
        self.process = SimulationProcess(self.script, folder / "log", options=["--view-port", "0"])
        self.process.wait_initialized(60.0)
        self.url = self.addresses()[0]

    def log(self) -> str:
        return self.process.log.read_text()

    def addresses(self) -> list[str]:
        return re.findall(r"the live view is at (http://\S+)", self.log())

    def start_anew(self, times: int) -> None:
        with Client(self.url) as page:
            page.expect("seat", pages=1)
            page.send("reset")
            wait_until(lambda: len(self.addresses()) > times, limit=60.0)

    def x(self, robot: str = "rover") -> float:
        """The position of the robot, requested over the last port in the log."""
        ports = re.findall(r"services are on port (\d+)", self.log())
        with Morse("127.0.0.1", int(ports[-1])) as simu:
            return float(getattr(simu, robot).pose.get(timeout=60.0)["x"])


@pytest.fixture
def edited(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Edited]:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    running = Edited(tmp_path)
    yield running
    running.process.kill()


def test_an_edited_script_is_read_again(edited: Edited) -> None:
    assert edited.x() == pytest.approx(1.0, abs=0.01)
    edited.script.write_text(SCENE.replace('ATRV("rover")', 'ATRV("other")').replace("START, 0.0", "START + 1.5, 0.0"))
    edited.start_anew(1)
    assert edited.x("other") == pytest.approx(2.5, abs=0.01)
    assert edited.addresses() == [edited.url] * 2, "pages come back to the same address"
    # modules that the script imports count as well
    edited.places.write_text("START = -3.25\n")
    edited.start_anew(2)
    assert edited.x("other") == pytest.approx(-1.75, abs=0.01)


def test_a_script_with_a_mistake_is_not_taken(edited: Edited) -> None:
    edited.script.write_text(SCENE.replace("ATRV", "ATVR"))
    with Client(edited.url) as page:
        page.expect("seat", pages=1)
        page.send("reset")
        told = ("the edited scene cannot be loaded", "ATVR", "scene.py:5", "ATRV")
        wait_until(lambda: all(text in edited.log() for text in told), limit=60.0)
    assert edited.x() == pytest.approx(1.0, abs=0.01)
    assert len(edited.addresses()) == 1


def test_a_script_that_a_restart_has_refused_is_not_offered_again(edited: Edited) -> None:
    with Client(edited.url) as page:
        page.expect("seat", pages=1)
        edited.script.write_text(SCENE.replace("ATRV", "ATVR"))
        page.send("reset")  # at once, before the watch of the files has seen it
        (mistake,) = page.expect("saved_files", waiting=[])["mistakes"]
        assert mistake["line"] == 5
        # the watch looks at this file after the script, and tells it later
        edited.places.write_text("START = (\n")
        news = page.expect("saved_files")
        assert news["waiting"] == []
        assert mistake in news["mistakes"]


def test_a_saved_script_is_announced_and_a_mistake_stays_until_it_is_mended(edited: Edited) -> None:
    with Client(edited.url) as page:
        page.expect("seat", pages=1)
        edited.script.write_text(SCENE.replace("ATRV(", "ATRV(("))
        (mistake,) = page.expect("saved_files", waiting=[])["mistakes"]
        assert (mistake["file"], mistake["line"]) == ("scene.py", 5)
        assert "never closed" in mistake["text"]
        with Client(edited.url) as later:  # it is there for a page that opens later
            assert later.expect("saved_files")["mistakes"] == [mistake]
        edited.script.write_text(SCENE.replace("ATRV", "ATVR"))
        assert page.expect("saved_files", mistakes=[])["waiting"] == ["scene.py"]
        page.send("reset")
        (mistake,) = page.expect("saved_files", waiting=[])["mistakes"]
        assert (mistake["file"], mistake["line"]) == ("scene.py", 5)
        assert "ATRV" in mistake["text"]  # the nearest word
        edited.script.write_text(SCENE)
        page.expect("saved_files", mistakes=[])


def test_what_the_page_itself_saves_is_not_offered_again(edited: Edited) -> None:
    with Client(edited.url) as page:
        page.expect("seat", pages=1)
        page.send("teleport", request=2, node="rover", position=[4.0, 0.0, 0.1], quaternion=[1, 0, 0, 0], first=True)
        page.expect("scene_changes", count=1)
        page.send("save_scene", request=1, write=True)
        assert page.expect("answer", request=1)["ok"]
        assert "robot.translate(START + 3.0" in edited.script.read_text()
        # a mistake of somebody else comes after it, and is told: nothing was told in between
        edited.script.write_text(edited.script.read_text().replace("ATRV(", "ATRV(("))
        assert page.expect("saved_files")["waiting"] == []
    assert "was saved: it is read again" not in edited.log()
