"""The end has a limit: a part that does not end is named, interrupted and left."""

from __future__ import annotations

import ctypes
import logging
import signal
import sys
import threading
import traceback
from concurrent.futures import thread as executors
from time import monotonic
from typing import TYPE_CHECKING, Any

from morse.core.abstractobject import AbstractObject
from morse.core.guard import Failure
from morse.core.modifier import AbstractModifier
from morse.core.reports.faults import is_users, name_of
from morse.simulation.loader import Loaded

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from types import FrameType

    from morse.core.context import Context
    from morse.core.observer import Observer

logger = logging.getLogger(__name__)

#: exit status of a run to whose end not all parts have come: faults have switched them off, or they do not end
FAULTS = 3
#: time for the end of one part; and for the effect of an interruption, wall-clock seconds
LIMIT, _GRACE = 5.0, 2.0
#: interval between two checks, wall-clock seconds
_INTERVAL = 0.05


class Overdue(BaseException):
    """Raised in the thread of a part that does not end by itself."""


class Ending:
    """Limits the time that each part takes to end.

    Attributes:
        leave: ends the process although a part cannot be interrupted; None if the program of the user goes on.
        overdue: called with the name of a part that does not end in time, and with the line where it is left.

    Args:
        limit: wall-clock seconds for each part.
        now: wall-clock time, s.
    """

    def __init__(self, limit: float = LIMIT, now: Callable[[], float] = monotonic) -> None:
        self._limit, self._now = limit, now
        self.leave: Callable[[], object] | None = None
        self.overdue: Callable[[str, str], object] = _ignored
        self._lock = threading.Lock()
        #: whether signals come from this object itself, to wake a call that waits
        self.interrupts = False
        self._who: str | None = None
        self._ident, self._since, self._last_time = 0, 0.0, -1.0
        self._thread: threading.Thread | None = None
        self._is_over = threading.Event()

    def run(self, who: str, function: Callable[[], object]) -> None:
        """End a part, given its name for the log."""
        with self._lock:
            self._ident, self._since, self._last_time = threading.get_ident(), self._now(), -1.0
            self._who, self.interrupts = who, False
            if self._thread is None:
                self._is_over.clear()
                watch = threading.Thread(target=self._watch, name="morse end", daemon=True)
                watch.start()  # it may fail: a process may have no thread left
                self._thread = watch
        try:
            try:
                function()
            finally:
                with self._lock:
                    self._who = None
        except Overdue:
            self._who = None

    def rest(self) -> None:
        """No part ends at present: end the thread that limits the time, until the next part ends."""
        thread, self._thread = self._thread, None
        if thread is not None:
            self._is_over.set()
            thread.join()

    def hurry(self) -> None:
        """Do not wait any longer for the part that is ending now."""
        self._limit = 0.0

    def _watch(self) -> None:
        while not self._is_over.wait(_INTERVAL):
            with self._lock:
                if self._who is not None:
                    self._look(self._who, self._now())

    def _look(self, who: str, now: float) -> None:
        if self._last_time < 0.0:
            if now - self._since <= self._limit:
                return
            self._last_time = now
            line = line_of(sys._current_frames().get(self._ident))
            logger.error("[ERROR][MORSE] %s does not end: after %.1f s it is left at %s", who, now - self._since, line)
            if self._limit:  # else the user does not want to wait
                self.overdue(who, line)
        elif now - self._last_time > _GRACE and self.leave is not None:
            self.leave()
        self.interrupts = True
        _interrupt(self._ident)


def _ignored(_who: str, _line: str) -> None: ...


def _interrupt(ident: int) -> None:
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(ident), ctypes.py_object(Overdue))
    handler = signal.getsignal(signal.SIGINT)
    # Python's own handler would raise another error
    is_main = ident == threading.main_thread().ident and handler is not signal.default_int_handler
    if is_main and callable(handler) and hasattr(signal, "pthread_kill"):
        # a call that waits returns to Python to handle the signal
        signal.pthread_kill(ident, signal.SIGINT)


def line_of(frame: FrameType | None) -> str:
    """Return where a thread is: the innermost line of user code, and the component to which it belongs."""
    place, owner = "an unknown line", ""
    for one, number in traceback.walk_stack(frame):
        code = one.f_code
        if not owner and hasattr(one.f_locals.get("self"), "bge_object"):
            owner = f" ({name_of(one.f_locals['self'])})"
        if place == "an unknown line" and not code.co_filename.startswith("<") and is_users(code.co_filename):
            place = f"{code.co_filename}:{number}, in {code.co_name}"
    return place + owner


def threads_left(status: int, leave: Callable[[int], object], limit: float = LIMIT) -> None:
    """Wait for the threads that components have left behind; name those that do not end, and leave them.

    Args:
        leave: ends the process with a status, without waiting for any thread.
        limit: wall-clock seconds.
    """
    end = monotonic() + limit
    for thread in _lasting_threads():
        try:
            thread.join(max(0.0, end - monotonic()))
        except KeyboardInterrupt:
            end = 0.0
    left = _lasting_threads()
    for thread in left:
        line = line_of(sys._current_frames().get(thread.ident or 0))
        logger.error("[ERROR][MORSE] the thread '%s' does not end, it is left at %s", thread.name, line)
    if left:
        leave(status)


def _lasting_threads() -> list[threading.Thread]:
    """The other threads that keep the process alive; Python itself ends the threads of executors that are idle."""
    frames = sys._current_frames()
    return [
        thread
        for thread in threading.enumerate()
        if thread is not threading.current_thread()
        and not thread.daemon
        and not _is_idle(frames.get(thread.ident or 0))
    ]


def _is_idle(frame: FrameType | None) -> bool:
    """Whether a thread of a `concurrent.futures.ThreadPoolExecutor` waits for work."""
    return frame is not None and frame.f_code.co_name == "_worker" and frame.f_code.co_filename == executors.__file__


#: methods that do nothing: most components have one of them
_NOTHING = (AbstractObject.finalize, AbstractModifier.finalize)


class Finalizing:
    """The part of `morse.simulation.simulation.Simulation` that ends components, services and observers."""

    context: Context
    loaded: Loaded
    ending: Ending

    @property
    def observers(self) -> list[Observer]:
        """The observers."""
        raise NotImplementedError

    def _overdue(self, who: str, line: str) -> None:
        """Keep that a part does not end as a failure."""
        time = self.context.clock.time
        self.context.guard.note(Failure("fault", who, "is left", time, "it does not end", line))

    def finalize_components(self) -> None:
        """Finalize the components and modifiers."""
        parts, self.loaded = self.loaded, Loaded()
        overlays = list(self.context.overlays.values())
        self.context.overlays.clear()
        for part in [*overlays, *parts.actuators, *parts.sensors, *parts.robots, *parts.modifier_objects]:
            self._finalize(part)
        self.ending.rest()

    def finalize_one(self, part: object) -> None:
        """Finalize a component, a modifier or an overlay."""
        self._finalize(part)
        self.ending.rest()

    def _finalize(self, part: Any) -> None:
        if getattr(type(part), "finalize", None) not in _NOTHING or "finalize" in _attributes(part):
            self._end_part(part, name_of(part), lambda: part.finalize())

    def _end_part(self, part: object, who: str, end: Callable[[], object]) -> None:
        guard = self.context.guard
        guard.run(lambda: self.ending.run(who, end), lambda error: guard.failed(part, who, "ended", error))

    def finalize_services(self) -> None:
        """Stop the request managers."""
        for manager in self.context.services.everybody():
            self._end_part(manager, type(manager).__name__, manager.finish)
        self.ending.rest()

    def finalize_observers(self) -> None:
        """Close the observers: streams are sent and closed, the view ends."""
        for observer in list(self.observers):
            self._end_part(observer, type(observer).__name__, observer.close)
        self.ending.rest()


def _attributes(part: object) -> Mapping[str, object]:
    """The attributes of a part, whatever its class does when an attribute is read."""
    try:
        attributes: Mapping[str, object] = object.__getattribute__(part, "__dict__")
    except AttributeError:
        return {}
    return attributes
