"""A replacement for a simulation: answers service calls from a script, records every received byte."""

from __future__ import annotations

import contextlib
import json
import socket
import threading
from collections.abc import Callable
from typing import Any

REQUEST_MANAGER = "morse.middleware.socket_request_manager.SocketRequestManager"
STREAM_MANAGER = "morse.middleware.socket_datastream.SocketDatastreamManager"


class Endpoint:
    """A TCP server on a free port that records lines and can send to all clients."""

    def __init__(self, on_line: Callable[[socket.socket, bytes], None] | None = None) -> None:
        self.lines: list[bytes] = []
        self.connections: list[socket.socket] = []
        self.accepted = 0
        self.finished = 0
        self._on_line = on_line
        self._server = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._server.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self) -> None:
        while True:
            try:
                connection, _ = self._server.accept()
            except OSError:
                return
            self.connections.append(connection)
            self.accepted += 1
            threading.Thread(target=self._read, args=(connection,), daemon=True).start()

    def _read(self, connection: socket.socket) -> None:
        with contextlib.suppress(OSError), connection.makefile("rb") as received:
            for line in received:
                if line.endswith(b"\n"):
                    self.lines.append(line)
                    if self._on_line is not None:
                        self._on_line(connection, line)
        self.finished += 1

    def send(self, data: bytes) -> None:
        for connection in self.connections:
            connection.sendall(data)

    def drop(self) -> None:
        """Close every connection."""
        for connection in self.connections:
            with contextlib.suppress(OSError):
                connection.shutdown(socket.SHUT_RDWR)
            connection.close()
        self.connections.clear()

    def close(self) -> None:
        with contextlib.suppress(OSError):
            self._server.shutdown(socket.SHUT_RDWR)
        self._server.close()
        self.drop()


class ScriptedSimulation:
    """Answers ``component service`` from ``replies``: text after the id, a function of the request, or None.

    A component is ``name: (services, direction)`` with direction ``IN``, ``OUT`` or None.
    """

    def __init__(
        self,
        robots: dict[str, dict[str, tuple[list[str], str | None]]],
        replies: dict[str, Any] | None = None,
        robot_services: dict[str, list[str]] | None = None,
    ) -> None:
        self.replies = {"simulation list_robots": "SUCCESS " + json.dumps(list(robots)), **(replies or {})}
        self.streams: dict[str, Endpoint] = {}
        described = []
        for robot, components in robots.items():
            entry: dict[str, Any] = {"name": robot, "type": "ATRV", "components": {}}
            for name, (services, direction) in components.items():
                entry["components"][name] = {
                    "type": "Pose",
                    "services": services,
                    "service_interfaces": [REQUEST_MANAGER],
                    "stream_interfaces": [[STREAM_MANAGER, direction]] if direction else [],
                }
                if direction:
                    self.streams[name] = Endpoint()
            if robot_services and robot in robot_services:
                entry["services"] = robot_services[robot]
                entry["services_interfaces"] = [REQUEST_MANAGER]
            described.append(entry)
        self.details = {"robots": described, "environment": "indoors-1/indoor-1"}
        self.rpc = Endpoint(self._answer)
        self.port = self.rpc.port

    def _answer(self, connection: socket.socket, line: bytes) -> None:
        request, _, rest = line.decode().strip().partition(" ")
        component, _, rest = rest.partition(" ")
        service, _, arguments = rest.partition(" ")
        if component == "simulation" and service == "details" and "simulation details" not in self.replies:
            reply: Any = "SUCCESS " + json.dumps(self.details)
        elif component == "simulation" and service == "get_stream_port":
            (name,) = json.loads(arguments)
            known = self.streams.get(name)
            reply = f"SUCCESS {known.port}" if known else f'FAILED "Stream unavailable for component {name}"'
        else:
            default = f'FAILED "The request {service} has not been registered in Socket service manager"'
            reply = self.replies.get(f"{component} {service}".strip(), None if component == "cancel" else default)
        if callable(reply):
            reply = reply(request, arguments)
        if reply is not None:
            connection.sendall(f"{request} {reply}\n".encode())

    def close(self) -> None:
        self.rpc.close()
        for stream in self.streams.values():
            stream.close()

    def __enter__(self) -> ScriptedSimulation:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
