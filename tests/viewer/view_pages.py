"""Pages on plain sockets."""

from __future__ import annotations

import contextlib
import json
import socket
import struct
import time
import urllib.error
import urllib.request
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from websockets.client import ClientProtocol
from websockets.sync.client import connect
from websockets.uri import parse_uri

from morse.viewer.protocol import VERSION
from morse.viewer.snapshot import HEADER, POSES

if TYPE_CHECKING:
    from playwright.sync_api import Page


def toasts(page: Page, kind: str = "toast") -> list[str]:
    """The short messages that a page has shown so far, also those that have vanished."""
    told = page.evaluate("toasts")
    return [toast["text"] for toast in told if kind in toast["kind"].split()]


class Client:
    """A page on a plain socket."""

    def __init__(
        self, url: str, *, version: int = VERSION, hello: bool = True, query: str = "", **options: Any
    ) -> None:
        self.url = url
        self._stack = contextlib.ExitStack()
        address = url.replace("http", "ws") + "ws" + (f"?{query}" if query else "")
        # without pings, and with room for all messages: a test that reads late loses no connection
        patient: Any = {"max_size": None, "max_queue": None, "ping_interval": None, **options}
        self.socket = self._stack.enter_context(connect(address, **patient))
        self.messages: list[dict[str, Any]] = []
        self.poses: list[tuple[Any, ...]] = []
        if hello:
            self.send("hello", version=version)

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def send(self, kind: str, **fields: Any) -> None:
        """Send a message."""
        self.socket.send(json.dumps({"type": kind, **fields}))

    def receive(self, timeout: float = 60.0) -> None:
        """Receive one frame."""
        frame = self.socket.recv(timeout=timeout)
        if isinstance(frame, str):
            self.messages.append(json.loads(frame))
        elif struct.unpack_from("<I", frame)[0] == POSES:
            self.poses.append((*HEADER.unpack_from(frame), frame[HEADER.size :]))
        else:
            length = struct.unpack_from("<I", frame, 4)[0]
            self.messages.append({**json.loads(frame[8 : 8 + length]), "payload": frame[8 + length :]})

    def expect(self, kind: str, **fields: Any) -> dict[str, Any]:
        """Wait for a message, and discard those before it."""
        end = time.monotonic() + 60.0
        while time.monotonic() < end:
            while self.messages:
                message = self.messages.pop(0)
                if message["type"] == kind and all(message[name] == value for name, value in fields.items()):
                    return message
            self.receive()
        raise AssertionError(f"no {kind} with {fields}")


class DeadPage:
    """A page that sends hello and never reads."""

    def __init__(self, url: str) -> None:
        protocol = ClientProtocol(parse_uri(url.replace("http", "ws") + "ws"))
        self._socket = socket.create_connection(("127.0.0.1", port_of(url)))
        protocol.send_request(protocol.connect())
        self._socket.sendall(b"".join(protocol.data_to_send()))
        protocol.receive_data(self._socket.recv(4096))
        protocol.send_text(json.dumps({"type": "hello", "version": VERSION}).encode())
        self._socket.sendall(b"".join(protocol.data_to_send()))

    def __enter__(self) -> DeadPage:
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()


def port_of(url: str) -> int:
    """The port in an address."""
    port = urlsplit(url).port
    assert port is not None
    return port


def fetch(url: str, headers: dict[str, str] | None = None) -> tuple[int, dict[str, str], bytes]:
    """Status, headers and body of a plain HTTP request."""
    request = urllib.request.Request(url, headers=headers or {})
    try:
        with urllib.request.build_opener(urllib.request.ProxyHandler({})).open(request, timeout=60) as answer:
            return answer.status, dict(answer.headers), answer.read()
    except urllib.error.HTTPError as error:
        return error.code, dict(error.headers), error.read()
