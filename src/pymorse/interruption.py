"""Ctrl+C in a client is not an error, so that it prints no traceback."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import TracebackType

_MARK = "_pymorse_quiet"


def end_quietly(error: KeyboardInterrupt) -> None:
    """Let the interpreter end without a traceback if the program does not handle this exception.

    The exception still propagates through the program, and the exit status remains that of an interrupted program.
    """
    setattr(error, _MARK, True)
    before = sys.excepthook

    def hook(kind: type[BaseException], raised: BaseException, trace: TracebackType | None) -> None:
        sys.excepthook = before
        if getattr(raised, _MARK, False):
            return
        before(kind, raised, trace)

    sys.excepthook = hook
