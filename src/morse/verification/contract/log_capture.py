"""The log of a simulation during the check of a component."""

from __future__ import annotations

import logging
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import TracebackType


class LogCapture(logging.Handler):
    """Collects the errors of the simulation, so that they are not printed; used as a context manager."""

    def __init__(self) -> None:
        super().__init__(logging.ERROR)
        self._errors: list[str] = []
        self._listens = True
        self._before: tuple[bool, list[logging.Handler]] = (True, [])

    def emit(self, record: logging.LogRecord) -> None:
        """See `logging.Handler`."""
        if self._listens:
            self._errors.append(record.getMessage())

    def take(self) -> list[str]:
        """The errors since the last call."""
        errors, self._errors = self._errors, []
        return errors

    def last(self, otherwise: str) -> str:
        """The last error; clears the list."""
        errors = self.take()
        return errors[-1] if errors else otherwise

    @contextmanager
    def unheard(self) -> Iterator[None]:
        """Ignore errors in the block."""
        self._listens = False
        try:
            yield
        finally:
            self._listens = True

    def __enter__(self) -> LogCapture:
        logger = logging.getLogger("morse")
        self._before = logger.propagate, logger.handlers[:]
        logger.propagate, logger.handlers[:] = False, [self]
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        logger = logging.getLogger("morse")
        logger.propagate, logger.handlers[:] = self._before
