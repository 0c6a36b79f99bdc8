"""The lines of the user's code that are being run."""

from __future__ import annotations

import os
import sys
import sysconfig
from typing import TYPE_CHECKING

import morse
from morse.scene import SourceLine

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import CodeType, FrameType

_LIBRARIES = tuple(sysconfig.get_path(name) + os.sep for name in ("stdlib", "purelib", "platlib"))
_PACKAGE = os.path.dirname(os.path.abspath(morse.__file__)) + os.sep


def is_users(code: CodeType) -> bool:
    """True for code that is neither ours nor Python's import machinery."""
    return not code.co_filename.startswith((_PACKAGE, "<frozen"))


def is_library(code: CodeType) -> bool:
    """True for code of Python's library and of installed packages."""
    return code.co_filename.startswith(_LIBRARIES)


def user_frames() -> Iterator[FrameType]:
    """The frames of the script that called us, innermost first, up to that of the script itself."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None:
        if is_users(frame.f_code):
            yield frame
            if frame.f_code.co_name == "<module>":
                return
        frame = frame.f_back


def source_line(made: object = None) -> SourceLine | None:
    """The line of the script that is being run.

    Args:
        made: an object that is being made: its own ``__init__`` methods do not count.
    """
    frames = user_frames()
    frame = next((f for f in frames if made is None or f.f_locals.get("self") is not made), None)
    return None if frame is None else SourceLine(frame.f_code.co_filename, frame.f_lineno)


def frame_above(level: int) -> FrameType | None:
    """The frame ``level`` calls above the function that calls this one, or None."""
    frame: FrameType | None = sys._getframe(1)
    for _ in range(level):
        frame = frame.f_back if frame is not None else None
    return frame
