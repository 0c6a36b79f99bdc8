"""Distributes work over threads while C functions run without the GIL."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import TYPE_CHECKING

from morse.system import variables

if TYPE_CHECKING:
    from collections.abc import Callable

#: more threads would only wait for the memory
_MOST = 8
VARIABLE = "MORSE_THREADS"


@cache
def count() -> int:
    """Number of threads: one for each processor, at most eight, or the value of ``MORSE_THREADS``."""
    number = variables.whole(VARIABLE)
    if number is not None:
        return number
    return min(processors(), _MOST)


def processors() -> int:
    """Number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@cache
def _pool(workers: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(workers, thread_name_prefix="morse-kernel")


def together(work: Callable[[], object], pieces: int) -> None:
    """Call ``work`` in several threads at once, at most one per piece; ``work`` takes the pieces one by one."""
    workers = min(count(), pieces)
    futures = [_pool(count() - 1).submit(work) for _ in range(workers - 1)]
    work()
    # no piece is left: threads that are busy with other work need not begin
    for future in futures:
        if not future.cancel():
            future.result()
