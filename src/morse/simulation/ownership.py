"""Makes sure that one thread at a time runs ticks, and that ticks are not interrupted."""

from __future__ import annotations

import inspect
import signal
import threading
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

#: the plain functions, because the wrappers with enumerations in `signal` take longer than the rest of a step
_handle, _handler = inspect.unwrap(signal.signal), inspect.unwrap(signal.getsignal)
_SIGINT = int(signal.SIGINT)
#: timeout for a simulation in another thread to end when it is closed, s
_PATIENCE = 20.0


class Ownership:
    """A context manager for the thread that runs ticks.

    In a program with Python's default handler for Ctrl+C, Ctrl+C takes effect at the end of a tick, so that each tick
    is complete.

    Attributes:
        interrupted: whether Ctrl+C was pressed.
        holds_back: whether Ctrl+C is delayed to the end of a tick; the system calls take as long as the rest of a step.

    Args:
        stop: callback, called when Ctrl+C is pressed.
    """

    def __init__(self, stop: Callable[[], object]) -> None:
        self._lock = threading.Lock()
        self._owner: int | None = None
        self._stop = stop
        self._is_lost = False
        self.interrupted = False
        self.holds_back = True

    def __enter__(self) -> None:
        if not self._lock.acquire(blocking=False):
            if self._owner == threading.get_ident():
                raise RuntimeError("a tick is running: the simulation cannot be run or ended from within the tick")
            raise RuntimeError("this simulation is running in another thread: stop it first")
        self._owner = threading.get_ident()
        self.interrupted = False
        main = self.holds_back and threading.current_thread() is threading.main_thread()
        if main and _handler(_SIGINT) is signal.default_int_handler:
            self._is_lost = True
            _handle(_SIGINT, self._note)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._is_lost:
            self._is_lost = False
            _handle(_SIGINT, signal.default_int_handler)
        self._owner = None
        self._lock.release()
        if self.interrupted and kind is None:
            raise KeyboardInterrupt

    def _note(self, _signal: int, _frame: object) -> None:
        self.interrupted = True
        self._stop()

    def take_over(self, wake: Callable[[], object]) -> None:
        """Stop a run in another thread.

        Raises:
            RuntimeError: the run does not stop, or a tick of this thread is running.
        """
        if self._owner == threading.get_ident():
            raise RuntimeError("a tick is running: the simulation cannot be closed from within the tick")
        if self._lock.acquire(blocking=False):
            self._lock.release()
            return
        self._stop()
        wake()
        if not self._lock.acquire(timeout=_PATIENCE):
            raise RuntimeError("this simulation is running in another thread, and does not stop")
        self._lock.release()
