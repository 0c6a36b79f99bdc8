"""Offers services over TCP."""

from __future__ import annotations

import contextlib
import logging
import os
import socket
import stat
from collections import deque
from typing import TYPE_CHECKING, Any

from morse.core.clients.budgets import TimeShare
from morse.core.clients.complaints import Complaints
from morse.core.exceptions import MorseError, MorseMiddlewareError, MorseRPCNbArgsError
from morse.core.request_manager import Outcome, RequestManager
from morse.core.status import SUCCESS
from morse.middleware.socket.service_client import (
    MalformedRequest,
    ServiceClient,
    format_failure,
    format_reply,
    parse_request,
)
from morse.middleware.socket.turns import Turns
from morse.system import OF_MACHINE, variables
from morse.wire.listener import listen, port_of
from morse.wire.server import LineServer

if TYPE_CHECKING:
    import uuid
    from collections.abc import Callable

    from morse.core.context import Context

    #: bytes, or a function that returns them when they are sent
    _Reply = bytes | Callable[[], bytes]

#: the environment variable with its path; without it there is none
PATH_VARIABLE = "MORSE_SOCKET_PATH"
#: read and write for the owner only
_MODE = 0o600


def wanted_path() -> str | None:
    """The path in the environment variable, or None."""
    return variables.text(PATH_VARIABLE) or None


def listen_locally(path: str) -> socket.socket:
    """Listen on a Unix socket that only its owner may use; a socket that an ended program has left is replaced.

    Raises:
        MorseMiddlewareError: another program listens there, the path is that of another file, or cannot be used.
    """
    if not hasattr(socket, "AF_UNIX"):
        raise MorseMiddlewareError(f"{PATH_VARIABLE}: this system has no Unix sockets")
    _remove_left_over(path)
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    # without the mask, others could connect before the mode is set
    mask = os.umask(0o777 & ~_MODE)
    try:
        listener.bind(path)
        os.chmod(path, _MODE)
        listener.listen()
        listener.setblocking(False)
    except OSError as error:
        listener.close()
        raise MorseMiddlewareError(f"{PATH_VARIABLE}: cannot listen on {path}: {error.strerror or error}") from None
    finally:
        os.umask(mask)
    return listener


def _remove_left_over(path: str) -> None:
    try:
        mode = os.lstat(path).st_mode
    except OSError:
        return
    if not stat.S_ISSOCK(mode):
        raise MorseMiddlewareError(f"{PATH_VARIABLE}: {path} exists and is no socket; set another path")
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as probe:
        probe.settimeout(1.0)
        try:
            probe.connect(path)
        except ConnectionRefusedError:
            with contextlib.suppress(OSError):
                os.unlink(path)
            return
        except OSError as error:
            raise MorseMiddlewareError(f"{PATH_VARIABLE}: {path} cannot be used: {error.strerror}") from None
    raise MorseMiddlewareError(f"{PATH_VARIABLE}: another simulation listens on {path}; set another path")


def remove(path: str) -> None:
    """Remove the file of a socket that nobody listens on any more."""
    with contextlib.suppress(OSError, MorseMiddlewareError):
        _remove_left_over(path)


#: maximum number of ids of a client that are stored
_REMEMBERED = 1024


class Calls:
    """The active asynchronous calls of all clients; every operation takes constant time."""

    def __init__(self) -> None:
        self._callers: dict[uuid.UUID, tuple[ServiceClient, str]] = {}
        self._of_request: dict[str, dict[uuid.UUID, None]] = {}
        self._of_client: dict[ServiceClient, dict[str, dict[uuid.UUID, None]]] = {}
        self._numbers: dict[ServiceClient, dict[str, None]] = {}

    def __len__(self) -> int:
        return len(self._callers)

    def issued(self, client: ServiceClient, request: str) -> None:
        """Note that a client has used that request id."""
        ids = self._numbers.setdefault(client, {})
        ids[request] = None
        if len(ids) > _REMEMBERED:
            del ids[next(iter(ids))]

    def add(self, call: uuid.UUID, client: ServiceClient, request: str) -> None:
        """Add an active call."""
        self._callers[call] = (client, request)
        self._of_request.setdefault(request, {})[call] = None
        self._of_client.setdefault(client, {}).setdefault(request, {})[call] = None
        client.calls += 1

    def remove(self, call: uuid.UUID) -> tuple[ServiceClient, str]:
        """Remove a call that has ended; returns its client and request id."""
        client, request = self._callers.pop(call)
        _remove(self._of_request, request, call)
        _remove(self._of_client[client], request, call)
        if not self._of_client[client]:
            del self._of_client[client]
        client.calls -= 1
        return client, request

    def find(self, client: ServiceClient, request: str) -> uuid.UUID | None:
        """The latest call with that id: of the client, or of another one if this client has never used the id."""
        own = self._of_client.get(client, {}).get(request)
        if own:
            return next(reversed(own))
        if request in self._numbers.get(client, ()):
            return None
        others = self._of_request.get(request)
        return next(reversed(others)) if others else None

    def forget(self, client: ServiceClient) -> list[uuid.UUID]:
        """Remove a client that has disconnected; returns its active calls."""
        self._numbers.pop(client, None)
        return [call for calls in self._of_client.get(client, {}).values() for call in calls]


def _remove(index: dict[str, dict[uuid.UUID, None]], request: str, call: uuid.UUID) -> None:
    calls = index[request]
    del calls[call]
    if not calls:
        del index[request]


logger = logging.getLogger(__name__)

PORT = 4000
_TRIES = 10
_PORT_VARIABLE = "MORSE_SOCKET_PORT"
#: limits of the requests that a tick takes from its clients; the rest waits for the next tick
_REQUESTS_PER_TICK = 512
_REPLIES_PER_TICK = 4 << 20
#: maximum number of active asynchronous calls of one client
_MAX_CALLS = 1024
#: the service whose reply can contain the number of messages sent to each client of a stream
_STEP = ("simulation", "step")
#: what a client is sent for whose connection there is no place
_NO_PLACE = format_failure("?", "The simulation has no place for one more connection: close others, or try again later")


class SocketRequestManager(RequestManager):
    """Services over TCP, one request per line (see `morse.middleware.socket.service_client`).

    Listens on the first free port from 4000 to 4009, or from the port in the environment
    variable ``MORSE_SOCKET_PORT`` (0: any free port). The environment variable ``MORSE_SOCKET_PATH`` adds a Unix socket
    with that path, for clients of the same user.

    Services get a share of the time of a tick. Requests beyond that share wait; the client that has used the least time
    is served next (see `Turns`). Calls that only concern the client, such as sleep and step, end when it disconnects.

    Attributes:
        port: the port on which it listens.
        waiting: not empty if requests have arrived, or clients have left.
    """

    classpath = "morse.middleware.socket_request_manager.SocketRequestManager"
    title = "Socket service manager"

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        self._context = context
        self._inbox: Turns[ServiceClient, bytes] = Turns()
        self._arriving: list[tuple[ServiceClient, bytes]] = []
        self.waiting: deque[bool] = deque(maxlen=1)
        self._left: deque[tuple[ServiceClient, bool]] = deque()
        self._outbox: list[tuple[ServiceClient, _Reply]] = []
        self._outbox_size = 0
        self._costs: dict[ServiceClient, tuple[int, int]] = {}
        self._calls = Calls()
        self._steps: set[uuid.UUID] = set()
        self._server: LineServer | None = None
        self._local: tuple[LineServer, str] | None = None
        self._complaints = Complaints(logger)
        self._share = TimeShare(context.time_shares)
        self.port = 0

    def initialization(self) -> bool:
        """Listen.

        Raises:
            MorseMiddlewareError: every port is in use, or the Unix socket cannot be made.
        """
        port = _wanted_port()
        ports = range(port, min(port + _TRIES, 65536)) if port else (0,)
        try:
            listener = listen(self._context.host, ports)
        except MorseMiddlewareError as error:
            raise MorseMiddlewareError(f"{error}; {_PORT_VARIABLE} sets the first port to try") from None
        self.port = port_of(listener)
        if port and self.port != port:
            logger.warning(
                "port %d is in use (by another simulation?): services are on port %d; connect with Morse(port=%d)",
                port,
                self.port,
                self.port,
                extra=OF_MACHINE,
            )
        else:
            logger.info("services are on port %d", self.port)
        self._server = LineServer("services", listener, self._welcome, refusal=_NO_PLACE)
        self._context.network.call(self._server.start(self._context.network))
        path = wanted_path()
        if path is not None:
            server = LineServer("local services", listen_locally(path), self._welcome, refusal=_NO_PLACE)
            self._local = (server, path)
            self._context.network.call(server.start(self._context.network))
            logger.info("services are on the Unix socket %s", path)
        return True

    def finalization(self) -> bool:
        """Send the remaining replies and close."""
        self.answer()
        if self._server is not None:
            self._context.network.call(self._server.close())
            self._server = None
        if self._local is not None:
            server, path = self._local
            self._context.network.call(server.close())
            remove(path)
            self._local = None
        return True

    def _welcome(self, server: LineServer) -> ServiceClient:
        return ServiceClient(server, self._arrived, self._has_left)

    def _arrived(self, client: ServiceClient, line: bytes) -> None:
        if not self._arriving:
            self._context.network.when_read(self._all_arrived)
        self._arriving.append((client, line))

    def _all_arrived(self) -> None:
        self._inbox.extend(self._arriving)
        self._arriving.clear()
        self.waiting.append(True)
        self._context.wake()

    def _has_left(self, client: ServiceClient, broken: bool) -> None:
        self._left.append((client, broken))
        self.waiting.append(True)
        self._context.wake()

    def answer(self) -> None:
        """Send the outcomes of ended calls: all replies at once to the network thread."""
        if self._arrivals:
            super().answer()
        if self._costs or self._outbox:
            self._hand_over()

    def main(self) -> None:
        """Process the received requests within the time share of a tick."""
        self.waiting.clear()
        if self._inbox:
            self._serve()
        while self._left:
            self._forget(*self._left.popleft())
        if self._inbox:
            self.waiting.append(True)

    def _serve(self) -> None:
        share = self._share
        if not share.begin():
            return
        for _ in range(_REQUESTS_PER_TICK):
            request = self._inbox.next()
            if request is None:
                break
            client, line = request
            count, size = self._costs.get(client, (0, 0))
            self._costs[client] = (count + 1, size + len(line))
            self._handle(client, line)
            self._inbox.served(client, share.spend())
            if share.is_used() or self._outbox_size > _REPLIES_PER_TICK:
                break
        if self._inbox and not share.is_owing:
            self._context.wake()

    def _forget(self, client: ServiceClient, broken: bool) -> None:
        self._inbox.forget(client, with_requests=broken)
        self._costs.pop(client, None)
        for call in self._calls.forget(client):
            self.abandon(call)

    def on_service_completion(self, request_id: uuid.UUID, result: Outcome) -> None:
        """Send the result of an asynchronous call to the client that made it."""
        client, request = self._calls.remove(request_id)
        if request_id in self._steps:
            # the number of sent messages is known when the reply is sent: after all earlier messages
            self._steps.discard(request_id)
            self._answer(client, lambda: self._step_reply(request, *result))
        else:
            self._answer(client, format_reply(request, *result))

    def _answer(self, client: ServiceClient, reply: _Reply) -> None:
        self._outbox.append((client, reply))
        if isinstance(reply, bytes):
            self._outbox_size += len(reply)

    def _step_reply(self, request: str, state: str, result: Any) -> bytes:
        if state == SUCCESS:
            result = {}
            for manager in self._context.stream_managers.values():
                result.update(manager.sent())
        return format_reply(request, state, result)

    def _handle(self, client: ServiceClient, line: bytes) -> None:
        try:
            request = parse_request(line)
        except MalformedRequest as error:
            self._answer(client, format_failure(error.request, str(error)))
            return
        if request is None:
            return
        if request.service is None:
            self._cancel(client, request.id)
            return
        self._calls.issued(client, request.id)
        if client.calls >= _MAX_CALLS:
            text = f"{_MAX_CALLS} calls of this client are active: cancel some, or wait until they end"
            self._answer(client, format_failure(request.id, text))
            return
        try:
            is_complete, outcome = self.on_incoming_request(request.component, request.service, request.arguments)
        except MorseRPCNbArgsError as error:
            self._answer(client, format_failure(request.id, f"{self.title}: {error}"))
        except MorseError as error:
            self._answer(client, format_failure(request.id, str(error)))
        except Exception as error:
            name = f"the service {request.service} of {request.component}"
            self._answer(client, format_failure(request.id, self._complaints.service_failed(name, error)))
        else:
            if is_complete:
                self._answer(client, format_reply(request.id, *outcome))
            else:
                self._calls.add(outcome, client, request.id)
                if (request.component, request.service) == _STEP and request.arguments[1:] == [True]:
                    self._steps.add(outcome)

    def _cancel(self, client: ServiceClient, request: str) -> None:
        call = self._calls.find(client, request)
        if call is not None:
            self.abort_request(call)

    def _hand_over(self) -> None:
        self._context.network.post(self._deliver, self._outbox, self._costs)
        self._outbox = []
        self._outbox_size = 0
        self._costs = {}

    def _deliver(
        self, replies: list[tuple[ServiceClient, _Reply]], costs: dict[ServiceClient, tuple[int, int]]
    ) -> None:
        if replies:
            for manager in self._context.stream_managers.values():
                manager.push()
        by_client: dict[ServiceClient, list[bytes]] = {}
        for client, reply in replies:
            by_client.setdefault(client, []).append(reply if isinstance(reply, bytes) else reply())
        for client, parts in by_client.items():
            client.reply(b"".join(parts))
        for client, (count, size) in costs.items():
            client.consumed(count, size)


def _wanted_port() -> int:
    text = os.environ.get(_PORT_VARIABLE)
    try:
        return PORT if text is None else variables.checked_whole(_PORT_VARIABLE, text.strip())
    except ValueError as error:
        raise MorseMiddlewareError(str(error)) from None
