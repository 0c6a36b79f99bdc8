"""Waiting for what other threads and processes do: until a condition holds, with a limit of wall-clock time."""

import asyncio
import time
from collections.abc import Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

#: s; much more than a loaded machine needs
LIMIT = 60.0

_T = TypeVar("_T")


def wait_until(condition: Callable[[], _T], what: str = "", limit: float = LIMIT) -> _T:
    """Wait until a condition holds, and return its value.

    Args:
        what: what is expected, for the message.
        limit: s.

    Raises:
        AssertionError: the condition does not hold within the limit.
    """
    end, pause = time.monotonic() + limit, 0.001
    while not (value := condition()):
        assert time.monotonic() < end, f"not within {limit:g} s: {what or condition}"
        time.sleep(pause)
        # each question may take time from what is waited for
        pause = min(1.5 * pause, 0.05)
    return value


def step_until(simulation: Any, condition: Callable[[], object], what: str = "", limit: float = LIMIT) -> None:
    """Step a simulation once, and until a condition holds.

    Raises:
        AssertionError: the condition does not hold within the limit.
    """
    end = time.monotonic() + limit
    simulation.step()
    while not condition():
        assert time.monotonic() < end, f"not within {limit:g} s: {what or condition}"
        time.sleep(0.001)  # the other threads need the lock of the interpreter
        simulation.step()


def run_apart(coroutine: Coroutine[Any, Any, _T]) -> _T:
    """Run a coroutine in another thread: the loop of Playwright may run in this one, after a test with a browser."""
    with ThreadPoolExecutor(1) as threads:
        return threads.submit(asyncio.run, coroutine).result()
