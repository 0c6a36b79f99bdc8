"""A limit of the wall-clock time of a run."""

from __future__ import annotations

import contextlib
import signal
import threading
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

#: wall-clock time between two attempts to end a run, s
_AGAIN = 1.0


class RunTimeout(KeyboardInterrupt):
    """A run has taken longer than its limit; ``except Exception`` in the code of a user does not catch it."""


@contextlib.contextmanager
def limited(seconds: float | None) -> Iterator[None]:
    """Raise `RunTimeout` in the body if it takes longer, in the main thread of a process on systems with signals."""
    if seconds is None or threading.current_thread() is not threading.main_thread() or not hasattr(signal, "setitimer"):
        yield
        return

    def end(*_: object) -> None:
        raise RunTimeout(f"the run has taken longer than {seconds:g} s of wall-clock time")

    before = signal.signal(signal.SIGALRM, end)
    signal.setitimer(signal.ITIMER_REAL, seconds, _AGAIN)
    try:
        yield
    except RunTimeout:
        # the end of a simulation takes its time, too
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        raise
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
