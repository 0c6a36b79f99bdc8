"""Offers services over TCP."""

from __future__ import annotations

import logging
import os
import traceback
from collections import deque
from typing import TYPE_CHECKING, Any

from morse.core.exceptions import MorseError, MorseMiddlewareError, MorseRPCNbArgsError
from morse.core.request_manager import Outcome, RequestManager
from morse.core.status import SUCCESS
from morse.middleware.socket.lines import LineServer
from morse.middleware.socket.listener import listen, port_of
from morse.middleware.socket.protocol import MalformedRequest, Request, format_failure, format_reply, parse_request
from morse.middleware.socket.service_client import ServiceClient

if TYPE_CHECKING:
    import uuid
    from collections.abc import Callable

    from morse.core.context import Context

    #: bytes, or what gives them when they are sent
    _Reply = bytes | Callable[[], bytes]

logger = logging.getLogger("morse." + __name__)

PORT = 4000
_TRIES = 10
_PORT_VARIABLE = "MORSE_SOCKET_PORT"
#: a tick takes no more than this from its clients; the rest waits for the next one
_REQUESTS_PER_TICK = 512
_REMEMBERED = 1024
#: the service whose reply says, if asked, how many messages each client of a stream has been sent; who knows that
_STEP = ("simulation", "step")
_STREAMS = "morse.middleware.socket_datastream.SocketDatastreamManager"


class SocketRequestManager(RequestManager):
    """Services over TCP, one request a line (see `morse.middleware.socket.protocol`).

    Listens on the first free port from 4000 to 4009, or from the number in the environment
    variable ``MORSE_SOCKET_PORT`` on (0: any free port).

    Attributes:
        port: where it listens.
    """

    classpath = "morse.middleware.socket_request_manager.SocketRequestManager"
    title = "Socket service manager"

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        self._context = context
        self._inbox: deque[tuple[ServiceClient, bytes]] = deque()
        self._arriving: list[tuple[ServiceClient, bytes]] = []
        self._outbox: list[tuple[ServiceClient, _Reply]] = []
        self._consumed: dict[ServiceClient, int] = {}
        self._calls: dict[uuid.UUID, tuple[ServiceClient, str]] = {}
        self._steps: set[uuid.UUID] = set()
        self._issued: dict[tuple[ServiceClient, str], None] = {}
        self._server: LineServer | None = None
        self.port = 0

    def initialization(self) -> bool:
        """Listen.

        Raises:
            MorseMiddlewareError: every port is in use.
        """
        wanted = _wanted_port()
        ports = range(wanted, min(wanted + _TRIES, 65536)) if wanted else (0,)
        try:
            listener = listen(self._context.host, ports)
        except MorseMiddlewareError as error:
            raise MorseMiddlewareError(f"{error}; {_PORT_VARIABLE} says where to look for a free one") from None
        self.port = port_of(listener)
        if wanted and self.port != wanted:
            logger.warning(
                "port %d is in use (by another simulation?): services are on port %d; connect with Morse(port=%d)",
                wanted,
                self.port,
                self.port,
            )
        else:
            logger.info("services are on port %d", self.port)
        self._server = LineServer("services", listener, lambda server: ServiceClient(server, self._arrived))
        self._context.network.call(self._server.start(self._context.network))
        return True

    def finalization(self) -> bool:
        """Send the last replies and close."""
        self._hand_over()
        if self._server is not None:
            self._context.network.call(self._server.close())
            self._server = None
        return True

    def _arrived(self, client: ServiceClient, line: bytes) -> None:
        if not self._arriving:
            self._context.network.when_read(self._all_arrived)
        self._arriving.append((client, line))

    def _all_arrived(self) -> None:
        self._inbox.extend(self._arriving)
        self._arriving.clear()
        self._context.wake()

    def update(self) -> None:
        """One tick: requests, outcomes, and all replies in one parcel to the network thread."""
        super().update()
        self._hand_over()

    def main(self) -> None:
        """Read the requests that have arrived."""
        if not self._inbox:
            return
        for _ in range(_REQUESTS_PER_TICK):
            try:
                client, line = self._inbox.popleft()
            except IndexError:
                return
            self._consumed[client] = self._consumed.get(client, 0) + 1
            self._handle(client, line)
        self._context.wake()

    def on_service_completion(self, request_id: uuid.UUID, result: Outcome) -> None:
        """An asynchronous call has ended: answer who asked."""
        client, request = self._calls.pop(request_id)
        if request_id in self._steps:
            # how much its streams have been sent is known when the reply is sent: after all that was published before
            self._steps.discard(request_id)
            self._outbox.append((client, lambda: self._step_reply(request, *result)))
        else:
            self._outbox.append((client, format_reply(request, *result)))

    def _step_reply(self, request: str, state: str, result: Any) -> bytes:
        manager = self._context.stream_managers.get(_STREAMS)
        if state == SUCCESS and manager is not None:
            result = manager.sent()
        return format_reply(request, state, result)

    def _handle(self, client: ServiceClient, line: bytes) -> None:
        try:
            request = parse_request(line)
        except MalformedRequest as error:
            self._outbox.append((client, format_failure(error.request, str(error))))
            return
        if request is None:
            return
        if request.service is None:
            self._cancel(client, request.id)
            return
        self._remember(client, request.id)
        try:
            done, outcome = self.on_incoming_request(request.component, request.service, request.arguments)
        except MorseRPCNbArgsError as error:
            self._outbox.append((client, format_failure(request.id, f"{self.title}: {error}")))
        except MorseError as error:
            self._outbox.append((client, format_failure(request.id, str(error))))
        except Exception as error:
            self._outbox.append((client, format_failure(request.id, _report(request, error))))
        else:
            if done:
                self._outbox.append((client, format_reply(request.id, *outcome)))
            else:
                self._calls[outcome] = (client, request.id)
                if (request.component, request.service) == _STEP and request.arguments[1:] == [True]:
                    self._steps.add(outcome)

    def _remember(self, client: ServiceClient, request: str) -> None:
        self._issued[client, request] = None
        if len(self._issued) > _REMEMBERED:
            del self._issued[next(iter(self._issued))]

    def _cancel(self, client: ServiceClient, request: str) -> None:
        own = [call for call, caller in self._calls.items() if caller == (client, request)]
        # what another client has started may be cancelled, but not by an id that was used for something of its own
        others = [call for call, (_, asked) in self._calls.items() if asked == request]
        calls = own or ([] if (client, request) in self._issued else others)
        if calls:
            self.abort_request(calls[-1])
        else:
            logger.debug("the client %s cancels %s, which is not running", client.peer, request)

    def _hand_over(self) -> None:
        if not self._consumed and not self._outbox:
            return
        self._context.network.post(_deliver, self._outbox, self._consumed)
        self._outbox = []
        self._consumed = {}


def _deliver(replies: list[tuple[ServiceClient, _Reply]], consumed: dict[ServiceClient, int]) -> None:
    by_client: dict[ServiceClient, list[bytes]] = {}
    for client, reply in replies:
        by_client.setdefault(client, []).append(reply if isinstance(reply, bytes) else reply())
    for client, parts in by_client.items():
        client.reply(b"".join(parts))
    for client, count in consumed.items():
        client.consumed(count)


def _wanted_port() -> int:
    text = os.environ.get(_PORT_VARIABLE, str(PORT))
    if not text.isdecimal() or int(text) > 65535:
        raise MorseMiddlewareError(f"{_PORT_VARIABLE} is a port number from 0 to 65535, not '{text}'")
    return int(text)


def _report(request: Request, error: Exception) -> str:
    """Log that a service broke down, and return what its caller is told."""
    what = f"{type(error).__name__}: {error}"
    frame = traceback.extract_tb(error.__traceback__)[-1]
    logger.error(
        'the service %s of %s failed: %s\n  File "%s", line %s, in %s',
        request.service,
        request.component,
        what,
        frame.filename,
        frame.lineno,
        frame.name,
    )
    return what
