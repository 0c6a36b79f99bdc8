"""The text file of a component."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from morse.core.exceptions import MorseMiddlewareError

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

logger = logging.getLogger(__name__)


class TextFile:
    """A text file; on a full disk, the file ends, but not the simulation.

    Args:
        path: absolute path; an existing file is overwritten.
        owner: name of the component.
        note: keeps that the file ends, in words: what, the consequence and the reason.

    Raises:
        MorseMiddlewareError: it cannot be written.
    """

    def __init__(self, path: Path, owner: str, note: Callable[[str, str, str], object]) -> None:
        self.path, self.owner, self._note = path, owner, note
        self._is_new = True
        try:
            self._file = path.open("w", encoding="utf-8", errors="backslashreplace", newline="\n")
        except OSError as error:
            raise MorseMiddlewareError(
                f"the file {path} cannot be written: {error.strerror}; set another one: file='...'"
            ) from None
        self._is_over = False

    def begin(self, header: str) -> None:
        """Write the header, unless another component of the same name has begun the file."""
        if self._is_new:
            self.write(header)
        self._is_new = False

    def write(self, text: str) -> None:
        """Write a text; an error is logged, and ends the file."""
        if not self._is_over:
            try:
                self._file.write(text)
            except OSError as error:
                self._end(error)

    def flush(self) -> None:
        """Flush the file."""
        if not self._is_over:
            try:
                self._file.flush()
            except OSError as error:
                self._end(error)

    def _end(self, error: OSError) -> None:
        self._is_over = True
        reason = f"nothing more is written to {self.path}: {error.strerror}"
        logger.error("%s: %s", self.owner, reason)
        self._note(f"the file of {self.owner}", "ends", reason)

    def close(self) -> None:
        """Write the remaining data."""
        self.flush()
        try:
            self._file.close()
        except OSError as error:
            if not self._is_over:
                self._end(error)
