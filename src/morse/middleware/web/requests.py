"""Services for clients of a WebSocket server."""

from __future__ import annotations

import logging
import re
from collections import deque
from typing import TYPE_CHECKING, Any, ClassVar

import msgspec

from morse.core import status
from morse.core.clients.budgets import OverBudget, TimeShare
from morse.core.clients.complaints import Complaints
from morse.core.exceptions import MorseError, MorseMethodNotFoundError, MorseRPCNbArgsError
from morse.core.reports.quoting import nearest, short
from morse.core.request_manager import Outcome, RequestManager
from morse.core.services import signature_of
from morse.middleware.socket.turns import Turns
from morse.middleware.web.hub import hub_of
from morse.wire.encoding import plain

if TYPE_CHECKING:
    import uuid
    from collections.abc import Set

    from morse.core.context import Context
    from morse.middleware.web.hub import Hub, HubClient

    #: client, value that the client passed with the call with the size of the call, error, result as JSON
    _Answer = tuple[HubClient, Any, str | None, bytes]

logger = logging.getLogger(__name__)

MOST_CALLS = 256
"""Maximum number of active or waiting calls of one client."""

_encoder = msgspec.json.Encoder(enc_hook=plain)


class WebRequestManager(RequestManager):
    """Services by name: ``/robot/motion/stop`` is the service ``stop`` of the component ``robot.motion``.

    A service takes its arguments as a list, or as an object with their names.
    """

    hub_class: ClassVar[type[Hub]]

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        self._context = context
        self._hub = hub_of(context, self.hub_class)
        self.title = self._hub.name
        #: component and service by name; replaced, never modified, because the network thread reads it
        self.paths: dict[str, tuple[str, str]] = {}
        self._inbox: Turns[HubClient, tuple[object, str, bytes]] = Turns()
        self._share = TimeShare(context.time_shares)
        self._leavers: deque[HubClient] = deque()
        self._cancelled: deque[tuple[HubClient, Any]] = deque()
        self._outbox: list[_Answer] = []
        self._calls: dict[uuid.UUID, tuple[HubClient, Any]] = {}
        #: by client and the value that it has passed: a client may cancel as often as it calls
        self._numbers: dict[tuple[HubClient, Any], set[uuid.UUID]] = {}
        self._complaints = Complaints(logger)

    def initialization(self) -> bool:
        """Start the server, unless the topics have started it."""
        self._hub.join()
        self._hub.requests = self
        return True

    def finalization(self) -> bool:
        """Send the last responses."""
        self._hand_over()
        self._hub.requests = None
        self._hub.leave()
        return True

    def post_registration(self, component_name: str, service: str, is_async: bool) -> bool:
        """See `RequestManager.post_registration`."""
        self.paths = {**self.paths, path_of(component_name, service): (component_name, service)}
        self._context.network.post(self._tell_changed)
        return True

    def withdrawn(self, component_name: str, services: Set[str]) -> None:
        """See `RequestManager.withdrawn`."""
        gone = {(component_name, service) for service in services}
        self.paths = {path: entry for path, entry in self.paths.items() if entry not in gone}
        self._context.network.post(self._tell_changed)

    # -- in the network thread ---------------------------------------------------------------

    def _tell_changed(self) -> None:
        for client in list(self._hub.server.clients):
            client.services_changed()

    def call(self, client: HubClient, call: object, path: str, arguments: bytes) -> None:
        """Call a service for a client; `HubClient.answer` will be called.

        Args:
            client: the caller.
            call: a value that is returned to the client with the response.
            path: name of the service.
            arguments: JSON: a list, or an object with names; empty for none. They are decoded when the service is
                called: values that wait would take many times the memory.
        """
        if client.calls >= MOST_CALLS:
            client.answer(call, f"{MOST_CALLS} calls of this client are active: wait until they end", b"")
            return
        size = len(arguments) + len(path) + len(str(call))
        try:
            client.keep(size, "a call")
        except OverBudget as error:
            client.answer(call, str(error), b"")
            return
        client.calls += 1
        self._inbox.extend([(client, ((call, size), path, arguments))])
        self._context.wake()

    def cancel(self, client: HubClient, call: object) -> None:
        """Cancel a call of a client."""
        self._cancelled.append((client, call))
        self._context.wake()

    def gone(self, client: HubClient) -> None:
        """Remove a disconnected client."""
        self._leavers.append(client)

    @staticmethod
    def _deliver(answers: list[_Answer]) -> None:
        for client, (call, size), error, value in answers:
            client.calls -= 1
            client.release(size)
            client.answer(call, error, value)

    # -- in the simulation thread ------------------------------------------------------------

    def update(self) -> None:
        """One tick."""
        super().update()
        self._hand_over()

    def main(self) -> None:
        """Process the received requests within the time share of a tick."""
        if self._inbox and self._share.begin():
            while (item := self._inbox.next()) is not None:
                client, request = item
                self._handle(client, *request)
                self._inbox.served(client, self._share.spend())
                if self._share.is_used():
                    break
        while self._cancelled:
            client, id_ = self._cancelled.popleft()
            for number in list(self._numbers.get((client, id_), ())):
                self.abort_request(number)
        while self._leavers:
            client = self._leavers.popleft()
            self._inbox.forget(client, with_requests=False)
            for number, (caller, _) in list(self._calls.items()):
                if caller is client:
                    self.abandon(number)

    def _handle(self, client: HubClient, call: object, path: str, arguments: bytes) -> None:
        component, service = self.paths.get(path, ("", ""))
        try:
            if not service:
                raise MorseMethodNotFoundError(f"there is no service {short(path)}{nearest(path, self.paths)}")
            values = self._listed(component, service, _decoded(arguments))
            is_complete, outcome = self.on_incoming_request(component, service, values)
        except MorseError as error:
            self._outbox.append((client, call, str(error), b""))
        except Exception as error:  # the service may be user code
            self._outbox.append((client, call, self._complaints.service_failed(f"the service {path}", error), b""))
        else:
            if is_complete:
                self._answer(client, call, outcome)
            else:
                self._calls[outcome] = (client, call)
                self._numbers.setdefault(_key(client, call), set()).add(outcome)

    def _listed(self, component: str, service: str, arguments: object) -> list[object]:
        """The arguments in the order of the service."""
        if arguments is None:
            return []
        if isinstance(arguments, list):
            return arguments
        if not isinstance(arguments, dict):
            raise MorseRPCNbArgsError(f"{service}: arguments are a list, or an object with their names")
        entry = self.find(component, service)
        assert entry is not None
        parameters = signature_of(entry.callback).parameters
        for name in arguments:
            if name not in parameters:
                raise MorseRPCNbArgsError(f"{service} has no argument {short(name)}{nearest(name, parameters)}")
        values = []
        last = max((list(parameters).index(name) for name in arguments), default=-1)
        for name, parameter in list(parameters.items())[: last + 1]:
            if name not in arguments and parameter.default is parameter.empty:
                raise MorseRPCNbArgsError(f"{service}: the argument '{name}' is missing")
            values.append(arguments.get(name, parameter.default))
        return values

    def on_service_completion(self, request_id: uuid.UUID, result: Outcome) -> None:
        """See `RequestManager.on_service_completion`."""
        client, call = self._calls.pop(request_id)
        key = _key(client, call)
        self._numbers[key].discard(request_id)
        if not self._numbers[key]:
            del self._numbers[key]
        self._answer(client, call, result)

    def _answer(self, client: HubClient, call: object, outcome: Outcome) -> None:
        state, value = outcome
        error, data = None, b""
        if state == status.SUCCESS:
            try:
                data = encoded(value)
            except (TypeError, ValueError, OverflowError, RecursionError) as failure:
                error = f"the result cannot be written as JSON: {failure}"
        else:
            error = f"{state}: {value}" if value else state
        self._outbox.append((client, call, error, data))

    def _hand_over(self) -> None:
        if self._outbox:
            answers, self._outbox = self._outbox, []
            self._context.network.post(self._deliver, answers)


def _key(client: HubClient, call: Any) -> tuple[HubClient, Any]:
    """Client, and the value that it has passed with a call, without the size."""
    return client, call[0]


def encoded(value: object) -> bytes:
    """A value as JSON.

    Raises:
        TypeError, ValueError, OverflowError, RecursionError: it cannot be written as JSON.
    """
    return _encoder.encode(value)


def _decoded(arguments: bytes) -> object:
    """The arguments of a call.

    Raises:
        MorseRPCNbArgsError: they are not JSON.
    """
    try:
        return msgspec.json.decode(arguments) if arguments.strip() else None
    except (msgspec.DecodeError, RecursionError, UnicodeDecodeError) as error:
        raise MorseRPCNbArgsError(f"the arguments are not JSON: {error}") from None


def path_of(component: str, service: str) -> str:
    """The name of a service."""

    def words(text: str) -> str:
        return re.sub(r"[^A-Za-z0-9_/]", "_", text)

    return f"/{words(component.replace('.', '/'))}/{words(service)}"
