"""A thread that encodes and sends messages, so that the tick does not wait for them."""

from __future__ import annotations

import logging
import queue
import threading
from typing import TYPE_CHECKING, Any

from morse.core.reports.faults import describe

if TYPE_CHECKING:
    from collections.abc import Callable

logger = logging.getLogger(__name__)

#: number of messages that wait; a tick with more of them waits, because none is dropped
_MOST = 32


class Sender:
    """Does work in its order, in a thread of its own.

    A simulation that is not paced by the wall clock does the work itself: a client that steps it finds the messages of
    a tick when the tick is over, and a thread would not make it faster.

    Args:
        is_paced: whether the simulation is in step with the wall clock, so that it waits between ticks.

    Attributes:
        failures: streams whose messages could not be made, and the errors; the simulation closes these streams.
    """

    def __init__(self, is_paced: Callable[[], bool]) -> None:
        self._is_paced = is_paced
        self.failures: list[tuple[Any, BaseException]] = []
        self._queue: queue.Queue[tuple[Callable[[], object], object] | None] = queue.Queue(_MOST)
        self._thread: threading.Thread | None = None

    def do(self, work: Callable[[], object], stream: object = None) -> None:
        """Do some work, at once or soon.

        Args:
            stream: the stream that is closed if the work raises an error later; None if only the work is lost.
        """
        if not self._is_paced():
            self.finish()
            work()
            return
        if self._thread is None:
            self._thread = threading.Thread(target=self._serve, name="morse-ros2", daemon=True)
            self._thread.start()
        self._queue.put((work, stream))

    def finish(self) -> None:
        """Wait until all work is done."""
        if self._thread is not None:
            self._queue.join()

    def close(self) -> None:
        """Do the rest, and end the thread."""
        if self._thread is not None:
            self._queue.put(None)
            self._thread.join()
            self._thread = None

    def _serve(self) -> None:
        while True:
            work = self._queue.get()
            try:
                if work is None:
                    return
                work[0]()
            except BaseException as error:
                assert work is not None
                if work[1] is None:
                    logger.error("ros2: a message could not be sent: %s", describe(error))
                else:
                    self.failures.append((work[1], error))
            finally:
                self._queue.task_done()
