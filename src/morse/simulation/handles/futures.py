"""The result of a service that was called from within the process."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core import status

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.clock import Clock
    from morse.core.guard import Guard
    from morse.core.request_manager import Outcome
    from morse.core.values import Value


def _nothing() -> None:
    """Default for `LocalFuture.abort`: there is nothing to abort."""


class LocalFuture:
    """The result of a service call, with the interface of `pymorse.MorseFuture`.

    Most services end immediately. If a service continues over several ticks, `result` runs the simulation until the
    service has ended. A comparison of the future does the same.

    Attributes:
        abort: function that interrupts the service.
    """

    def __init__(self, tick: Callable[[], object], clock: Clock, guard: Guard) -> None:
        self._tick = tick
        self._guard = guard
        self._clock = clock
        self._outcome: Outcome | None = None
        self._callbacks: list[Callable[[LocalFuture], object]] = []
        self.abort: Callable[[], object] = _nothing

    def finish(self, outcome: Outcome) -> None:
        """Set the outcome when the service has ended."""
        self._outcome = outcome
        callbacks, self._callbacks = self._callbacks, []
        # the callbacks belong to the caller, not to the component whose service ends
        self._guard.call(callbacks, self)

    def done(self) -> bool:
        """Whether the service has ended."""
        return self._outcome is not None

    def running(self) -> bool:
        """Whether the service is still running."""
        return self._outcome is None

    def cancel(self) -> bool:
        """Interrupt the service; return True if it was still running."""
        if self.done():
            return False
        self.abort()
        return True

    def cancelled(self) -> bool:
        """Whether the service was cancelled or interrupted."""
        return self._outcome is not None and self._outcome[0] == status.PREEMPTED

    def result(self, timeout: float | None = None) -> Value:
        """Run the simulation until the service has ended, and return the result.

        Args:
            timeout: timeout in simulated seconds; None for no timeout.

        Raises:
            pymorse.MorseServiceFailed: the service failed.
            pymorse.MorseServicePreempted: the service was cancelled or interrupted.
            TimeoutError: the service takes longer than ``timeout``; it continues.
        """
        error = self.exception(timeout)
        if error is not None:
            raise error
        assert self._outcome is not None
        return self._outcome[1]

    def exception(self, timeout: float | None = None) -> BaseException | None:
        """Return the exception that `result` would raise, or None.

        Raises:
            TimeoutError: the service takes longer than ``timeout``.
        """
        last = None if timeout is None else self._clock.tick + timeout * self._clock.frequency
        while self._outcome is None:
            if last is not None and self._clock.tick >= last:
                raise TimeoutError("the service has not ended yet")
            self._tick()
        state, value = self._outcome
        if state == status.SUCCESS:
            return None
        from pymorse.errors import MorseServiceFailed, MorseServicePreempted

        return MorseServicePreempted(value) if state == status.PREEMPTED else MorseServiceFailed(value)

    def add_done_callback(self, fn: Callable[[LocalFuture], object]) -> None:
        """Call ``fn(future)`` when the service ends, or immediately if it has ended."""
        if self.done():
            fn(self)
        else:
            self._callbacks.append(fn)

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

    # comparison uses the result, but sets and dictionaries use the identity of the future
    __hash__ = object.__hash__

    def __repr__(self) -> str:
        return repr(self.result()) if self.done() else "<a service that is running>"


def _value(other: object) -> Value:
    return other.result() if isinstance(other, LocalFuture) else other
