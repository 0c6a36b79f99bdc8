"""Pages that are turned away keep no place, whether they leave at once or stay."""

import json
import socket
from collections.abc import Iterator

import pytest
from limited import connect

from morse.core.clients.network import Network
from morse.viewer.protocol import VERSION
from morse.viewer.server import ViewServer
from tests.kit.waiting import wait_until


class View:
    """A live view without a simulation."""

    def __init__(self) -> None:
        self.network = Network()
        self.server = ViewServer(self.network, port=0)
        self.port = int(self.server.start().split(":")[2].split("/")[0])
        self.hub = self.server._hub

    def page(self, *messages: object) -> socket.socket:
        """The connection of a page that has sent messages."""
        sock = connect(self.port)
        lines = [f"GET /ws HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"]
        lines.append("Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n")
        sock.sendall("".join(lines).encode() + b"".join(map(_frame, messages)))
        return sock


def _frame(message: object) -> bytes:
    data = json.dumps(message).encode()
    return bytes((0x81, 0x80 | len(data), 0, 0, 0, 0)) + data


HELLO, NONSENSE, ALIVE = {"type": "hello", "version": VERSION}, {"type": "nonsense"}, {"type": "alive"}


@pytest.fixture
def view() -> Iterator[View]:
    made = View()
    yield made
    made.server.stop()
    made.network.stop()


@pytest.mark.parametrize("last", [NONSENSE, HELLO, [1, 2]])
def test_pages_that_leave_after_a_wrong_message_are_forgotten(view: View, last: object) -> None:
    """What such a page sends afterwards is read by nobody, and hid for minutes that the page has left."""
    for _ in range(5):
        with view.page(HELLO, last, *[ALIVE] * 200) as sock:
            sock.recv(1 << 16)
            sock.shutdown(socket.SHUT_WR)
    wait_until(lambda: not view.hub._acceptor.connections)
    assert not view.hub._pages


def test_pages_that_stay_after_a_wrong_message_give_way(view: View) -> None:
    with view.page(HELLO, NONSENSE):
        wait_until(lambda: view.hub._numbers == 1 and not view.hub._pages)
        (place,) = view.hub._acceptor.connections
        wait_until(lambda: not place.keeps_place)
