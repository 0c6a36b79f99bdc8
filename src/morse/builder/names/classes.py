"""Loads component classes from class paths."""

from __future__ import annotations

import traceback
from pathlib import Path
from typing import Any

from morse.core.classes import classpath as classpaths
from morse.core.exceptions import MorseBuilderNoComponentError

#: file names of the import machinery of Python, which is between a module and its imports in a traceback
_OURS = str(Path(__file__).parents[2])


def load_class(classpath: str) -> type[Any]:
    """The class of a component, e.g. ``ranger_sim.actuators.eyes.Eyes``.

    Raises:
        MorseBuilderNoComponentError: the class does not exist, or its file has an error; the message contains the file
            and the line.
    """
    try:
        return classpaths.load_class(classpath)
    except classpaths.ClassPathError as error:
        raise MorseBuilderNoComponentError(str(error)) from None
    except Exception as error:
        raise MorseBuilderNoComponentError(_broken(classpath, error)) from error


def _broken(classpath: str, error: Exception) -> str:
    if isinstance(error, SyntaxError):
        place, message = f"{error.filename}:{error.lineno}", error.msg
    else:
        trace = traceback.extract_tb(error.__traceback__)
        frames = [f for f in trace if not f.filename.startswith(("<frozen", _OURS))] or trace
        place, message = f"{frames[-1].filename}:{frames[-1].lineno}", str(error)
    return f"the component class {classpath} cannot be loaded: {type(error).__name__}: {message} ({place})"
