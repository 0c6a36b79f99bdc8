"""Clients that fetch files of the live view and do not read them take no memory."""

import logging
import socket
from collections.abc import Iterator
from contextlib import ExitStack
from types import SimpleNamespace
from typing import Any

import hostile_objects as objects
import pytest
from limited import connect, reset

import morse
from morse.builder import Environment, FakeRobot, Pose
from morse.core.clients.network import Network
from morse.core.state import StateError
from morse.viewer.feeds.components import ValuesFeed
from morse.viewer.page_inputs import Rewinder
from morse.viewer.server import ViewServer
from tests.kit.waiting import wait_until

CONTENT = bytes(range(256)) * (8 << 12)
#: bytes of a file that the simulation may hold for one client; the system holds more
MOST = 1 << 18


class Files:
    """A live view with one file."""

    def __init__(self) -> None:
        self.network = Network()
        self.view = ViewServer(self.network, port=0)
        self.port = int(self.view.start().split(":")[2].split("/")[0])
        self.url = self.view.offer("files", "image/png", CONTENT)

    def ask(self) -> socket.socket:
        sock = connect(self.port)
        sock.sendall(f"GET {self.url} HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\n\r\n".encode())
        return sock

    def unsent(self) -> list[int]:
        """The bytes that the transport of each connection holds."""

        async def sizes() -> list[int]:
            places = self.view._hub._acceptor.connections
            return [place._transport.get_write_buffer_size() for place in places if place._transport is not None]

        sizes_now: list[int] = self.network.call(sizes())
        return sizes_now


@pytest.fixture
def files() -> Iterator[Files]:
    made = Files()
    yield made
    made.view.stop()
    made.network.stop()


def read(sock: socket.socket) -> bytes:
    """The body of a response."""
    data = bytearray()
    while part := sock.recv(1 << 20):
        data += part
    return bytes(data).partition(b"\r\n\r\n")[2]


def test_files_that_clients_do_not_read_take_no_memory(files: Files) -> None:
    with ExitStack() as stack:
        for _ in range(30):
            stack.enter_context(files.ask())
        wait_until(lambda: sum(size > 0 for size in files.unsent()) == 30)
        assert max(files.unsent()) <= MOST
        assert read(stack.enter_context(files.ask())) == CONTENT


def test_a_slow_client_gets_the_whole_file(files: Files) -> None:
    with files.ask() as slow:
        wait_until(lambda: any(files.unsent()))
        assert read(slow) == CONTENT


def test_a_client_that_ends_its_side_gets_the_whole_file(files: Files) -> None:
    with files.ask() as sock:
        wait_until(lambda: any(files.unsent()))
        sock.shutdown(socket.SHUT_WR)
        assert read(sock) == CONTENT
    wait_until(lambda: not files.unsent())


def test_clients_that_leave_in_the_middle_of_a_file_are_forgotten(files: Files) -> None:
    leaving = [files.ask() for _ in range(10)]
    wait_until(lambda: sum(size > 0 for size in files.unsent()) == 10)
    for sock in leaving:
        reset(sock)
    wait_until(lambda: not files.unsent())


# -- components whose data or state cannot be read do not end the live view, which shows all others

BAD_DATA = {
    "nothing": lambda: None,
    "a list": lambda: [1.0],
    "an object without attributes": objects.Mute,
    "a field without attributes": lambda: {"a": objects.Mute()},
    "a disguised field": lambda: {"a": objects.Disguised()},
    "items that cannot be read": objects.Unordered,
}


def _scene() -> None:
    robot = FakeRobot("robot")
    robot.append(Pose("bad"))
    robot.append(Pose("good"))
    Environment("empty", fastmode=True)


@pytest.mark.parametrize("data", BAD_DATA)
def test_data_that_cannot_be_read_are_not_shown_and_others_are(data: str) -> None:
    sent: list[Any] = []
    server: Any = SimpleNamespace(wishes=SimpleNamespace(values={"robot.bad", "robot.good"}), send=sent.append)
    with morse.load(_scene) as simulation:
        simulation.step()
        simulation.context.components["robot.bad"].local_data = BAD_DATA[data]()
        ValuesFeed(simulation.context, server).update()
        bad, good = sent
        assert bad.component == "robot.bad"
        assert good.data == dict(simulation.robot.good.data)


def test_a_state_that_cannot_be_saved_is_named_once(caplog: pytest.LogCaptureFixture) -> None:
    def save() -> Any:
        raise StateError("robot.bad cannot be saved")

    seconds = iter(range(100))
    server: Any = SimpleNamespace(send=lambda _: None)
    rewinder = Rewinder(SimpleNamespace(save=save), lambda: float(next(seconds)), server)  # type: ignore[arg-type]
    with caplog.at_level(logging.WARNING):
        for paused in (False, True, False, True):
            rewinder.keep(paused=paused)
        rewinder.rewind(0.0)
        rewinder.step_back()
    assert [r.getMessage() for r in caplog.records if "robot.bad cannot be saved" in r.getMessage()]
    assert len(caplog.records) == 1
