"""The memory that a client may occupy, in bytes."""

from __future__ import annotations

import threading

CLIENT_BYTES = 14 << 20
"""Maximum size of everything that is kept for one client: what it has sent and asked for, and what it has not read."""
ENTRY = 512
"""Size of an entry of a table, or of a pending request, in addition to its texts."""
PARSED = 32
"""Maximum size of parsed JSON, or of a parsed bottle, as a multiple of its bytes: an empty object has three bytes."""


class OverBudget(ValueError):
    """A client wants to occupy more memory than it may."""


class Budget:
    """A number of bytes that a client, or several clients together, may occupy; for any thread.

    Attributes:
        left: bytes that are not occupied; negative if `force` has taken more.
    """

    def __init__(self, size: int = CLIENT_BYTES) -> None:
        self.size = self.left = size
        self._lock = threading.Lock()

    def take(self, count: int) -> bool:
        """Reserve bytes; False if fewer are left."""
        with self._lock:
            if count > self.left:
                return False
            self.left -= count
            return True

    def force(self, count: int) -> bool:
        """Reserve bytes in any case; returns whether that many were left."""
        with self._lock:
            self.left -= count
            return self.left >= 0

    def give(self, count: int) -> None:
        """Release reserved bytes."""
        with self._lock:
            self.left += count

    def charge(self, count: int, what: str) -> None:
        """Reserve bytes.

        Args:
            count: of bytes.
            what: for the message: what is refused.

        Raises:
            OverBudget: fewer are left.
        """
        if not self.take(count):
            raise OverBudget(
                f"{what} is refused: it takes {count} bytes, and {max(0, self.left)} of {self.size} bytes for one "
                "client are left"
            )
