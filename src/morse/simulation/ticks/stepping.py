"""Who may run ticks: the thread that owns the simulation, pausing, and the ticks that clients request."""

from __future__ import annotations

import _signal  # type: ignore[import-not-found]
import signal
import threading
from collections import OrderedDict
from typing import TYPE_CHECKING

from morse.core import status

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType, TracebackType

    from morse.core.context import Context
    from morse.core.guard import Guard
    from morse.core.services import Outcome
    from morse.simulation.ticks.pacing import Pacer

#: callback for the end of a request, with status and result
Ended = "Callable[[Outcome], object]"


class Stepping:
    """The queue of requested ticks.

    Attributes:
        paused: whether only requested ticks are executed.
        forced: whether the process itself executes ticks now.
    """

    def __init__(self, guard: Guard) -> None:
        self._guard = guard
        self.paused = self.forced = False
        self._series: OrderedDict[object, tuple[int, Callable[[Outcome], object]]] = OrderedDict()
        self._left = 0

    @property
    def halted(self) -> bool:
        """Whether no tick may be executed now."""
        return self.paused and not self._left and not self.forced

    @property
    def is_idle(self) -> bool:
        """Whether no ticks are requested."""
        return not self._left

    def add(self, ticks: int, ended: Callable[[Outcome], object]) -> Callable[[], None]:
        """Request ``ticks`` ticks, after earlier requests; ``ended((status, None))`` is called after the last tick.

        Returns:
            A function that cancels the request.
        """
        key = object()
        self._series[key] = (ticks, ended)
        self._left = self._left or ticks
        return lambda: self._cancel(key)

    def _cancel(self, key: object) -> None:
        if key not in self._series:
            return
        first = key is next(iter(self._series))
        _, ended = self._series.pop(key)
        if first:
            self._begin_next()
        self._guard.call([ended], (status.PREEMPTED, None))

    def _begin_next(self) -> None:
        self._left = next(iter(self._series.values()))[0] if self._series else 0

    def count(self) -> None:
        """Count a tick that was executed."""
        if not self._left:
            return
        self._left -= 1
        if not self._left:
            _, (_, ended) = self._series.popitem(last=False)
            self._begin_next()
            self._guard.call([ended], (status.SUCCESS, None))

    def end(self, outcome: str, reason: str | None = None) -> None:
        """Cancel all requested ticks, and answer the requests."""
        self._left = 0
        series = list(self._series.values())
        self._series.clear()
        self._guard.call([ended for _, ended in series], (outcome, reason))


#: the plain functions, because the wrappers with enumerations in `signal` take longer than the rest of a step; they are
#: not what `inspect.unwrap` returns, which knows nothing of these wrappers
_handle, _handler = _signal.signal, _signal.getsignal
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


_CHANGES = (Ownership.__enter__.__code__, Ownership.__exit__.__code__)


def changes_owner(frame: FrameType | None) -> bool:
    """Whether a frame is within the first or last lines of a tick: an error of a signal there would leave it owned."""
    while frame is not None:
        if frame.f_code in _CHANGES:
            return True
        frame = frame.f_back
    return False


def _nobody(_outcome: Outcome) -> None:
    """Default callback for the end of requested ticks."""


class Paused:
    """The part of a simulation that pauses it; see `morse.simulation.simulation.Simulation`."""

    context: Context
    pacer: Pacer
    _stepping: Stepping

    @property
    def paused(self) -> bool:
        """Whether `run` is paused and executes only the requested ticks."""
        return self._stepping.paused

    def pause(self) -> None:
        """Pause `run`; step requests of clients end as preempted."""
        self._stepping.paused = True
        self.cancel_steps()

    def resume(self) -> None:
        """Resume `run`."""
        self._stepping.paused = False
        self.pacer.restart()

    def request_steps(self, ticks: int = 1, ended: Callable[[Outcome], object] = _nobody) -> Callable[[], None]:
        """Let `run` execute ``ticks`` ticks and then pause; earlier requests are executed first.

        Args:
            ended: callback, called with the status when the data of the last tick have been passed to the network.

        Returns:
            A function that cancels the request.
        """
        for manager in self.context.stream_managers.values():
            manager.drain()
        self._stepping.paused = True
        return self._stepping.add(ticks, ended)

    def cancel_steps(self) -> None:
        """Cancel the requested ticks."""
        self._stepping.end(status.PREEMPTED)
