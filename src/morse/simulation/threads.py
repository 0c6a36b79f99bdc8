"""Reports errors in threads that components have started as errors of these components."""

from __future__ import annotations

import threading
import traceback
from typing import TYPE_CHECKING

from morse.core.abstractobject import AbstractObject
from morse.core.reports.faults import attribute, is_a, name_of, trace_of

if TYPE_CHECKING:
    from collections.abc import Callable


def watch_threads() -> None:
    """Report errors in the threads of components to the guard; those in other threads are reported as before."""
    if not isinstance(threading.excepthook, _Hook):
        threading.excepthook = _Hook(threading.excepthook)


class _Hook:
    """An exception hook of `threading` that knows components.

    Args:
        before: the hook for threads that do not belong to a component.
    """

    def __init__(self, before: Callable[[threading.ExceptHookArgs], object]) -> None:
        self._before = before

    def __call__(self, failure: threading.ExceptHookArgs) -> object:
        error = failure.exc_value
        component = None if error is None or is_a(error, SystemExit) else _component(error)
        guard = attribute(attribute(component, "context"), "guard")
        if error is None or guard is None:
            return self._before(failure)
        thread = failure.thread.name if failure.thread is not None else "(without a name)"
        guard.failed(component, f"the thread {thread} of {name_of(component)}", "has ended", error)
        return None


def _component(error: BaseException) -> AbstractObject | None:
    """Return the component whose function a thread ran: that of the outermost function with a component."""
    for frame, _ in traceback.walk_tb(trace_of(error)):
        for value in frame.f_locals.values():
            if is_a(value, AbstractObject):
                component: AbstractObject = value
                return component
    return None
