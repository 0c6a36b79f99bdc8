"""The currently executed lines of user code."""

from __future__ import annotations

import os
import sys
import sysconfig
from typing import TYPE_CHECKING

import morse
from morse.scene import SourceLine
from morse.scene.scene_warnings import find_lines

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import CodeType, FrameType

    from morse.scene import Scene

_LIBRARIES = tuple(sysconfig.get_path(name) + os.sep for name in ("stdlib", "purelib", "platlib"))
_PACKAGE = os.path.dirname(os.path.abspath(morse.__file__)) + os.sep


#: functions of MORSE that call a script
_BEGINNINGS: set[CodeType] = set()


def begins_script(function: Callable[..., Scene]) -> None:
    """Note a function that calls a script."""
    _BEGINNINGS.add(function.__code__)


def is_users(code: CodeType) -> bool:
    """Whether code belongs neither to MORSE nor to Python's import system."""
    return not code.co_filename.startswith((_PACKAGE, "<frozen"))


def is_library(code: CodeType) -> bool:
    """Whether code belongs to the standard library or to an installed package."""
    return code.co_filename.startswith(_LIBRARIES)


def user_frames() -> Iterator[FrameType]:
    """Return the frames of user code in the call stack, innermost first, up to the script itself.

    What has called MORSE to run a script is no part of it.
    """
    frame: FrameType | None = sys._getframe(1)
    while frame is not None and frame.f_code not in _BEGINNINGS:
        if is_users(frame.f_code):
            yield frame
            if frame.f_code.co_name == "<module>":
                return
        frame = frame.f_back


def source_line(owner: object = None) -> SourceLine | None:
    """Return the currently executed line of the script.

    Args:
        owner: an object that is being created, whose ``__init__`` methods are skipped.
    """
    library: FrameType | None = None
    for frame in user_frames():
        # a warning asks for its line from within the log
        is_log = frame.f_globals.get("__name__") == "logging"
        if is_log or (owner is not None and frame.f_locals.get("self") is owner):
            continue
        # Python's own modules call back and are called in between; a script may itself be part of a package
        if not is_library(frame.f_code):
            return SourceLine(frame.f_code.co_filename, frame.f_lineno)
        library = library or frame
    return None if library is None else SourceLine(library.f_code.co_filename, library.f_lineno)


def calling_line() -> SourceLine | None:
    """Return the line of the script that has called a method; None if a constructor of MORSE has called it."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None and not is_users(frame.f_code):
        if frame.f_code.co_name == "__init__":
            return None
        frame = frame.f_back
    return source_line()


def frame_above(level: int) -> FrameType | None:
    """The frame ``level`` calls above the function that calls this one, or None."""
    frame: FrameType | None = sys._getframe(1)
    for _ in range(level):
        frame = frame.f_back if frame is not None else None
    return frame


find_lines(source_line)
