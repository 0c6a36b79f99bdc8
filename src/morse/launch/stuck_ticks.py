"""Finds code of the user that does not return, and interrupts it if the simulation is to end."""

from __future__ import annotations

import _thread
import logging
import math
import signal
import sys
import threading
import traceback
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING

from morse.core.reports.faults import is_users

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType

    from morse.simulation.simulation import Simulation

logger = logging.getLogger(__name__)

_OURS = Path(__file__).resolve().parents[1]
#: the files that call components, in ticks and when they are created, and an edited script; not imported before the
#: script is executed
_CALLERS = [
    str(_OURS / name) for name in ("simulation/ticks/ticking.py", "simulation/loader.py", "launch/rereading.py")
]
#: interval between two checks, wall-clock seconds
_INTERVAL = 0.5
#: time for the effect of an interruption, wall-clock seconds
_GRACE = 2.0


def user_line(frame: FrameType | None) -> str | None:
    """Return the innermost line of a component, or of an edited script, as ``slope.py:10, in default_action``.

    Returns:
        None without code of the user.
    """
    inner: str | None = None
    below = False
    for one, line in reversed([] if frame is None else list(traceback.walk_stack(frame))):
        file = one.f_code.co_filename
        if file in _CALLERS:
            below = True
        elif below and not file.startswith("<") and is_users(file):
            inner = f"{file}:{line}, in {one.f_code.co_name}"
    return inner


class StuckTicks:
    """Watches the main thread, in a second thread, while components are created or ticks run.

    A simulation ends after its tick. If component code does not return, the tick does not end: this is logged once, and
    a second signal, or a timeout, interrupts the code by a `KeyboardInterrupt`.

    Args:
        simulation: runs its ticks in the main thread.
        warn_after: time after which component code is reported, wall-clock seconds.
        end_after: timeout for component code if the simulation is to end, wall-clock seconds.
        leave: ends the process if component code has caught the interruption; None to wait for the component.
    """

    def __init__(
        self,
        simulation: Simulation,
        warn_after: float = 5.0,
        end_after: float = 10.0,
        leave: Callable[[], object] | None = None,
    ) -> None:
        self._leave, self._interrupted = leave, math.inf
        self._simulation = simulation
        self._warn_after, self._end_after = warn_after, end_after
        self._main = threading.main_thread().ident or 0
        self._asked: float | None = None
        #: the tick in which component code does not return, as far as it is known
        self._stuck: int | None = None
        self._number = signal.SIGINT
        self._over = threading.Event()
        threading.Thread(target=self._watch, name="morse ticks", daemon=True).start()

    def end(self, number: int, _frame: object) -> None:
        """Signal handler: end the simulation after its tick, or at once if component code does not return.

        Raises:
            KeyboardInterrupt: component code does not return.
        """
        self._simulation.stop()
        if self._asked is None:
            self._asked, self._number = monotonic(), signal.Signals(number)
        elif self._stuck == self._simulation.ticks and not self._over.is_set():
            self._interrupted = min(self._interrupted, monotonic())
            raise KeyboardInterrupt

    def close(self) -> None:
        """Stop watching: from now on, signals do not interrupt anything."""
        self._over.set()

    def _watch(self) -> None:
        tick, since, last_report = -1, monotonic(), ""
        interrupted = -math.inf
        while not self._over.wait(_INTERVAL):
            now = monotonic()
            if self._simulation.ticks != tick:
                tick, since, last_report, self._stuck = self._simulation.ticks, now, "", None
                continue
            request = self._asked
            if now - since < self._warn_after and (request is None or now - request < _INTERVAL):
                continue
            line = user_line(sys._current_frames().get(self._main))
            if line is None:
                since = now
                continue
            self._stuck = tick
            if now - self._interrupted > _GRACE and self._leave is not None:
                logger.error("[ERROR][MORSE] code does not end when it is interrupted: it is left at %s", line)
                self._leave()
            end = "Ctrl+C" if request is None else f"Ctrl+C again, or a timeout of {self._end_after:.0f} s,"
            if end != last_report:
                last_report = end
                logger.warning(
                    "the code of a component or of the script has not returned for %.1f s: %s; %s ends it",
                    now - since,
                    line,
                    end,
                )
            if request is not None and now - max(request, interrupted) > self._end_after:
                # not again before the next timeout: the first interruption may not have taken effect yet
                interrupted = now
                self._interrupt()

    def _interrupt(self) -> None:
        if hasattr(signal, "pthread_kill"):
            signal.pthread_kill(self._main, self._number)
        else:
            _thread.interrupt_main(self._number)
