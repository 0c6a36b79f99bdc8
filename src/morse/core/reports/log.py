"""The log of the simulator on the standard output: levels, format and colours.

A line reads ``[    0.283] text``: seconds since the process started (since `logging` was imported), then the text.
Loggers are named ``morse.<something>``; the last two parts of a name are printed before the text, as in ``[ 0.283]
[actuators.eyes] robot.eyes initialization``. Without colours, the text of a warning begins with ``WARNING``. Errors
have no time stamp, and the title of a section is a line by itself.
The format is fixed, because other programs parse these lines.
"""

from __future__ import annotations

import atexit
import contextlib
import itertools
import logging
import re
import sys
import threading
import time
import traceback
from typing import TYPE_CHECKING, Any, Protocol, TextIO
from weakref import WeakSet

from morse.core.reports.printing import echo, harmless_paragraph

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


PERIOD = 10.0
"""Wall-clock time in which equal lines are counted, s."""

#: equal lines in a period that are written, from warnings on and below: a component may log a line in each tick
_MOST_WARNINGS, _MOST_OTHERS = 10, 1000
#: number of different lines that are told apart, and the compared length
_MOST_KINDS, _COMPARED = 256, 200
_NUMBER = re.compile(r"0[xX][0-9a-fA-F]+|\d+(?:\.\d+)?(?:[eE][+-]?\d+)?")
#: wall-clock seconds between two looks at the counts
_LOOK = 1.0


class Counting(Protocol):
    """Something that counts what it does not log."""

    def tell(self, *, now: bool) -> bool:
        """Log the counts whose period is over, or all ``now``; False if none are left."""


class _Teller:
    """Lets the counts be told after their periods, and at the end of the process."""

    def __init__(self) -> None:
        self._counting: WeakSet[Counting] = WeakSet()
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None
        atexit.register(self._tell, now=True)

    def remind(self, counting: Counting) -> None:
        """Call ``counting.tell`` later."""
        with self._lock:
            self._counting.add(counting)
            if self._thread is not None and self._thread.is_alive():
                return
            self._thread = threading.Thread(target=self._look, name="morse-log", daemon=True)
        try:
            self._thread.start()
        except RuntimeError:
            self._thread = None  # no thread can be started: the end of the process tells the counts

    def _look(self) -> None:
        while True:
            time.sleep(_LOOK)
            self._tell(now=False)
            with self._lock:
                if not self._counting:
                    self._thread = None
                    return

    def _tell(self, *, now: bool) -> None:
        with self._lock:
            counting = list(self._counting)
        for one in counting:
            if not one.tell(now=now):
                with self._lock:
                    self._counting.discard(one)


TELLER = _Teller()
"""That of the process."""


class Folding(logging.Filter):
    """Passes the first lines of a kind in a period, counts the others, and logs their number at the end of the period.

    Lines are of one kind if they are equal but for numbers.

    Args:
        handler: writes the lines; this filter is added to it.
        clock: wall-clock time, s.
    """

    def __init__(self, handler: logging.Handler, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__()
        self._handler, self._clock = handler, clock
        self._lock = threading.Lock()
        #: begin of the period, number of lines, and the last line that was not written
        self._kinds: dict[tuple[str, int, str], tuple[float, int, logging.LogRecord | None]] = {}
        handler.addFilter(self)

    def filter(self, record: logging.LogRecord) -> bool:
        """See `logging.Filter`."""
        if getattr(record, "is_count", False):
            return True
        now = self._clock()
        kind = (record.name, record.levelno, _NUMBER.sub("0", _beginning(record)))
        most = _MOST_WARNINGS if record.levelno >= logging.WARNING else _MOST_OTHERS
        with self._lock:
            begin, count, _ = self._kinds.get(kind, (now, 0, None))
            is_over = now - begin >= PERIOD
        if is_over:
            self._tell_kind(kind)
            begin, count = now, 0
        with self._lock:
            if kind not in self._kinds and len(self._kinds) >= _MOST_KINDS:
                self._forget(now)
                if len(self._kinds) >= _MOST_KINDS:
                    kind = (record.name, record.levelno, "")  # they are counted together
                    begin, count, _ = self._kinds.get(kind, (now, 0, None))
            count += 1
            self._kinds[kind] = (begin, count, record if count > most else None)
        if count > most:
            TELLER.remind(self)
            return False
        return True

    def tell(self, *, now: bool) -> bool:
        """See `Counting`."""
        time = self._clock()
        with self._lock:
            kinds = [kind for kind, (begin, _, last) in self._kinds.items() if last and (now or time - begin >= PERIOD)]
        for kind in kinds:
            self._tell_kind(kind)
        with self._lock:
            return any(last is not None for _, _, last in self._kinds.values())

    def _tell_kind(self, kind: tuple[str, int, str]) -> None:
        with self._lock:
            begin, count, last = self._kinds.pop(kind, (0.0, 0, None))
        if last is None:
            return
        most = _MOST_WARNINGS if last.levelno >= logging.WARNING else _MOST_OTHERS
        seconds = max(1, round(self._clock() - begin))
        text = f"{_beginning(last)} (repeated {count - most} times in {seconds} s)"
        record = logging.LogRecord(last.name, last.levelno, last.pathname, last.lineno, text, None, None)
        record.is_count = True
        self._handler.handle(record)

    def _forget(self, now: float) -> None:
        for kind, (begin, _, last) in list(self._kinds.items()):
            if last is None and now - begin >= PERIOD:
                del self._kinds[kind]


def _beginning(record: logging.LogRecord) -> str:
    try:
        text = record.getMessage()
    except Exception:  # the handler reports wrong arguments
        text = str(record.msg)
    return text.partition("\n")[0][:_COMPARED]


SECTION = 25
"""Level of the title of a phase of the simulation, e.g. ``[SCENE INITIALIZATION]``."""
ENDSECTION = 23
"""Level of the line that ends a phase."""

logging.addLevelName(SECTION, "SECTION")
logging.addLevelName(ENDSECTION, "ENDSECTION")

LEVELS = ("DEBUG", "INFO", "WARNING", "ERROR", "CRITICAL")
"""Levels that users can set."""

#: limits of the length and depth of logger names, because loggers use memory until the process ends
_MAX_NAME, _MAX_DEPTH = 128, 8
_NAME = re.compile(r"[^\W.][\w-]*(\.[^\W.][\w-]*)*")

#: largest number of characters of a message
_LONGEST = 1 << 14
#: loggers of others whose lines belong to the log: what asyncio and websockets say about connections of clients
_OTHERS = ("asyncio", "websockets")

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


def _cut(text: str) -> str:
    """Cut a text that nobody reads to its end, and append its length."""
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}… ({len(text)} characters)"


class MorseFormatter(logging.Formatter):
    """Formats records for the log of the simulator.

    Args:
        colors: one of `COLOR_SCHEMES`.
        names_warnings: whether the text of a warning begins with ``WARNING``.

    Raises:
        ValueError: for an unknown colour scheme.
    """

    def __init__(self, colors: str = "mono", *, names_warnings: bool = False) -> None:
        super().__init__("%(message)s")
        if colors not in COLOR_SCHEMES:
            raise ValueError(f"unknown colour scheme '{colors}'; expected one of {', '.join(COLOR_SCHEMES)}")
        self.colors, self._names_warnings = colors, names_warnings
        self._xmas: Iterator[str] = itertools.cycle(_XMAS)

    def format(self, record: logging.LogRecord) -> str:
        """The line (or lines, with a traceback) of a record, without the newline at its end."""
        text = super().format(record)
        if record.levelno == SECTION:
            return "\n" + self._colored(record.levelno, f"[{text}]")
        if record.levelno == ENDSECTION:
            return self._colored(record.levelno, f"[{text}]")
        if record.levelno == logging.WARNING and self._names_warnings:
            text = f"WARNING {text}"
        if record.name not in _MAIN_LOGGERS:
            text = f"[{'.'.join(record.name.split('.')[-2:])}] {text}"
        if record.levelno < logging.ERROR:
            text = f"[{record.relativeCreated / 1000.0:9.3f}] {text}"
        return self._colored(record.levelno, text)

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802 (the name is logging's)
        """The text of a record, without its traceback."""
        return harmless_paragraph(_cut(super().formatMessage(record)))

    def formatException(self, ei: Any) -> str:  # noqa: N802
        """Return a traceback, escaped, because the message of the exception may contain anything."""
        return "\n".join(harmless_paragraph(_cut(part.rstrip("\n"))) for part in traceback.format_exception(*ei))

    def _colored(self, level: int, text: str) -> str:
        if self.colors == "mono":
            return text
        if self.colors == "xmas":
            return next(self._xmas) + text + _RESET
        color = (_BRIGHT if self.colors == "bright" else _DARK).get(level)
        return text if color is None else color + text + _RESET


class _ConsoleHandler(logging.StreamHandler[TextIO]):
    """Writes to the present ``sys.stdout``, and flushes after each record."""

    def __init__(self) -> None:
        logging.Handler.__init__(self)
        self.has_complained = False
        Folding(self)

    @property
    def stream(self) -> TextIO:  # type: ignore[override]
        return sys.stdout

    def emit(self, record: logging.LogRecord) -> None:
        # a process may be started with its standard output closed
        if sys.stdout is not None:
            super().emit(record)

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802 (the name is logging's)
        error = sys.exc_info()[1]
        # the reader of a pipe (`morse run | head`) may exit, which must not affect the simulation
        if isinstance(error, BrokenPipeError):
            return
        is_closed = getattr(sys.stdout, "closed", False)
        if not isinstance(error, OSError) and not is_closed:
            super().handleError(record)
        elif not self.has_complained:
            self.has_complained = True
            why = "the standard output was closed" if is_closed else getattr(error, "strerror", None) or error
            complain(f"the log can no longer be written: {why}")


def is_lost() -> bool:
    """Whether a part of the log could not be written, and this has been said."""
    return _handler is not None and _handler.has_complained


def complain(text: str) -> None:
    """Write a line to the standard error, if it is open."""
    with contextlib.suppress(OSError, ValueError, AttributeError):
        echo(f"* {text}", err=True)


_handler: _ConsoleHandler | None = None


def setup(colors: str | None = None, level: int | str | None = None) -> None:
    """Send the log of everything below ``morse`` to the standard output.

    It may be called again: arguments that are None leave the setting unchanged (initially: no colours, level INFO).

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
        is_colored = colors is not None and sys.stdout is not None and sys.stdout.isatty()
        seen = colors if is_colored and colors is not None else "mono"
        _handler.setFormatter(MorseFormatter(seen, names_warnings=seen == "mono"))
    if _handler not in root.handlers:
        root.addHandler(_handler)
    for name in _OTHERS:
        other = logging.getLogger(name)
        if _handler not in other.handlers:
            other.addHandler(_handler)
    if level is not None:
        root.setLevel(level)
    # keeps the output of scripts in order with the log, and escapes names that an ASCII terminal cannot show
    if reconfigure := getattr(sys.stdout, "reconfigure", None):
        reconfigure(line_buffering=True, errors="backslashreplace")


class _PlainFormatter(logging.Formatter):
    def __init__(self, mark: str = "") -> None:
        super().__init__()
        self._mark = mark

    def format(self, record: logging.LogRecord) -> str:
        return self._mark + harmless_paragraph(_cut(super().format(record)))


if logging.lastResort is not None:
    # prints the warnings of a program that has not set up a log
    logging.lastResort.setFormatter(_PlainFormatter())


def log_plainly(level: int = logging.INFO) -> None:
    """Send the log of a program beside the simulator to the standard error, a line a message."""
    handler = logging.StreamHandler()
    handler.setFormatter(_PlainFormatter("* "))
    logging.basicConfig(level=level, handlers=[handler])


def set_level(component: str, level: str) -> None:
    """Set the log level of a part of the simulator.

    Args:
        component: name of a logger, with or without ``morse.`` before it: ``core.request_manager``. The name of a
            package (``core``) stands for all of its modules.
        level: ``debug``, ``info``, ``warning``, ``error`` or ``critical``; case is ignored.

    Raises:
        ValueError: the level does not exist, or ``component`` is not a dotted name.
    """
    if level.upper() not in (*LEVELS, "SECTION", "ENDSECTION"):
        raise ValueError(f"there is no log level {level!r:.80}: expected one of {', '.join(LEVELS).lower()}")
    name = component.removeprefix("morse.")
    if not is_component(name):
        raise ValueError(f"{component!r:.80} is not a name of a logger, such as core.request_manager")
    logging.getLogger("morse" if name == "morse" else f"morse.{name}").setLevel(level.upper())


def is_component(name: str) -> bool:
    """Whether a text is a dotted name, as those of loggers are, with or without ``morse.`` before it."""
    name = name.removeprefix("morse.")
    return len(name) <= _MAX_NAME and name.count(".") < _MAX_DEPTH and _NAME.fullmatch(name) is not None


def known_components() -> set[str]:
    """Return the names that `set_level` knows: loggers below ``morse``, loaded modules and packages."""
    names = {name.removeprefix("morse.") for name in list(sys.modules)}
    names |= {name[6:] for name in list(logging.root.manager.loggerDict) if name.startswith("morse.")}
    return names


def section(title: str) -> None:
    """Announce a phase of the simulation: an empty line and ``[TITLE]``."""
    _TITLES.log(SECTION, "%s", title)


def endsection(title: str) -> None:
    """Announce the end of a phase: ``[TITLE]``."""
    _TITLES.log(ENDSECTION, "%s", title)
