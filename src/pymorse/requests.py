"""Service calls: request ``id component service [arguments]``, reply ``id STATUS [result]``, one per line."""

from __future__ import annotations

import json
import logging
import threading
import time
from typing import TYPE_CHECKING, Any, NamedTuple

from pymorse.errors import MorseServiceFailed, MorseServicePreempted
from pymorse.future import MorseExecutor, MorseFuture
from pymorse.stream import StreamB, to_json

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pymorse.poller import Poller

logger = logging.getLogger("pymorse")

SUCCESS = "SUCCESS"
FAILURE = "FAILED"
PREEMPTED = "PREEMPTED"
_WRONG_ARITY = "wrong # of parameters"


class Response(NamedTuple):
    """An answer; ``value`` is None where the line has none."""

    request: int
    status: str
    value: Any


def parse_response(line: str) -> Response:
    """Read the answer to a service call.

    Raises:
        ValueError: the line is not an answer.
    """
    parts = line.strip().split(maxsplit=2)
    if len(parts) < 2 or not parts[0].isdecimal() or parts[1] not in (SUCCESS, FAILURE, PREEMPTED):
        raise ValueError(f"expected 'id SUCCESS|FAILED|PREEMPTED [result]', got {line[:80]!r}")
    try:
        value = json.loads(parts[2]) if len(parts) == 3 else None
    except RecursionError:
        raise ValueError(f"the result is nested too deeply: {line[:80]!r}") from None
    return Response(int(parts[0]), parts[1], value)


def format_request(request: int, component: str, service: str, arguments: Sequence[Any]) -> str:
    """The line of a service call, without its end.

    Raises:
        ValueError: a name that the protocol cannot carry.
        TypeError: an argument that JSON cannot carry.
    """
    for name in (component, service):
        if not name or name.split() != [name]:
            raise ValueError(f"{name!r} is not the name of a component or service: it is empty or has blanks")
    return f"{request} {component} {service} {to_json(list(arguments))}"


class ServiceConnection(StreamB):
    """The connection to the request manager of a simulation."""

    def __init__(self, host: str, port: int, poller: Poller) -> None:
        self.executor = MorseExecutor()
        self._lock = threading.Lock()
        self._next = 0
        self._open: dict[int, tuple[MorseFuture, str]] = {}
        super().__init__(host, port, 1, poller=poller)

    def request(self, component: str, service: str, arguments: Sequence[Any]) -> MorseFuture:
        """Call a service.

        Raises:
            ConnectionError: the simulation has ended.
        """
        with self._lock:
            number = self._next
            line = format_request(number, component, service, arguments)
            self._next += 1
            future = MorseFuture(number, self.abort, self.executor, self.poller.serve_until)
            self._open[number] = (future, f"{component}.{service}")
        try:
            self.publish(line.encode())
        except BaseException:
            self._open.pop(number, None)
            raise
        return future

    def abort(self, number: int) -> None:
        """Abort a running service; its future then ends as preempted."""
        self.publish(f"{number} cancel".encode())

    def pending(self) -> list[MorseFuture]:
        """Return the unanswered calls whose futures are still in use."""
        with self._lock:
            return [future for future, _ in self._open.values() if not future.abandoned]

    def wait_pending(self, timeout: float | None = None) -> bool:
        """Wait until all calls are answered; return False after ``timeout`` seconds."""
        deadline = None if timeout is None else time.monotonic() + timeout
        for future in self.pending():
            try:
                future.exception(None if deadline is None else max(0.0, deadline - time.monotonic()))
            except TimeoutError:
                return False
        return True

    def handle_msg(self, msg: bytes) -> None:
        """An answer has arrived."""
        try:
            response = parse_response(msg.decode())
        except ValueError as error:
            logger.error("%s sent a line that is not an answer: %s", self.peer, error)
            return
        with self._lock:
            future, name = self._open.pop(response.request, (None, ""))
        if future is None:
            logger.warning("%s answered a request that is not open: %r", self.peer, msg[:80])
        elif response.status == SUCCESS:
            future.set_result(response.value)
        else:
            future.set_exception(_exception(response, name))

    def closed(self) -> None:
        """The simulation has ended, or we have closed the connection."""
        with self._lock:
            unanswered = list(self._open.values())
            self._open.clear()
        for future, name in unanswered:
            future.set_exception(ConnectionError(f"{self.peer} closed the connection before {name} had an answer"))


def _exception(response: Response, name: str) -> Exception:
    error: Exception
    if response.status == PREEMPTED:
        error = MorseServicePreempted(response.value)
    elif _WRONG_ARITY in str(response.value):
        error = TypeError(response.value)
    else:
        error = MorseServiceFailed(response.value)
    error.add_note(f"(answer of the simulation to {name})")
    return error
