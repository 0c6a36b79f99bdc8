"""The environment variables that configure MORSE."""

from __future__ import annotations

import difflib
import logging
import os
import socket

from morse.system import OF_MACHINE

logger = logging.getLogger(__name__)

#: smallest and largest value of variables that are numbers
_NUMBERS = {"MORSE_THREADS": (1, 256), "MORSE_SOCKET_PORT": (0, 65535)}
#: the values of variables that are words
_WORDS = {"MORSE_KERNEL": ("on", "v2", "v3")}
#: variables with paths and names
_OTHERS = (
    "MORSE_BLENDER", "MORSE_CACHE", "MORSE_IMAGE_PATH", "MORSE_NODE", "MORSE_RESOURCE_PATH", "MORSE_ROOT",
    "MORSE_SOCKET_PATH",
)  # fmt: skip
#: similarity from which on an unknown variable is a misspelt one; others belong to other programs
_SIMILAR = 0.85


def text(name: str) -> str:
    """The value of a variable without surrounding spaces; empty if it is not set."""
    return os.environ.get(name, "").strip()


def paths(name: str) -> list[str]:
    """The directories that a variable lists, separated as in ``PATH``."""
    return [entry for entry in os.environ.get(name, "").split(os.pathsep) if entry]


def whole(name: str) -> int | None:
    """A number; None if the variable is not set, or, with a warning, has an invalid value."""
    try:
        return checked_whole(name, text(name)) if text(name) else None
    except ValueError as error:
        logger.warning("%s; it is ignored", error, extra=OF_MACHINE)
        return None


def checked_whole(name: str, value: str) -> int:
    """The number that is the value of a variable.

    Raises:
        ValueError: it is not a number, or too small or too large.
    """
    low, high = _NUMBERS[name]
    if value.isascii() and value.isdecimal() and len(value) < 20 and low <= int(value) <= high:
        return int(value)
    what = "a port number" if name.endswith("_PORT") else "a number"
    raise ValueError(f"{name} is {what} from {low} to {high}, not {value[:60]!r}")


def word(name: str) -> str:
    """One of the words of a variable; empty if it is not set, or, with a warning, has another value."""
    value, words = text(name).lower(), _WORDS[name]
    if not value or value in words:
        return value
    logger.warning("%s=%r is none of %s and is ignored", name, value[:60], ", ".join(words), extra=OF_MACHINE)
    return ""


def review() -> None:
    """Warn about variables whose names are misspelt, when a simulation begins."""
    names = (*_NUMBERS, *_WORDS, *_OTHERS)
    for name in sorted(os.environ):
        if name.startswith("MORSE_") and name not in names:
            close = difflib.get_close_matches(name, names, n=1, cutoff=_SIMILAR)
            if close:
                logger.warning(
                    "the environment variable %s has no effect; did you mean %s?", name, close[0], extra=OF_MACHINE
                )


def node_name() -> str:
    """Return the name of this node: ``--name`` of ``morse run``, else ``$MORSE_NODE``, else the name of the host.

    ``morse run`` writes its option to ``$MORSE_NODE``.
    """
    return text("MORSE_NODE") or socket.gethostname()
