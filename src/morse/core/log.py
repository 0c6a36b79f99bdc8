"""What the simulator says on its standard output: levels, form and colours.

A line reads ``[    0.283] text``: seconds since the process started (since `logging` was imported),
then the text. Loggers are
named ``morse.<something>``; the last two parts of a name stand before the text, as in
``[    0.283] [actuators.eyes] robot.eyes initialization``. Errors carry no time stamp, and a
section is announced by its title alone: other programs read these lines, so their form is fixed.
"""

from __future__ import annotations

import itertools
import logging
import sys
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from collections.abc import Iterator

SECTION = 25
"""Level of the title of a phase of the simulation, e.g. ``[SCENE INITIALIZATION]``."""
ENDSECTION = 23
"""Level of the line that ends a phase."""

logging.addLevelName(SECTION, "SECTION")
logging.addLevelName(ENDSECTION, "ENDSECTION")

_MAIN_LOGGERS = frozenset({"morse", "morse.main", "blender.main"})
_TITLES = logging.getLogger("morse.main")

_RESET = "\033[0m"
_BRIGHT = {
    logging.DEBUG: "\033[90m",
    ENDSECTION: "\033[1;92m",
    SECTION: "\033[1;92m",
    logging.WARNING: "\033[93m",
    logging.ERROR: "\033[91m",
    logging.CRITICAL: "\033[1;91m",
}
_DARK = {
    logging.DEBUG: "\033[37m",
    ENDSECTION: "\033[1;32m",
    SECTION: "\033[1;32m",
    logging.WARNING: "\033[35m",
    logging.ERROR: "\033[31m",
    logging.CRITICAL: "\033[1;31m",
}
_XMAS = ("\033[91m", "\033[92m")

COLOR_SCHEMES = ("mono", "bright", "dark", "xmas")
"""No colours; for a dark terminal; for a light one; for the days after Christmas."""


class MorseFormatter(logging.Formatter):
    """Gives a record the form of the simulator's log.

    Args:
        colors: one of `COLOR_SCHEMES`.

    Raises:
        ValueError: for an unknown colour scheme.
    """

    def __init__(self, colors: str = "mono") -> None:
        super().__init__("%(message)s")
        if colors not in COLOR_SCHEMES:
            raise ValueError(f"unknown colour scheme '{colors}'; there are {', '.join(COLOR_SCHEMES)}")
        self.colors = colors
        self._xmas: Iterator[str] = itertools.cycle(_XMAS)

    def format(self, record: logging.LogRecord) -> str:
        """The line (or lines, with a traceback) of a record, without the newline at its end."""
        text = super().format(record)
        if record.levelno == SECTION:
            return "\n" + self._colored(record.levelno, f"[{text}]")
        if record.levelno == ENDSECTION:
            return self._colored(record.levelno, f"[{text}]")
        if record.name not in _MAIN_LOGGERS:
            text = f"[{'.'.join(record.name.split('.')[-2:])}] {text}"
        if record.levelno < logging.ERROR:
            text = f"[{record.relativeCreated / 1000.0:9.3f}] {text}"
        return self._colored(record.levelno, text)

    def _colored(self, level: int, text: str) -> str:
        if self.colors == "mono":
            return text
        if self.colors == "xmas":
            return next(self._xmas) + text + _RESET
        color = (_BRIGHT if self.colors == "bright" else _DARK).get(level)
        return text if color is None else color + text + _RESET


class _ConsoleHandler(logging.StreamHandler[TextIO]):
    """Writes to whatever ``sys.stdout`` is at the time, one flush a record."""

    def __init__(self) -> None:
        logging.Handler.__init__(self)

    @property
    def stream(self) -> TextIO:  # type: ignore[override]
        return sys.stdout

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802 (the name is logging's)
        # the reader of a pipe (`morse run | head`) may leave: that is no reason to disturb the simulation
        if not isinstance(sys.exc_info()[1], (BrokenPipeError, ValueError)):
            super().handleError(record)


_handler: _ConsoleHandler | None = None


def setup(colors: str | None = None, level: int | str | None = None) -> None:
    """Send the log of everything below ``morse`` to the standard output.

    May be called again: what is not given stays as it is (at first: no colours, level INFO).

    Args:
        colors: one of `COLOR_SCHEMES`; used only if the standard output is a terminal.
        level: of the logger ``morse``, as a number or a name.

    Raises:
        ValueError: for an unknown colour scheme or level.
    """
    global _handler
    root = logging.getLogger("morse")
    if _handler is None:
        _handler = _ConsoleHandler()
        root.setLevel(logging.INFO)
        root.propagate = False
    if colors is not None or _handler.formatter is None:
        _handler.setFormatter(MorseFormatter(colors if colors is not None and sys.stdout.isatty() else "mono"))
    if _handler not in root.handlers:
        root.addHandler(_handler)
    if level is not None:
        root.setLevel(level)
    # what a script prints has to stay in order with the log, and no name may be lost to an ASCII terminal
    if reconfigure := getattr(sys.stdout, "reconfigure", None):
        reconfigure(line_buffering=True, errors="backslashreplace")


def section(title: str) -> None:
    """Announce a phase of the simulation: an empty line and ``[TITLE]``."""
    _TITLES.log(SECTION, "%s", title)


def endsection(title: str) -> None:
    """Say that a phase has ended: ``[TITLE]``."""
    _TITLES.log(ENDSECTION, "%s", title)
