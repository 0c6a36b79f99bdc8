"""Warnings about a scene: all that is logged in the thread that builds, compiles or loads it.

Code that warns calls its logger, as everywhere. Within `scene_warnings`, the line of the script is put before the text,
and the warning is collected, so that no warning can be missing. The line is that of the attribute ``where`` of the
record (``extra={"where": ...}``), else that of the part of the scene that is being handled (`about`). A warning about
this computer and not about the scene, such as a port in use, says ``extra=OF_MACHINE`` (`morse.system`).
"""

from __future__ import annotations

import logging
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.scene.component import SourceLine


@dataclass(frozen=True, slots=True)
class SceneWarning:
    """A warning about a scene.

    Attributes:
        message: what is wrong, and its mend.
        where: the line of the script; None if no line has caused it.
        is_old: whether the line has an old form, which still works.
        edit: a word of the line and its replacement, if the line can be mended without a person; else empty words.
    """

    message: str
    where: SourceLine | None = None
    is_old: bool = False
    edit: tuple[str, str] = ("", "")

    def __str__(self) -> str:
        return self.message if self.where is None else f"{self.where}: {self.message}"


@dataclass(eq=False, slots=True)
class Collected:
    """The warnings of a scene, in their order.

    Attributes:
        refused: whether they are an error.
        is_complete: whether the scene is complete: further warnings are not about it.
    """

    refused: bool = False
    warnings: list[SceneWarning] = field(default_factory=list)
    is_complete: bool = False
    _keys: set[object] = field(default_factory=set)

    def complete(self) -> list[SceneWarning]:
        """The scene is complete: collect no more. Return the warnings if they are refused."""
        is_new, self.is_complete = not self.is_complete, True
        return self.warnings if self.refused and is_new else []

    def is_first(self, key: object) -> bool:
        """Whether this is the first call with a key."""
        is_first = key not in self._keys
        self._keys.add(key)
        return is_first


_collected: ContextVar[Collected | None] = ContextVar("collected", default=None)
_place: ContextVar[Callable[[], SourceLine | None] | None] = ContextVar("place", default=None)


class _Collector(logging.Handler):
    """Puts the line before a warning, and collects it. It is the first handler, so that all others see the line."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        #: finds the line of what is described outside of a scene, as in a notebook
        self.described: Callable[[], SourceLine | None] | None = None

    def emit(self, record: logging.LogRecord) -> None:
        collected = _collected.get()
        is_ours = record.levelno < logging.ERROR and not getattr(record, "of_machine", False)
        if is_ours and collected is not None and not collected.is_complete:
            collected.warnings.append(self._with_line(record, _place.get()))
        elif is_ours and collected is None and record.name.startswith("morse.builder"):
            self._with_line(record, self.described)
        # Python writes what no handler takes to the standard error
        if logging.lastResort is not None and not self._is_taken():
            logging.lastResort.handle(record)

    def _with_line(self, record: logging.LogRecord, find: Callable[[], SourceLine | None] | None) -> SceneWarning:
        where = getattr(record, "where", None) or (None if find is None else find())
        is_old, edit = getattr(record, "is_old", False), getattr(record, "edit", ("", ""))
        warning = SceneWarning(record.getMessage(), where, is_old, edit)
        record.msg, record.args, record.of_scene = str(warning), None, True
        return warning

    def _is_taken(self) -> bool:
        return len(_LOGGER.handlers) > 1 or (_LOGGER.propagate and bool(logging.getLogger().handlers))


_LOGGER = logging.getLogger("morse")
_collector = _Collector()
_LOGGER.handlers.insert(0, _collector)


def find_lines(described: Callable[[], SourceLine | None]) -> None:
    """Set the function that finds the line of the script for warnings of the builder outside of a scene."""
    _collector.described = described


@contextmanager
def scene_warnings(*, refused: bool = False) -> Iterator[Collected]:
    """Collect the warnings of this thread within the block; a block within another one belongs to it.

    Args:
        refused: whether warnings are an error: see `Collected.complete`.
    """
    present = _collected.get()
    if present is not None:
        yield present
        return
    collected = Collected(refused)
    if _collector not in _LOGGER.handlers:  # the handlers of a logger are everybody's
        _LOGGER.handlers.insert(0, _collector)
    token = _collected.set(collected)
    try:
        yield collected
    finally:
        _collected.reset(token)


@contextmanager
def silent_log() -> Iterator[None]:
    """Within the block, the log of MORSE is only collected."""
    handlers, propagate = _LOGGER.handlers, _LOGGER.propagate
    _LOGGER.handlers, _LOGGER.propagate = [_collector, logging.NullHandler()], False
    try:
        yield
    finally:
        _LOGGER.handlers, _LOGGER.propagate = handlers, propagate


@contextmanager
def about(place: SourceLine | Callable[[], SourceLine | None] | None) -> Iterator[None]:
    """Let the warnings within the block have a line; None leaves that of the block around it.

    Args:
        place: the line, or a function that returns it when a warning is logged.
    """
    if place is None:
        yield
        return
    token = _place.set(place if callable(place) else lambda: place)
    try:
        yield
    finally:
        _place.reset(token)


def is_first(key: object, *, otherwise: bool) -> bool:
    """Whether this is the first call with a key while the present scene is built; otherwise something else."""
    collected = _collected.get()
    return otherwise if collected is None else collected.is_first(key)


class WarningCount(logging.Handler):
    """Counts the warnings of the log, while it is a handler of the logger ``morse``."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self._of_scene = self._others = 0

    def emit(self, record: logging.LogRecord) -> None:
        """See `logging.Handler`."""
        if record.levelno < logging.ERROR:
            of_scene = getattr(record, "of_scene", False)
            self._of_scene += of_scene
            self._others += not of_scene

    def __str__(self) -> str:
        count = self._of_scene + self._others
        about_scene = f", {self._of_scene} about the scene" if self._of_scene else ""
        return f"{count} warning{'' if count == 1 else 's'}{about_scene}"
