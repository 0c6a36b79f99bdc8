"""Service calls: request ``id component service [arguments]``, reply ``id STATUS [result]``, one per line."""

from __future__ import annotations

import json
import logging
import threading
import time
from typing import TYPE_CHECKING, Any, NamedTuple

from pymorse.errors import MorseServiceFailed, MorseServicePreempted, printable
from pymorse.future import MorseExecutor, MorseFuture
from pymorse.stream import StreamB, to_json

if TYPE_CHECKING:
    import socket
    from collections.abc import Sequence

    from pymorse.poller import Poller

logger = logging.getLogger("pymorse")

SUCCESS = "SUCCESS"
FAILURE = "FAILED"
PREEMPTED = "PREEMPTED"
_WRONG_ARITY = "wrong # of parameters"


class Response(NamedTuple):
    """An answer; ``value`` is None if the line has none."""

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


def format_request(request: int, component: str, service: str, arguments: Sequence[object]) -> str:
    """Return the line of a service call, without the line end.

    Raises:
        ValueError: the protocol cannot carry a name.
        TypeError: JSON cannot represent an argument.
    """
    for name in (component, service):
        if not name or name.split() != [name]:
            raise ValueError(f"{name!r} is not the name of a component or service: it is empty or contains spaces")
    return f"{request} {component} {service} {to_json(list(arguments))}"


class _Answer:
    """The result of a call for which the caller waits; it takes much less time than a future."""

    def __init__(self) -> None:
        self.is_done = False
        self.value: Any = None
        self.error: Exception | None = None
        self._event: threading.Event | None = None
        self._future: MorseFuture | None = None

    def set_result(self, value: object) -> None:
        """Called when the call has succeeded."""
        self.value = value
        self._end()

    def set_exception(self, error: Exception) -> None:
        """Called when the call has failed."""
        self.error = error
        self._end()

    def _end(self) -> None:
        self.is_done = True
        if self._event is not None:
            self._event.set()
        if self._future is not None:
            if self.error is not None:
                self._future.set_exception(self.error)
            else:
                self._future.set_result(self.value)

    def as_future(self, future: MorseFuture) -> MorseFuture:
        """The future of this call; ``future`` if it has none yet."""
        self._future = self._future or future
        return self._future

    def wait(self, timeout: float) -> None:
        """Wait while another thread serves the connection."""
        if self._event is None:
            self._event = threading.Event()
        if not self.is_done:
            self._event.wait(timeout)


class ServiceConnection(StreamB):
    """The connection to the request manager of a simulation."""

    def __init__(self, host: str, port: int, poller: Poller, sock: socket.socket | None = None) -> None:
        self.executor = MorseExecutor()
        self._lock = threading.Lock()
        self._next = 0
        self._open: dict[int, tuple[MorseFuture | _Answer, str]] = {}
        self._has_complained = False
        super().__init__(host, port, 1, sock, poller=poller)

    def request(self, component: str, service: str, arguments: Sequence[object]) -> MorseFuture:
        """Call a service.

        Raises:
            ConnectionError: the simulation has ended.
        """
        with self._lock:
            number = self._next
            line = format_request(number, component, service, arguments)
            self._next += 1
            future = self._future(number)
            self._open[number] = (future, f"{component}.{service}")
        try:
            self.publish(line.encode())
        except BaseException:
            self._open.pop(number, None)
            raise
        return future

    def ask(self, component: str, service: str, arguments: Sequence[object]) -> Any:
        """Call a service and wait for its result, like `request`, but without the cost of a future.

        Raises:
            ConnectionError: the simulation has ended.
            MorseServiceError: the service failed or was interrupted.
            TypeError: the number of arguments is wrong.
        """
        answer = _Answer()
        with self._lock:
            number = self._next
            line = format_request(number, component, service, arguments)
            self._next += 1
            self._open[number] = (answer, f"{component}.{service}")
        try:
            self.publish(line.encode())
        except BaseException:
            self._open.pop(number, None)
            raise
        while not answer.is_done:
            # with short waits, Ctrl+C is processed on every platform
            if not self.poller.serve_until(lambda: answer.is_done, 0.5):
                answer.wait(0.5)
        if answer.error is not None:
            raise answer.error
        return answer.value

    def abort(self, number: int) -> None:
        """Abort a running service; its future then ends as preempted."""
        self.publish(f"{number} cancel".encode())

    def pending(self) -> list[MorseFuture]:
        """Return the unanswered calls whose futures are still in use."""
        with self._lock:
            futures = [
                one if isinstance(one, MorseFuture) else one.as_future(self._future(number))
                for number, (one, _) in self._open.items()
            ]
        return [future for future in futures if not future.abandoned]

    def _future(self, number: int) -> MorseFuture:
        return MorseFuture(number, self.abort, self.executor, self.poller.serve_until)

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
        """Called when an answer has arrived."""
        try:
            response = parse_response(msg.decode())
        except ValueError as error:
            # a stream, which is not a server of services, sends a line in each tick
            if not self._has_complained:
                self._has_complained = True
                logger.error(
                    "%s sent a line that is not an answer: %s; further lines are not reported", self.peer, error
                )
            return
        with self._lock:
            future, name = self._open.pop(response.request, (None, ""))
        if future is None:
            if not self._has_complained:
                self._has_complained = True
                logger.warning(
                    "%s answered an unknown request: %r; further answers are not reported", self.peer, msg[:80]
                )
        elif response.status == SUCCESS:
            future.set_result(response.value)
        else:
            future.set_exception(_exception(response, name))

    def closed(self) -> None:
        """Called when the simulation has ended, or the connection was closed."""
        with self._lock:
            unanswered = list(self._open.values())
            self._open.clear()
        for future, name in unanswered:
            future.set_exception(ConnectionError(f"{self.peer} closed the connection before it answered {name}"))


def _exception(response: Response, name: str) -> Exception:
    error: Exception
    value = printable(response.value) if isinstance(response.value, str) else response.value
    if response.status == PREEMPTED:
        error = MorseServicePreempted(value)
    elif isinstance(value, str) and _WRONG_ARITY in value:
        error = TypeError(value)
    else:
        error = MorseServiceFailed(value)
    error.add_note(f"(answer of the simulation to {name})")
    return error
