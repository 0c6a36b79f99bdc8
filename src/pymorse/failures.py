"""Callbacks of subscribers that raise: an error of each message would hide everything else that a program prints."""

from __future__ import annotations

import logging
from collections import Counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

logger = logging.getLogger("pymorse")

_STEP = 10


class Failures:
    """Logs the first failure of a callback with its traceback, and the 10th, 100th, 1000th as a number.

    Args:
        peer: returns the sender of the messages, for the log.
    """

    def __init__(self, peer: Callable[[], str]) -> None:
        self._peer = peer
        self._counts: Counter[tuple[int, type[BaseException]]] = Counter()

    def add(self, callback: Callable[..., object], error: BaseException) -> None:
        """Count a failure, and log it if it is new."""
        # not every callable has a hash
        key = (id(callback), type(error))
        self._counts[key] += 1
        count = self._counts[key]
        if count == 1:
            text = "a callback of subscribe() failed on a message of %s; more of these errors are only counted"
            logger.error(text, self._peer(), exc_info=error)
        elif _is_round(count):
            logger.error("a callback of subscribe() failed on %d messages of %s: %r", count, self._peer(), error)

    def forget(self, callback: Callable[..., object]) -> None:
        """Count the failures of a callback from 0 again."""
        for key in [key for key in self._counts if key[0] == id(callback)]:
            del self._counts[key]


def _is_round(count: int) -> bool:
    while count % _STEP == 0:
        count //= _STEP
    return count == 1
