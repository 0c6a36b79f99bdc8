"""The result of a service call, which arrives later."""

from __future__ import annotations

import contextlib
import logging
import threading
import time
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

from pymorse.errors import MorseServicePreempted

if TYPE_CHECKING:
    from collections.abc import Callable

logger = logging.getLogger("pymorse")

WORKERS = 10
"""Maximum number of concurrent callbacks of futures."""


class MorseExecutor:
    """Runs the callbacks of futures, so that they may call services and wait for them."""

    def __init__(self, max_workers: int = WORKERS) -> None:
        self._pool = ThreadPoolExecutor(max_workers, thread_name_prefix="pymorse-callback")
        self._workers = threading.local()

    def submit(self, function: Callable[[Any], object], argument: Any) -> None:
        """Run ``function(argument)`` in a worker thread; exceptions are logged."""
        self._pool.submit(self._run, function, argument)

    def _run(self, function: Callable[[object], object], argument: object) -> None:
        self._workers.here = True
        try:
            function(argument)
        except Exception:
            logger.exception("a callback of add_done_callback() failed")

    def close(self) -> None:
        """Wait for running callbacks, and end the threads."""
        self._pool.shutdown(wait=not getattr(self._workers, "here", False))


class MorseFuture(Future[Any]):
    """The result of a service call.

    Comparing it, or printing it in a console, waits for the result::

        if simu.robot.gripper.grab() == "Ball": ...

    Attributes:
        request: number of the call, the argument of `pymorse.Morse.cancel`.
        abandoned: whether the result is no longer needed; closing the connection does not wait for it.
    """

    def __init__(
        self,
        request: int,
        abort: Callable[[int], object],
        executor: MorseExecutor,
        serve: Callable[[Callable[[], bool], float], bool],
    ) -> None:
        super().__init__()
        self._serve = serve
        self.request = request
        self.abandoned = False
        self._abort = abort
        self._executor = executor
        self.set_running_or_notify_cancel()

    def cancel(self) -> bool:
        """Request the simulation to abort the service; return True if the service had not ended.

        The result is `MorseServicePreempted` as soon as the simulation has confirmed the request.
        """
        if self.done():
            return False
        self._abort(self.request)
        return True

    def cancelled(self) -> bool:
        """Whether the service was cancelled or interrupted."""
        return self.done() and isinstance(super().exception(), MorseServicePreempted)

    def result(self, timeout: float | None = None) -> Any:
        """Wait for the result.

        Args:
            timeout: timeout, s; None for no timeout.

        Raises:
            MorseServiceFailed: the service failed.
            MorseServicePreempted: the service was cancelled or interrupted.
            TypeError: the number of arguments is wrong.
            ConnectionError: the simulation ended before it answered.
            TimeoutError: the service takes longer than ``timeout``; it continues to run.
        """
        self._wait(timeout)
        return super().result(0)

    def exception(self, timeout: float | None = None) -> BaseException | None:
        """Wait for the end, and return the exception that `result` would raise, or None.

        Raises:
            TimeoutError: it takes longer than ``timeout``.
        """
        self._wait(timeout)
        return super().exception(0)

    def _wait(self, timeout: float | None) -> None:
        deadline = None if timeout is None else time.monotonic() + timeout
        while not self.done():
            left = 0.5 if deadline is None else deadline - time.monotonic()
            if left <= 0:
                raise TimeoutError("the service has not ended yet")
            left = min(left, 0.5)  # with short waits, Ctrl+C is processed on every platform
            if not self._serve(self.done, left):
                with contextlib.suppress(TimeoutError):
                    super().exception(left)

    def add_done_callback(self, fn: Callable[[Future[Any]], object]) -> None:
        """Call ``fn(future)`` in a worker thread when the service ends."""
        super().add_done_callback(lambda future: self._executor.submit(fn, future))

    def __eq__(self, other: object) -> bool:
        return bool(self.result() == _value(other))

    def __ne__(self, other: object) -> bool:
        return bool(self.result() != _value(other))

    def __lt__(self, other: object) -> bool:
        return bool(self.result() < _value(other))

    def __le__(self, other: object) -> bool:
        return bool(self.result() <= _value(other))

    def __gt__(self, other: object) -> bool:
        return bool(self.result() > _value(other))

    def __ge__(self, other: object) -> bool:
        return bool(self.result() >= _value(other))

    # futures are kept in sets and dictionaries, so the hash is that of the identity, not of the result
    __hash__ = object.__hash__

    def __repr__(self) -> str:
        return repr(self.result())

    def __str__(self) -> str:
        return str(self.result())


def _value(other: object) -> Any:
    return other.result() if isinstance(other, MorseFuture) else other
