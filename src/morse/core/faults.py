"""Describes errors in user code by file and line, without the frames of the simulator.

The error itself may be hostile: its methods may raise, or return any amount of text.
"""

from __future__ import annotations

import inspect
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any

from morse.core.hints import closest
from morse.core.quoting import escaped
from morse.system.source_lines import source_line

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType, TracebackType

_OURS = Path(__file__).resolve().parents[1]
#: largest number of characters of the message of an error, and of lines of user code that led to it
_LONGEST, _MOST_LINES = 2000, 12
#: what ends a program is not a fault of the part that raises it
ENDINGS = (KeyboardInterrupt, SystemExit)


def user_frames(trace: TracebackType | None) -> list[traceback.FrameSummary]:
    """Return the frames of a traceback that do not belong to the simulator."""
    # chosen first, so that only files of users are read
    return _read([one for one in traceback.walk_tb(trace) if is_users(one[0].f_code.co_filename)])


def is_users(filename: str) -> bool:
    """Whether a file does not belong to the simulator."""
    try:
        return not Path(filename).resolve().is_relative_to(_OURS) and not filename.startswith("<frozen")
    except (OSError, ValueError, RuntimeError):
        return True


def _read(frames: list[tuple[FrameType, int]]) -> list[traceback.FrameSummary]:
    return [
        traceback.FrameSummary(frame.f_code.co_filename, number, frame.f_code.co_name, lookup_line=False, line=text)
        for frame, number in frames
        for text in [_line(frame, number)]
    ]


def _line(frame: FrameType, number: int) -> str:
    # a module of the user may have a loader that fails to return the lines
    return str(_safely(lambda: source_line(frame.f_code.co_filename, number, frame.f_globals), ""))


def describe(error: BaseException) -> str:
    """Return the error message, and the lines of user code that led to the error."""
    frames = user_frames(error.__traceback__)
    if not frames:
        # the traceback does not contain user code
        text = message(error)
        return text if isinstance(error, OSError) and text else summary(error)
    return "\n".join([f"{summary(error)}{_meant(error)}", *_lines(frames)])


def place(error: BaseException) -> str:
    """Return the innermost line of user code that led to an error, else the innermost line of all."""
    frames = user_frames(error.__traceback__) or _read(list(traceback.walk_tb(error.__traceback__))[-1:])
    return "\n".join(_lines(frames[-1:]))


def _lines(frames: list[traceback.FrameSummary]) -> list[str]:
    lines = []
    if len(frames) > _MOST_LINES:
        lines.append(f"  ... {len(frames) - _MOST_LINES} calls")
    for frame in frames[-_MOST_LINES:]:
        lines.append(f'  File "{frame.filename}", line {frame.lineno}, in {frame.name}')
        if frame.line:
            lines.append(f"    {frame.line.strip():.200}")
    return lines


def summary(error: BaseException) -> str:
    """Return class and message of an error."""
    text = message(error)
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def message(error: BaseException) -> str:
    """Return the message of an error, shortened; the error may be unable to tell it."""
    text = _safely(lambda: str(error), None)
    if not isinstance(text, str):
        return "(its message cannot be read)"
    # a terminal must not obey it, and every log must be able to encode it
    shown = "\n".join(map(escaped, text[:_LONGEST].split("\n")))
    return shown if len(text) <= _LONGEST else f"{shown}… ({len(text)} characters)"


def name_of(part: object) -> str:
    """Return the name of a component, else that of the class or the function that a part of the simulation is."""
    named: Any = part
    name = _safely(lambda: named.name(), None)
    if isinstance(name, str) and name:
        return escaped(name[:_LONGEST])
    own = _safely(lambda: named.__qualname__, None)
    return escaped(own[:_LONGEST]) if isinstance(own, str) and own else type(part).__name__


def definition(part: object) -> str:
    """Return file and line of the class or the function of a part as a line of a traceback; empty if it has none."""
    function = getattr(part, "__func__", part) if inspect.isroutine(part) else type(part)
    code = getattr(function, "__code__", None)
    if code is not None:
        return f'  File "{code.co_filename}", line {code.co_firstlineno}, in {function.__qualname__}'
    return str(_safely(lambda: _of_class(function), ""))


def _of_class(cls: Any) -> str:
    """The place of the first function of a class; no file is read, because a tick may have no descriptor for it."""
    functions = [inspect.unwrap(getattr(one, "__func__", one)) for one in vars(cls).values()]
    code = min(
        (function.__code__ for function in functions if inspect.isfunction(function)),
        key=lambda code: code.co_firstlineno,
    )
    return f'  File "{code.co_filename}", line {code.co_firstlineno}, in {cls.__name__}'


def _safely(function: Callable[[], Any], otherwise: Any) -> Any:
    """Return what a function of the user returns; otherwise something else."""
    try:
        return function()
    except KeyboardInterrupt:
        raise
    except BaseException:
        return otherwise


def _meant(error: BaseException) -> str:
    """Return the most similar attribute, if an attribute does not exist."""
    if not isinstance(error, AttributeError) or error.name is None or error.obj is None:
        return ""
    # objects of users may define __dir__
    near = _safely(lambda: closest(error.name, dir(error.obj)), None)
    return f"; did you mean '{near}'?" if near is not None else ""
