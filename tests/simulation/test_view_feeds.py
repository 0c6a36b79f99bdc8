"""The data that a simulation sends to pages: its log, its viewpoint, data of any kind."""

import contextlib
import itertools
import json
import logging
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from websockets.sync.client import connect

from morse.core.observer import SHOWN
from morse.viewer.feeds.components import shown
from morse.viewer.feeds.log import KEPT, printable
from morse.viewer.live_view import View
from morse.viewer.protocol import VERSION

SCENE = """
robot = ATRV()
motion, pose = MotionVW(), Pose()
robot.append(motion)
robot.append(pose)
env = Environment('empty', fastmode=True)
"""
LOG = logging.getLogger("morse.morse.test")


class Page:
    """A page of a simulation whose ticks are run by the test."""

    def __init__(self, simulation: Any) -> None:
        self.simulation = simulation
        self.view = View(simulation)
        simulation.view = self.view
        simulation.observers.append(self.view)
        self.view.announce()
        self._stack = contextlib.ExitStack()
        self.connect()

    def connect(self) -> None:
        """Reconnect as a new page."""
        self.close()
        address = self.view.url.replace("http", "ws") + "ws"
        self.socket = self._stack.enter_context(connect(address, max_size=None, max_queue=None, ping_interval=None))
        self.send("hello", version=VERSION)
        self.expect("welcome")

    def close(self) -> None:
        """Disconnect."""
        self._stack.close()

    def send(self, kind: str, **fields: Any) -> None:
        self.socket.send(json.dumps({"type": kind, **fields}))

    def expect(self, kind: str, **fields: Any) -> Any:
        """The next message of a kind with these fields; the simulation runs meanwhile."""
        end = time.monotonic() + 60.0
        while time.monotonic() < end:
            self.simulation.tick()
            try:
                frame = self.socket.recv(timeout=0.005)
            except TimeoutError:
                continue
            message = json.loads(frame) if isinstance(frame, str) else {}
            if message.get("type") == kind and all(message[name] == value for name, value in fields.items()):
                return message
        raise AssertionError(f"no {kind} with {fields}")

    def world_is_not_sent_again(self) -> bool:
        while True:
            try:
                frame = self.socket.recv(timeout=0.1)
            except TimeoutError:
                return True
            if isinstance(frame, str) and json.loads(frame)["type"] == "world":
                return False


@pytest.fixture(autouse=True)
def talkative(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(LOG, "level", logging.INFO)
    LOG.manager._clear_cache()  # type: ignore[attr-defined]


@pytest.fixture
def page(load: Callable[..., Any]) -> Iterator[Page]:
    page = Page(load(SCENE, view="web", view_port=0))
    yield page
    page.close()


# the log -------------------------------------------------------------------------------------------------


def test_a_component_that_fails_is_named_in_the_log_of_the_page(page: Page) -> None:
    page.simulation.context.components["robot.pose"].default_action = lambda: 1 / 0
    told = page.expect("log", level="error")
    assert told["text"].startswith("[ERROR][MORSE] robot.pose failed and is deactivated: ZeroDivisionError")
    assert told["component"] == "robot.pose"
    assert page.expect("activity") == {"type": "activity", "component": "robot.pose", "active": False}


def test_a_refused_message_is_shown_with_the_component_that_refused_it(page: Page) -> None:
    LOG.warning("%s: %s", "robot.motion", "a message is refused: 'v' is 'fast', expected a number")
    told = page.expect("log", level="warning")
    assert told["component"] == "robot.motion"
    LOG.warning("%s", "robot.motion: it declares no field 'x'")
    assert page.expect("log", level="warning")["component"] == "robot.motion"
    LOG.warning("nothing that has a name like %s", "robot.motion2")
    assert page.expect("log", level="warning")["component"] == ""


def test_what_the_page_shows_elsewhere_does_not_pop_up(page: Page) -> None:
    LOG.warning("%.1f s lost", 2.0, extra={SHOWN: True})
    assert page.expect("log", text="2.0 s lost")["shown"] is True


def test_a_page_that_comes_later_reads_what_was_said_before(page: Page) -> None:
    for i in range(KEPT + 10):
        LOG.info("line %d", i)
    page.expect("log", text=f"line {KEPT + 9}")
    page.connect()
    texts = [page.expect("log")["text"] for _ in range(KEPT)]
    assert texts == [f"line {i}" for i in range(10, KEPT + 10)]


def test_lines_of_another_simulation_are_not_shown(page: Page) -> None:
    other = threading.Thread(target=LOG.info, args=["not ours"])
    other.start()
    other.join()
    LOG.info("ours")
    texts = [page.expect("log")["text"]]
    while texts[-1] != "ours":
        texts.append(page.expect("log")["text"])
    assert "not ours" not in texts


def test_nothing_listens_to_the_log_after_the_end(page: Page) -> None:
    handlers = list(logging.getLogger("morse").handlers)
    page.view.close()
    assert len(logging.getLogger("morse").handlers) == len(handlers) - 1


def test_what_could_be_taken_for_something_else_is_written_as_escapes() -> None:
    assert printable("a\x1b[31mb\r\ud800\u202e\nc\td") == "a\\x1b[31mb\\r\\ud800\\u202e\nc\td"
    assert printable("Größe 3 µm, 机器人") == "Größe 3 µm, 机器人"


def test_a_line_whose_text_cannot_be_made_is_shown_as_it_was_meant(page: Page) -> None:
    logging.raiseExceptions, before = False, logging.raiseExceptions
    LOG.info("%d pieces", "some")
    logging.raiseExceptions = before
    assert page.expect("log", text="%d pieces")


# data of any kind ----------------------------------------------------------------------------------------


class Broken:
    def __repr__(self) -> str:
        raise RuntimeError("it is broken")


def _circle() -> list[Any]:
    circle: list[Any] = []
    circle += [circle] * 10
    return circle


@pytest.mark.parametrize(
    "value",
    ["\ud800", {"\ud800": 1}, {(1, 2): "\udfff"}, _circle(), Broken(), [Broken()], 10**400, itertools.count()],
    ids=["text", "key", "other key", "circle", "broken", "broken within", "large", "endless"],
)
def test_no_value_ends_the_simulation_or_the_page(page: Page, value: Any) -> None:
    data = page.simulation.context.components["robot.motion"].local_data
    page.send("watch", values=["robot.motion"])
    page.expect("values")
    data["odd"] = value
    data["\ud800"] = 1
    told = page.expect("values")
    while "odd" not in told["data"]:
        told = page.expect("values")
    assert told["data"]["v"] == 0.0
    assert told["data"]["\\ud800"] == 1
    page.send("alive")
    assert page.expect("values")


def test_lone_surrogates_of_a_page_are_refused_and_the_next_page_is_let_in(page: Page) -> None:
    page.send("set_property", request=1, component="robot.\ud800", name="x", value="\ud800")
    with pytest.raises(Exception, match="4001"):
        page.expect("answer")
    page.connect()
    page.send("set_property", request=2, component="robot.none", name="x", value=1)
    assert not page.expect("answer", request=2)["ok"]


def test_a_name_with_a_lone_surrogate_is_described(page: Page) -> None:
    node = next(page.simulation.scene.nodes())
    node.name = "r\ud800"
    page.view._describe()
    page.connect()
    files = page.view._server._hub.site.files
    newest = max((path for path in files if path.startswith("/worlds/")), key=lambda p: int(p[8:-5]))
    assert "r\\ud800" in [described["name"] for described in json.loads(files[newest].data)["nodes"]]


def test_what_is_too_large_to_be_shown_is_only_named() -> None:
    assert shown(np.zeros((480, 640, 4), np.uint8)) == "(480, 640, 4) of uint8"
    assert shown(list(range(5000))) == "5000 values"
    assert shown(b"abc") == "3 bytes"
    scan = np.zeros(541)
    assert shown(scan) is scan
    assert shown([1, 2]) == [1, 2]


# the viewpoint -------------------------------------------------------------------------------------------


def test_a_camera_that_follows_a_robot_sends_the_viewpoint_alone(page: Page) -> None:
    page.send("call_service", request=1, component="simulation", service="set_camarafp_position", arguments=[[1, 2, 3]])
    told = page.expect("viewpoint")
    assert told["location"] == [1.0, 2.0, 3.0]
    assert page.world_is_not_sent_again()
    files = len(page.view._server._hub.site.files)
    for i in range(50):
        page.send(
            "call_service", request=i + 2, component="simulation", service="set_camarafp_position",
            arguments=[[i, 0, 0]],
        )  # fmt: skip
    page.expect("answer", request=51)
    assert len(page.view._server._hub.site.files) == files


def test_the_page_knows_the_world_again_although_a_service_has_moved_its_camera(page: Page) -> None:
    keys = []
    for x in (0.0, 5.0):
        page.simulation.scene.settings.view.camera_location = (x, 0.0, 0.0)
        page.view._describe()
        page.simulation.tick()
        described = page.view._server._hub.site.files
        newest = max((path for path in described if path.startswith("/worlds/")), key=lambda p: int(p[8:-5]))
        keys.append(json.loads(described[newest].data)["key"])
    assert keys[0] == keys[1]
