"""Distributes work over threads while C functions run without the GIL."""

from __future__ import annotations

import os
import platform
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from threading import Lock
from typing import TYPE_CHECKING
from weakref import WeakSet

from morse.kernel import targets
from morse.kernel.loading import load
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


_locks: WeakSet[Lock] = WeakSet()


def lock() -> Lock:
    """Return a lock that is free in a process that is forked while another thread holds it."""
    made = Lock()
    _locks.add(made)
    return made


def _after_fork() -> None:
    """The threads of the parent do not exist in a process that is forked: nobody would release its locks."""
    _pool.cache_clear()
    for one in list(_locks):
        one._at_fork_reinit()  # type: ignore[attr-defined]


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)

#: the level of the x86-64 psABI from which on processors fuse products and sums
_FUSES = 3


@cache
def kind() -> str:
    """Return architecture, fused products and C library, such as ``x86_64 with FMA, glibc 2.36``.

    Two machines of one kind give the same bits with the same versions of MORSE, MuJoCo, numpy and Python.
    """
    library = " ".join(part for part in platform.libc_ver() if part) or platform.system()
    return f"{platform.machine()}{_fused()}, {library}"


def _fused() -> str:
    target = targets.host()
    if target is None or len(target.levels) < 2:  # other architectures always fuse
        return ""
    try:
        level = load(target, target.levels[0]).morse_processor_level()
    except OSError:
        return ""
    return " with FMA" if level >= _FUSES else " without FMA"
