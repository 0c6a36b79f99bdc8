"""Describes errors in user code by file and line, without the frames of the simulator."""

from __future__ import annotations

import traceback
from pathlib import Path
from typing import TYPE_CHECKING

from morse.core.hints import closest

if TYPE_CHECKING:
    from types import TracebackType

_OURS = Path(__file__).resolve().parents[1]


def user_frames(trace: TracebackType | None) -> list[traceback.FrameSummary]:
    """Return the frames of a traceback that do not belong to the simulator."""
    # chosen first, so that only files of users are read
    frames = [one for one in traceback.walk_tb(trace) if _is_users(one[0].f_code.co_filename)]
    return list(traceback.StackSummary.extract(iter(frames)))


def _is_users(filename: str) -> bool:
    return not Path(filename).resolve().is_relative_to(_OURS) and not filename.startswith("<frozen")


def describe(error: BaseException) -> str:
    """Return the error message, and the lines of user code that led to the error."""
    frames = user_frames(error.__traceback__)
    what = f"{type(error).__name__}: {error}{_meant(error)}" if str(error) else type(error).__name__
    if not frames:
        # the traceback does not contain user code
        return str(error) if isinstance(error, OSError) and str(error) else what
    lines = [what]
    for frame in frames:
        lines.append(f'  File "{frame.filename}", line {frame.lineno}, in {frame.name}')
        if frame.line:
            lines.append(f"    {frame.line.strip()}")
    return "\n".join(lines)


def _meant(error: BaseException) -> str:
    """Return the most similar attribute, if an attribute does not exist."""
    if not isinstance(error, AttributeError) or error.name is None or error.obj is None:
        return ""
    try:
        near = closest(error.name, dir(error.obj))
    except Exception:  # objects of users may define __dir__
        return ""
    return f"; did you mean '{near}'?" if near is not None else ""
