"""What reading one file may cost: one budget for it and for all files that it refers to.

The limits of a single part (a picture, a mesh, a chunk) are with its reader. A small file can have any number of parts:
what they take together is counted here.
"""

from __future__ import annotations

import time
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterator

    from morse.system.workers import Worker

#: bytes that are read from files; each file of a model is read one to three times
MOST_BYTES = 8 << 30
#: pixels of pictures that are decoded, each by its cost; about 10 ns each
MOST_PIXELS = 1 << 31
#: files that are searched by different names, each in about 0.5 ms
MOST_SEARCHES = 20_000
#: wall-clock time for pictures that a process decodes, all and one of them, s; its memory, bytes
MOST_SECONDS, PATIENCE, MOST_MEMORY = 40.0, 15.0, 512 << 20
_Result = TypeVar("_Result")
_DECODER = "morse.system.picture_program"


class BudgetError(ValueError):
    """The parts of a file cost more than one file may; the message says which."""


class Budget:
    """What remains for the parts of a file."""

    def __init__(self) -> None:
        self._bytes, self._pixels, self._seconds = MOST_BYTES, MOST_PIXELS, MOST_SECONDS
        self._decoder: Worker | None = None
        self._searches = MOST_SEARCHES
        self._known: dict[tuple[Hashable, ...], Any] = {}

    def once(self, key: tuple[Hashable, ...], make: Callable[[], Any]) -> Any:
        """The result of a function, which is called once for each key."""
        if key not in self._known:
            self._known[key] = make()
        return self._known[key]

    def take_search(self) -> None:
        """Count a file that is searched.

        Raises:
            BudgetError: there are too many.
        """
        self._searches -= 1
        if self._searches < 0:
            raise BudgetError(f"the model refers to more than {MOST_SEARCHES:,} files")

    def take_bytes(self, count: int) -> None:
        """Count bytes that are read.

        Raises:
            BudgetError: there are too many.
        """
        self._bytes -= count
        if self._bytes < 0:
            raise BudgetError(f"the files of the model have more than {MOST_BYTES >> 30} GiB together")

    def take_pixels(self, count: int) -> None:
        """Count pixels that are decoded.

        Raises:
            BudgetError: there are too many.
        """
        self._pixels -= count
        if self._pixels < 0:
            raise BudgetError(f"the pictures of the model have more than {MOST_PIXELS} pixels together")

    def decoded(self, data: bytes) -> bytes:
        """The answer of `morse.system.picture_program` to the content of a file.

        Raises:
            BudgetError: its process has ended: it has needed too much time or memory.
            OSError: it cannot be started.
        """
        if self._seconds <= 0.0:
            raise BudgetError(f"decoding the pictures of the model takes more than {MOST_SECONDS:g} s")
        # imported on demand, because few files have such pictures
        from morse.system.workers import Worker, WorkerError, bare_environment

        if self._decoder is None:
            self._decoder = Worker.program(_DECODER, bare_environment(), is_silent=True)
        begin = time.monotonic()
        try:
            return self._decoder.ask(data, PATIENCE)
        except WorkerError:
            self.close()
            raise BudgetError(f"decoding it takes more than {PATIENCE:g} s, or more memory than it may") from None
        finally:
            self._seconds -= time.monotonic() - begin

    def close(self) -> None:
        """End the process that decodes."""
        if self._decoder is not None:
            self._decoder.close()
            self._decoder = None


_budget: ContextVar[Budget | None] = ContextVar("budget", default=None)


@contextmanager
def budget_of_file() -> Iterator[Budget]:
    """The budget of the file that is being read; within the block, files that are read as its parts share it."""
    present = _budget.get()
    if present is not None:
        yield present
        return
    budget = Budget()
    token = _budget.set(budget)
    try:
        yield budget
    finally:
        _budget.reset(token)
        budget.close()


def take_bytes(count: int) -> None:
    """Count bytes that are read for the file that is being read, if there is one; see `Budget.take_bytes`."""
    budget = _budget.get()
    if budget is not None:
        budget.take_bytes(count)


def take_search() -> None:
    """Count a file that is searched for the file that is being read, if there is one; see `Budget.take_search`."""
    budget = _budget.get()
    if budget is not None:
        budget.take_search()


def once_for_file(make: Callable[[], _Result], *key: Hashable) -> _Result:
    """The result of a search: for one file that is read, with all its parts, the disk is searched once for each key."""
    budget = _budget.get()
    if budget is None:
        return make()
    result: _Result = budget.once(key, make)
    return result
