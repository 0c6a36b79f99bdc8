"""Renders images in a thread while the simulation goes on."""

from __future__ import annotations

from collections import deque
from concurrent.futures import ThreadPoolExecutor, wait
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence
    from concurrent.futures import Future

    from morse.rendering.orders import Order
    from morse.rendering.painter import Instant
    from morse.rendering.picture import Picture
    from morse.rendering.shot import Shot
    from morse.rendering.stage import Stage

#: maximum number of ticks whose images are not complete, which limits the memory for their poses
_MOST = 4


class _UnderWay:
    """One of the images that are rendered together."""

    def __init__(self, pictures: Future[list[Picture]], number: int) -> None:
        self._pictures, self._number = pictures, number

    def picture(self) -> Picture:
        """See `Shot`."""
        return self._pictures.result()[self._number]


class Beside:
    """A thread that renders the images of one tick after the other; it ends when nothing refers to this object."""

    def __init__(self) -> None:
        self._thread: ThreadPoolExecutor | None = None
        self._running: deque[Future[list[Picture]]] = deque()

    def begin(self, stage: Stage, instant: Instant, orders: Sequence[Order]) -> list[Shot]:
        """Begin to render images; wait first if too many are not complete."""
        if self._thread is None:
            self._thread = ThreadPoolExecutor(1, thread_name_prefix="morse-pictures")
        while self._running and (len(self._running) >= _MOST or self._running[0].done()):
            wait([self._running.popleft()])
        future = self._thread.submit(stage.draw, instant, orders)
        self._running.append(future)
        return [_UnderWay(future, number) for number in range(len(orders))]
