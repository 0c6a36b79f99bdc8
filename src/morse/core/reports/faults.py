"""Describes errors in user code by file and line, without the frames of the simulator.

The error itself may be hostile: its methods may raise, or return any amount of text.
"""

from __future__ import annotations

import inspect
import sysconfig
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeGuard, TypeVar

import morse
from morse.core.reports.quoting import closest, escaped
from morse.system.source_text import source_line

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType, TracebackType

_T = TypeVar("_T")
_OURS = Path(morse.__file__).resolve().parent
#: the folder of the standard library; packages may be installed in a folder of it
_PYTHON, _PACKAGES = Path(sysconfig.get_path("stdlib")).resolve(), {"site-packages", "dist-packages"}
#: largest number of characters of the message of an error, and of lines of user code that led to it
_LONGEST, _MOST_LINES = 2000, 12
#: what ends a program is not a fault of the part that raises it
ENDINGS = (KeyboardInterrupt, SystemExit)


def user_frames(trace: TracebackType | None) -> list[traceback.FrameSummary]:
    """Return the frames of a traceback that belong neither to the simulator nor to Python."""
    # chosen first, so that only files of users are read
    return _read([one for one in traceback.walk_tb(trace) if is_users(one[0].f_code.co_filename)])


def is_users(filename: str) -> bool:
    """Whether a file belongs neither to the simulator nor to Python."""
    try:
        return not Path(filename).resolve().is_relative_to(_OURS) and not is_of_python(filename)
    except (OSError, ValueError, RuntimeError):
        return True


def is_of_python(filename: str) -> bool:
    """Whether a file belongs to the standard library of Python.

    Raises:
        OSError, ValueError, RuntimeError: it is no name of a file.
    """
    if filename.startswith("<frozen"):
        return True
    file = Path(filename).resolve()
    return file.is_relative_to(_PYTHON) and _PACKAGES.isdisjoint(file.relative_to(_PYTHON).parts)


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
    frames = user_frames(trace_of(error))
    if not frames:
        # the traceback does not contain user code
        text = message(error)
        return text if is_a(error, OSError) and text else summary(error)
    return "\n".join([f"{summary(error)}{_meant(error)}", *_lines(frames)])


def place(error: BaseException) -> str:
    """Return the innermost line of user code that led to an error, else the innermost line of all."""
    frames = user_frames(trace_of(error)) or _read(list(traceback.walk_tb(trace_of(error)))[-1:])
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
    text, name = message(error), class_name(type(error))
    return f"{name}: {text}" if text else name


def class_name(cls: type) -> str:
    """Return the name of a class, whose metaclass may be unable to tell it."""
    return str(type.__dict__["__name__"].__get__(cls))


def is_a(part: object, classes: type[_T] | tuple[type[_T], ...]) -> TypeGuard[_T]:
    """Whether an object is of a class; `isinstance` would ask the object, which may raise."""
    return issubclass(type(part), classes)


def attribute(part: object, name: str, otherwise: object = None) -> Any:
    """Return an attribute of an object of the user; otherwise something else."""
    return _safely(lambda: getattr(part, name, otherwise), otherwise)


def trace_of(error: BaseException) -> TracebackType | None:
    """Return the traceback of an error, whose attributes may raise."""
    trace: TracebackType | None = BaseException.__dict__["__traceback__"].__get__(error)
    return trace


def message(error: BaseException) -> str:
    """Return the message of an error, shortened; the error may be unable to tell it."""
    text = _safely(lambda: str(error), None)
    if type(text) is not str:
        return "(its message cannot be read)"
    # a terminal must not obey it, and every log must be able to encode it
    text_shown = "\n".join(map(escaped, text[:_LONGEST].split("\n")))
    return text_shown if len(text) <= _LONGEST else f"{text_shown}… ({len(text)} characters)"


def name_of(part: object) -> str:
    """Return the name of a component, else that of the class or the function that a part of the simulation is."""
    owner: Any = part
    name = _safely(lambda: owner.name(), None)
    if type(name) is str and name:
        return escaped(name[:_LONGEST])
    own = _safely(lambda: owner.__qualname__, None)
    return escaped(own[:_LONGEST] if type(own) is str and own else class_name(type(part)))


def definition(part: object) -> str:
    """Return file and line of the class or the function of a part as a line of a traceback; empty if it has none."""
    found = _defined_at(part)
    return "" if found is None else f'  File "{found[0]}", line {found[1]}, in {found[2]}'


def line_of_fault(part: object, error: BaseException) -> str:
    """Return file and line of a fault, as in ``scene.py:12``; empty if they are not known.

    It is the innermost line of user code that led to the error, else that of the class or the function of the part if
    it is the user's, else the innermost line of all.
    """
    frames = user_frames(trace_of(error))
    if not frames:
        found = _defined_at(part)
        if found is not None and is_users(found[0]):
            return f"{found[0]}:{found[1]}"
        frames = _read(list(traceback.walk_tb(trace_of(error))))
    return f"{frames[-1].filename}:{frames[-1].lineno}" if frames else ""


def _defined_at(part: object) -> tuple[str, int, str] | None:
    """Return the file, the line and the name of the class or the function of a part; None if it has none."""
    function: Any = type(part)
    if _safely(lambda: inspect.isroutine(part), False):
        function = attribute(part, "__func__", part)
    code = attribute(function, "__code__")
    if code is not None:
        return code.co_filename, code.co_firstlineno, str(function.__qualname__)
    found: tuple[str, int, str] | None = _safely(lambda: _of_class(function), None)
    return found


def _of_class(cls: Any) -> tuple[str, int, str]:
    """The place of the first function of a class; no file is read, because a tick may have no descriptor for it."""
    functions = [inspect.unwrap(getattr(one, "__func__", one)) for one in vars(cls).values()]
    code = min(
        (function.__code__ for function in functions if inspect.isfunction(function)),
        key=lambda code: code.co_firstlineno,
    )
    return code.co_filename, code.co_firstlineno, class_name(cls)


def _safely(function: Callable[[], object], otherwise: object) -> Any:
    """Return what a function of the user returns; otherwise something else."""
    try:
        return function()
    except KeyboardInterrupt:
        raise
    except BaseException:
        return otherwise


def _meant(error: BaseException) -> str:
    """Return the most similar attribute, if an attribute does not exist."""
    if not is_a(error, AttributeError):
        return ""
    name, owner = attribute(error, "name"), attribute(error, "obj")
    if type(name) is not str or owner is None:
        return ""
    # objects of users may define __dir__
    near = _safely(lambda: closest(name, dir(owner)), None)
    return f"; did you mean '{near}'?" if near is not None else ""
