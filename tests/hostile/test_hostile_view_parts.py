"""A feed, a request or a page of the live view that fails is dropped and named; the server and the others stay."""

import logging
import socket
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from test_hostile_pages import ALIVE, HELLO, _frame
from test_hostile_pages import View as Server

import morse
from morse.builder import ATRV, Environment, FakeRobot
from morse.core.declarations import properties
from morse.simulation.simulation import Simulation
from morse.viewer import live_view, page_messages
from morse.viewer.catalog import Catalog
from morse.viewer.hub import Hub, Wishes
from morse.viewer.live_view import View
from morse.viewer.page import MOST_WAITING, Page
from morse.viewer.page_messages import ViewEvent
from morse.viewer.protocol import page_message_types
from morse.viewer.view_messages import Answer, Models, PropertyValue, Refused
from tests.kit.waiting import wait_until


def _scene() -> None:
    ATRV("robot")
    FakeRobot("other").translate(5.0, 0.0, 0.0)
    Environment("empty", fastmode=True)


class Desk:
    """A simulation with a live view that believes that a page watches, and what it sends."""

    def __init__(self, simulation: Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
        self.simulation = simulation
        view = simulation.view
        assert isinstance(view, View)
        self.view = view
        self.sent: list[Any] = []
        self.events = view._server._hub.events
        server = view._server
        monkeypatch.setattr(server._hub, "_pages", {1: SimpleNamespace(drawn=True, show=lambda _: False)})
        monkeypatch.setattr(server, "send", self.sent.append)

    def ask(self, *events: ViewEvent) -> None:
        """Send requests, and run until all of them were read."""
        self.events += events
        self.simulation.step()
        wait_until(lambda: self.simulation.step() or not self.events)

    def lives(self) -> bool:
        """Whether the view is an observer, and answers."""
        self.sent.clear()
        self.ask(page_messages.Command(99, "nobody", {}))
        answers = [one for one in self.sent if isinstance(one, Answer)]
        return self.view in self.simulation.observers and [one.request for one in answers] == [99]

    def refusals(self) -> list[str]:
        """The texts that the pages show."""
        return [one.why for one in self.sent if isinstance(one, Refused)]


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch) -> Iterator[Desk]:
    monkeypatch.setattr(live_view, "_VALUES_INTERVAL", 0.0)
    monkeypatch.setattr(live_view, "_SNAPSHOT_INTERVAL", 0.0)
    monkeypatch.setattr(live_view, "_UNPACED_INTERVAL", 0.0)
    with morse.load(_scene, view="web") as simulation:
        yield Desk(simulation, monkeypatch)


def _fail(*_: object, **__: object) -> None:
    raise RuntimeError("a part that fails \x1b]0;title\x07")


REQUESTS = [kind for kind in page_message_types() if issubclass(kind, ViewEvent)]


def _example(kind: type[ViewEvent]) -> ViewEvent:
    values = {
        "request": 7,
        "time": 0.0,
        "factor": 1.0,
        "robot": None,
        "to": 1,
        "fields": {},
        "value": 1,
        "active": True,
    }
    values |= {
        "component": "x",
        "name": "x",
        "service": "x",
        "node": "x",
        "model": "x",
        "write": False,
        "count": 1,
        "method": "x",
        "files": [("x.obj", 1)],
        "upload": 1,
        "file": 0,
        "data": "",
        "factors": (1.0, 1.0, 1.0),
        "text": "x",
        "version": "x",
    }
    values |= {"position": (0, 0, 0), "quaternion": (1, 0, 0, 0), "anchor": (0, 0, 0), "target": (0, 0, 0)}
    fields = kind.__struct_fields__
    return kind(**{name: values[name] for name in fields if name in values})


@pytest.mark.parametrize("kind", [kind for kind in REQUESTS if kind is not page_messages.PlayBackward])
def test_a_request_that_fails_is_answered_and_the_view_stays(
    desk: Desk, kind: type[ViewEvent], caplog: pytest.LogCaptureFixture
) -> None:
    event = _example(kind)
    desk.view._handlers[kind] = _fail
    desk.ask(event, event)
    told = [one for one in desk.sent if isinstance(one, (Answer, Refused))]
    assert len(told) == 2
    for one in told:
        text = one.error if isinstance(one, Answer) else one.why
        assert "a part that fails" in text
        assert text.isprintable()
    lines = [record.getMessage() for record in caplog.records if "has failed" in record.getMessage()]
    assert len(lines) == 1, "repeated mistakes of a page do not fill the log"
    assert f"the request {kind.__struct_config__.tag} " in lines[0]
    assert desk.lives()


FEEDS = ["_states", "_rays", "_clouds", "_frustums", "_sounds", "_editor", "_pictures", "_services", "_log"]


@pytest.mark.parametrize("name", FEEDS)
def test_a_feed_that_fails_is_dropped_and_named(desk: Desk, name: str, caplog: pytest.LogCaptureFixture) -> None:
    part = getattr(desk.view, name)
    part.update = _fail
    desk.simulation.step(3)
    assert len([one for one in desk.refusals() if type(part).__name__ in one]) == 1
    logged = [
        r.getMessage() for r in caplog.records if f"the part {type(part).__name__} of the live view" in r.getMessage()
    ]
    assert len(logged) == 1
    assert "is switched off" in logged[0]
    assert desk.lives()


@pytest.mark.parametrize("name", ["_states", "_commands", "_rays", "_clouds", "_frustums", "_sounds", "_history"])
def test_a_part_that_fails_at_a_restart_is_dropped(desk: Desk, name: str) -> None:
    getattr(desk.view, name).restarted = _fail
    desk.ask(page_messages.Reset())
    desk.simulation.step(2)
    assert desk.lives()


def test_a_world_that_cannot_be_shown_is_tried_again(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live_view, "_WORLD_INTERVAL", 0.0)
    described = desk.view._server.set_scene
    monkeypatch.setattr(desk.view._server, "set_scene", _fail)
    desk.simulation.spawn("crate", "props/crates", (3.0, 0.0, 1.0))
    desk.simulation.step(2)
    assert any("cannot be shown at present" in text for text in desk.refusals())
    monkeypatch.setattr(desk.view._server, "set_scene", described)
    desk.simulation.step(2)
    assert desk.view._layout == desk.simulation.world.layout
    assert desk.lives()


def _move(name: str) -> page_messages.Teleport:
    return page_messages.Teleport(1, name, (8.0, 1.0, 0.5), (1.0, 0.0, 0.0, 0.0))


@pytest.mark.parametrize("change", [_move("guest"), page_messages.DeleteObject(1, "guest")], ids=["moved", "deleted"])
def test_what_a_client_has_spawned_is_changed_then_the_run_restarts(desk: Desk, change: ViewEvent) -> None:
    desk.simulation.spawn("guest", "props/crates", (3.0, 0.0, 1.0))
    desk.ask(change)
    assert all(one.ok for one in desk.sent if isinstance(one, Answer))
    desk.ask(page_messages.Reset())
    desk.simulation.step(2)
    assert desk.refusals() == []
    assert desk.lives()


def test_changes_that_cannot_be_made_again_are_named_and_the_others_are_made(desk: Desk) -> None:
    editor = desk.view._editor
    editor._catalog.groups = {"Morsy": "robots"}
    desk.ask(page_messages.AddModel(1, "Morsy", (9.0, 9.0, 0.0)), page_messages.AddModel(2, "Morsy", (9.0, 19.0, 0.0)))
    desk.ask(_move("robot"), _move("other"))
    # the class of the one was removed by an edit of the project, the other object by an edit of a model
    editor._additions["morsy"] = replace(editor._additions["morsy"], kind="NoSuchRobot")
    editor._moves["nobody"] = replace(editor._moves["robot"], name="nobody")
    editor._deletions["nobody either"] = []
    desk.sent.clear()
    desk.ask(page_messages.Reset())
    desk.simulation.step(2)
    assert sorted(text.partition(" again")[0] for text in desk.refusals()) == [
        "morsy is not added",
        "nobody either is not deleted",
        "nobody is not moved",
    ]
    assert "morsy_2" in desk.simulation.context.robots
    assert desk.simulation.world.objects_by_name["other"].position[0] == pytest.approx(8.0, abs=0.01)
    assert desk.lives()


def test_the_changes_of_a_page_are_limited(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("morse.viewer.editor._MOST_CHANGES", 3)
    editor = desk.view._editor
    editor._catalog.groups = {"Pose": "sensors"}
    desk.ask(*[page_messages.AddModel(i, "Pose", (0.0, 0.0, 1.0), robot="robot") for i in range(1, 6)])
    assert [one.ok for one in desk.sent if isinstance(one, Answer)] == [True] * 3 + [False] * 2
    for _ in range(10):
        desk.ask(_move("robot"), _move("other"))
    assert len(editor._moves) == 0
    assert len(editor._undos) == 3
    assert desk.lives()


def test_an_object_of_a_client_leaves_with_the_run_and_its_deletion_is_undone(desk: Desk) -> None:
    desk.simulation.spawn("guest", "ATRV", (3.0, 0.0, 0.2))
    desk.ask(page_messages.DeleteObject(1, "guest"))
    assert "guest" not in desk.simulation.context.robots
    assert not desk.view._editor._deletions, "it is not in the script"
    desk.ask(page_messages.UndoChange(2))
    assert "guest" in desk.simulation.context.robots
    desk.ask(page_messages.Reset())
    assert "guest" not in desk.simulation.context.robots


def _project(folder: Path, text: str) -> Path:
    for name in ("my_sim", "my_sim/builder", "my_sim/builder/robots"):
        (folder / name).mkdir(parents=True)
        (folder / name / "__init__.py").write_text("")
    (folder / "my_sim/builder/robots/__init__.py").write_text(text)
    return folder


NOISE = """
import os, subprocess, sys
print('{"kind": "a", "picture": "AAAA"}')
print([1, 2, 3], flush=True)
sys.stdout.write("no line")
sys.__stdout__.write("\\x1b]52;c;aGk=\\x07 escape\\n")
os.write(1, b"\\xff\\xfe raw\\n")
subprocess.run([sys.executable, "-c", "print('a child')"])
from morse.builder import *
class MyRobot(ATRV):
    pass
"""


def _messages(catalog: Catalog, sent: list[Any], kind: Callable[[Any], bool]) -> list[Any]:
    wait_until(lambda: catalog.update() or any(map(kind, sent)))
    return [one for one in sent if kind(one)]


def test_what_a_project_prints_is_no_message(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO)
    sent: list[Any] = []
    server: Any = SimpleNamespace(send=sent.append, offer=lambda *_: "/url")
    catalog = Catalog(server, [], [str(_project(tmp_path, NOISE))])
    try:
        catalog.open()
        (models, *_) = _messages(catalog, sent, lambda one: isinstance(one, Models))
        assert "my_sim.builder.robots:MyRobot" in {model.kind for model in models.models}
        wait_until(lambda: "a child" in caplog.text)
    finally:
        catalog.close()
    assert "raw" in caplog.text
    assert all(line.isprintable() for line in caplog.text.splitlines())


@pytest.mark.parametrize("text", ["raise RuntimeError('my mistake')", "import os; os._exit(3)", "syntax error"])
def test_a_project_that_ends_the_list_is_named(tmp_path: Path, text: str) -> None:
    sent: list[Any] = []
    server: Any = SimpleNamespace(send=sent.append, offer=lambda *_: "/url")
    catalog = Catalog(server, [], [str(_project(tmp_path, text))])
    try:
        catalog.open()
        kinds = (Models, Refused)
        (answer, *_) = _messages(catalog, sent, lambda one: isinstance(one, kinds))
    finally:
        catalog.close()
    assert isinstance(answer, Models) or "its process has failed" in answer.why


def test_a_page_that_the_server_cannot_process_is_named_and_others_stay(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    server = Server()
    try:
        good = server.page(HELLO)
        wait_until(lambda: server.hub._numbers == 1)
        monkeypatch.setattr(server.hub, "_receive", _fail)
        with server.page(HELLO, ALIVE):
            wait_until(lambda: "page 2 is disconnected" in caplog.text)
        wait_until(lambda: list(server.hub._pages) == [1])
        monkeypatch.undo()
        with server.page(HELLO):
            wait_until(lambda: len(server.hub._pages) == 2)
        good.close()
    finally:
        server.server.stop()
        server.network.stop()


def _is_forgotten(hub: Hub, name: str) -> bool:
    return not any(name in subject for subject in list(hub._lasting))


def test_pages_hear_nothing_of_robots_that_clients_have_deleted(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    """Messages about each robot that ever was were kept, and no page could connect after some hundred of them."""
    hub = desk.view._server._hub
    kept = []
    monkeypatch.setattr(desk.view._server, "send", type(desk.view._server).send.__get__(desk.view._server))
    hub._pages.clear()
    page = SimpleNamespace(drawn=True, show=lambda _: False, tell=lambda *_: None, hopeless=False)
    for number in range(6):
        name = f"guest{number}"
        desk.simulation.spawn(name, "ATRV", (3.0, 0.0, 0.2))
        hub._pages[1] = page  # type: ignore[assignment]
        hub.wishes = Wishes(values=frozenset((name, "robot")), overlays=frozenset((name,)))
        desk.simulation.step(3)
        desk.simulation.context.robots[name].active = False
        desk.simulation.step(3)
        wait_until(partial(hub._lasting.__contains__, ("Activity", name)))
        desk.simulation.delete(name)
        desk.simulation.step(2)
        wait_until(partial(_is_forgotten, hub, name))
        kept.append(len(hub._lasting))
    hub._pages.clear()
    assert kept == [kept[0]] * 6
    assert any(subject[1:2] == ("robot",) for subject in hub._lasting)


def test_a_page_begins_with_any_number_of_messages() -> None:
    """A scene with many components has thousands: each page was disconnected as too slow."""
    page = Page(1, SimpleNamespace())  # type: ignore[arg-type]
    page.begin({("PropertyValue", "robot", str(number)): "{}" for number in range(3 * MOST_WAITING)})
    assert not page.hopeless
    for _ in range(MOST_WAITING):
        page.tell(None, "{}")
    assert not page.hopeless
    page.tell(None, "{}")
    assert page.hopeless


def test_a_page_that_watches_many_properties_gets_them_in_parts(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("morse.viewer.feeds.components._MOST_TOLD", 1)
    robot = desk.simulation.context.robots["robot"]
    count = len(properties(type(robot))) * 2
    desk.view._server._hub.wishes = Wishes(values=frozenset(("robot", "other")))
    told: list[PropertyValue] = []
    for _ in range(count):
        desk.sent.clear()
        desk.simulation.step()
        told += (new := [one for one in desk.sent if isinstance(one, PropertyValue)])
        assert len({one.component for one in new}) <= 1
    assert {one.component for one in told} == {"robot", "other"}


def _answer(page: socket.socket) -> bool:
    """Whether a page is welcome; otherwise it is told why not."""
    data = b""
    while not (b'"welcome"' in data or b"pages already" in data):
        part = page.recv(1 << 16)
        assert part, data
        data += part
    return b'"welcome"' in data


def test_pages_that_say_hello_together_are_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("morse.viewer.hub.MOST_PAGES", 3)
    server = Server()
    try:
        pages = [server.page() for _ in range(8)]  # all are let in, because none has said hello
        wait_until(lambda: len(server.hub._acceptor.connections) == 8)
        for page in pages:
            page.sendall(_frame(HELLO))
        answers = [_answer(page) for page in pages]
        assert answers.count(True) == len(server.hub._pages) == 3
        for page in pages:
            page.close()
    finally:
        server.server.stop()
        server.network.stop()
