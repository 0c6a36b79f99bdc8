"""The workers of all simulations of a process, and the images that they draw."""

from __future__ import annotations

import contextlib
import itertools
import logging
import os
import pickle
import threading
import weakref
from collections import deque
from concurrent.futures import Future, wait
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, NamedTuple, Protocol

from morse.core.reports.faults import summary
from morse.kernel import threads
from morse.rendering.picture import Picture
from morse.rendering.workers.easel import Job
from morse.system import OF_MACHINE
from morse.system.worker_process import WorkerProcess

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.rendering.orders import Order
    from morse.rendering.painter import Instant, Painter
    from morse.rendering.shot import Shot
    from morse.rendering.stage import Stage

logger = logging.getLogger(__name__)

#: number of workers that may die over one image
_ATTEMPTS = 3
#: maximum number of images for each worker that are not complete, which limits the memory for their poses
_MOST = 4


class Worker(Protocol):
    """Draws images in another process."""

    def ask(self, message: bytes) -> bytes | bytearray:
        """Send a pickled `Job` and wait for the answer; raise `EOFError` or `OSError` if the worker has died."""

    def close(self) -> None:
        """End it."""


class _Wish(NamedTuple):
    """An image for any worker."""

    painter: Painter
    scene: int
    instant: bytes
    camera: int | None
    order: Order
    picture: Future[Picture]


class _Awaited:
    """An image that a worker draws."""

    def __init__(self, picture: Future[Picture], stage: Stage) -> None:
        self._picture, self._stage = picture, stage

    def picture(self) -> Picture:
        """See `Shot`."""
        return self._stage.named(self._picture.result())


class Crew:
    """Workers that draw images; a worker that dies is replaced, and its image is drawn again.

    Args:
        count: number of workers.
        hire: starts a worker.

    Attributes:
        workers: those that live.
    """

    def __init__(self, count: int, hire: Callable[[], Worker]) -> None:
        self._hire, self._count = hire, count
        self._wishes: SimpleQueue[_Wish | None] = SimpleQueue()
        self._unfinished: deque[Future[Picture]] = deque()
        self._numbers = itertools.count()
        #: numbers of the painters and of the memories of cameras that exist
        self._scenes: dict[int, int] = {}
        self._cameras: weakref.WeakKeyDictionary[object, int] = weakref.WeakKeyDictionary()
        self.workers: set[Worker] = set()
        self._threads = [
            threading.Thread(target=self._run, name=f"morse-pictures-{number}", daemon=True) for number in range(count)
        ]
        for thread in self._threads:
            thread.start()

    def begin(self, stage: Stage, instant: Instant, orders: Sequence[Order]) -> list[Shot]:
        """Begin to draw images; wait first if too many are not complete."""
        painter, notes = stage.painter, pickle.dumps(instant, protocol=5)
        scene = self._number(painter)
        shots: list[Shot] = []
        for order in orders:
            while self._unfinished and (len(self._unfinished) >= _MOST * self._count or self._unfinished[0].done()):
                wait([self._unfinished.popleft()])
            camera = None
            if order.memory is not None:
                camera = self._cameras.setdefault(order.memory, next(self._numbers))
            picture: Future[Picture] = Future()
            self._unfinished.append(picture)
            self._wishes.put(_Wish(painter, scene, notes, camera, order._replace(memory=None), picture))
            shots.append(_Awaited(picture, stage))
        return shots

    def _number(self, painter: Painter) -> int:
        key = id(painter)
        if key not in self._scenes:
            self._scenes[key] = next(self._numbers)
            weakref.finalize(painter, self._scenes.pop, key, None).atexit = False
        return self._scenes[key]

    def _run(self) -> None:
        """The thread of one worker after the other."""
        desk = _Desk(self._hire, self.workers)
        while (wish := self._wishes.get()) is not None:
            try:
                wish.picture.set_result(desk.draw(wish, set(self._scenes.values())))
            except Exception as error:
                wish.picture.set_exception(error)
            # the thread must not keep a scene that the simulation has changed
            del wish
        desk.dismiss()

    def close(self) -> None:
        """End all workers; images that are not begun are not drawn."""
        with contextlib.suppress(Empty):
            while True:
                if (wish := self._wishes.get_nowait()) is not None:
                    wish.picture.cancel()
        for _ in self._threads:
            self._wishes.put(None)
        for thread in self._threads:
            thread.join()


class _Desk:
    """The place of one worker; when it dies, another one takes it."""

    def __init__(self, hire: Callable[[], Worker], workers: set[Worker]) -> None:
        self._hire, self._workers = hire, workers
        self._worker: Worker | None = None
        #: the scenes that the worker has received
        self._scenes: set[int] = set()
        with contextlib.suppress(Exception):  # the first image tells
            self._occupy()

    def _occupy(self) -> Worker:
        if self._worker is None:
            self._worker = self._hire()
            self._workers.add(self._worker)
        return self._worker

    def draw(self, wish: _Wish, scenes: set[int]) -> Picture:
        """Let a worker draw an image.

        Args:
            scenes: those that exist.

        Raises:
            RuntimeError: the image cannot be drawn, or several workers have died over it.
        """
        problem: Exception = EOFError()
        for _ in range(_ATTEMPTS):
            painter = None if wish.scene in self._scenes else pickle.dumps(wish.painter, protocol=5)
            gone = frozenset(self._scenes - scenes)
            job = Job(wish.scene, gone, painter, wish.instant, wish.camera, wish.order)
            message = pickle.dumps(job, protocol=5)
            try:
                answer = _image(self._occupy().ask(message))
            # what a process has answered that is broken, or not ours, fails in any way when it is read
            except Exception as error:
                problem = error
                logger.warning(
                    "a process that renders images has ended or does not answer as it should (%s); "
                    "another one replaces it",
                    summary(error),
                    extra=OF_MACHINE,
                )
                self.dismiss()
                continue
            self._scenes = self._scenes - gone | {wish.scene}
            if isinstance(answer, str):
                raise RuntimeError(f"in a process that renders images: {answer}")
            return answer
        raise RuntimeError(
            f"{_ATTEMPTS} processes that render images have failed over one image: {summary(problem)}"
        ) from problem

    def dismiss(self) -> None:
        """End the worker, which may have died."""
        self._scenes.clear()
        if self._worker is not None:
            self._workers.discard(self._worker)
            self._worker.close()
            self._worker = None


def _image(answer: bytes | bytearray) -> Picture | str:
    """Read the answer of a worker: an image, or why there is none.

    Raises:
        Exception: of any class, because it is no answer.
    """
    image = pickle.loads(answer)
    if not isinstance(image, Picture | str):
        raise TypeError(f"an image was expected, not {type(image).__name__}")
    return image


class Crews:
    """The crews of this process: all simulations share one for each number of workers."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._crews: dict[tuple[int, int | str], _Lent] = {}

    def borrow(self, place: int | str) -> tuple[Crew, Callable[[], None]]:
        """Return a crew, which is started if nobody uses it yet, and the function that gives it back.

        Args:
            place: number of workers, or the address of a cluster.

        Raises:
            ImportError, ConnectionError: see `morse.system.ray_cluster.RayCluster`.
        """
        # a process that was copied from this one has none of its threads
        key = os.getpid(), place
        with self._lock:
            if key not in self._crews:
                self._crews[key] = _start(place)
            lent = self._crews[key]
            lent.users += 1
        return lent.crew, lambda: self._give_back(key)

    def _give_back(self, key: tuple[int, int | str]) -> None:
        if key[0] != os.getpid():
            return
        with self._lock:
            lent = self._crews[key]
            lent.users -= 1
            if lent.users:
                return
            del self._crews[key]
        lent.crew.close()
        lent.end()


@dataclass
class _Lent:
    """A crew, the end of its connection, and the number of its users."""

    crew: Crew
    end: Callable[[], None]
    users: int = 0


def _worker() -> WorkerProcess:
    return WorkerProcess("morse.rendering.workers.main", {**os.environ, threads.VARIABLE: "1"})


def _start(place: int | str) -> _Lent:
    if isinstance(place, int):
        return _Lent(Crew(place, _worker), _nothing)
    # imported on demand, because few simulations need it
    from morse.rendering.workers.ray_worker import RayCrew

    cluster = RayCrew(place)
    return _Lent(Crew(cluster.count, cluster.hire), cluster.close)


def _nothing() -> None:
    """Processes of this machine need no connection."""


crews = Crews()
