"""A file that a component is written to."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from morse.core.exceptions import MorseMiddlewareError

if TYPE_CHECKING:
    from pathlib import Path

logger = logging.getLogger(__name__)


class TextFile:
    """A text file; a full disk ends the file, and not the simulation.

    Args:
        path: absolute path; what is there already is replaced.
        owner: name of the component.

    Raises:
        MorseMiddlewareError: it cannot be written.
    """

    def __init__(self, path: Path, owner: str) -> None:
        self.path, self.owner = path, owner
        self._is_new = True
        try:
            self._file = path.open("w", encoding="utf-8", errors="backslashreplace", newline="\n")
        except OSError as error:
            raise MorseMiddlewareError(
                f"the file {path} cannot be written: {error.strerror}; say another one: file='...'"
            ) from None
        self._is_over = False

    def begin(self, header: str) -> None:
        """Write the header, unless the file goes on with another component of the same name."""
        if self._is_new:
            self.write(header)
        self._is_new = False

    def write(self, text: str) -> None:
        """Write a text; if that fails, the log says so, and nothing more is written."""
        if not self._is_over:
            try:
                self._file.write(text)
            except OSError as error:
                self._end(error)

    def flush(self) -> None:
        """Let other programs see what has been written."""
        if not self._is_over:
            try:
                self._file.flush()
            except OSError as error:
                self._end(error)

    def _end(self, error: OSError) -> None:
        self._is_over = True
        logger.error("%s: nothing more is written to %s: %s", self.owner, self.path, error.strerror)

    def close(self) -> None:
        """Write what is left."""
        self.flush()
        try:
            self._file.close()
        except OSError as error:
            if not self._is_over:
                self._end(error)
