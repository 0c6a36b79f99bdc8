"""Images that other processes draw while the simulation goes on, on this machine or on a cluster.

All simulations of a process share the workers for each number of them. A worker keeps the scenes that it has received.
One that dies is replaced, and its image is drawn again. ``python -m morse.rendering.workers`` is its program.
"""

from __future__ import annotations

import itertools
import os
import pickle
import threading
import weakref
from collections import deque
from concurrent.futures import wait
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

from morse.core.reports.faults import summary
from morse.rendering.picture import Picture
from morse.rendering.requests import CameraMemory
from morse.scene.image_workers import RAY
from morse.system.ray_cluster import RayExecutor
from morse.system.workers import Server, Worker, WorkerError, WorkerPool, serve_program

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from concurrent.futures import Future

    from morse.rendering.lens import Lens
    from morse.rendering.painter import Instant, Painter, Stage
    from morse.rendering.picture import Shot
    from morse.rendering.requests import Order

#: number of workers that may die over one image
_ATTEMPTS = 3
#: wall-clock time after which a worker that does not answer is killed, s
PATIENCE = 60.0
#: maximum number of images for each worker that are not complete, which limits the memory for their poses
_MOST = 4


class Job(NamedTuple):
    """An image to be drawn, as a worker receives it.

    Attributes:
        scene: number of the scene.
        gone: numbers of scenes that are not needed any more.
        painter: the pickled `Painter` of the scene; None if the worker has received it before.
        instant: the pickled `Instant`.
        camera: number of the camera, whose memory the worker keeps; None if the camera has none.
        order: the image, without a memory.
    """

    scene: int
    gone: frozenset[int]
    painter: bytes | None
    instant: bytes
    camera: int | None
    order: Order


class ImageServer(Server):
    """What a worker does: it keeps the scenes that it has received, and draws images of their ticks."""

    def __init__(self) -> None:
        self._painters: dict[int, Painter] = {}
        #: of each scene, the memories and lenses of its cameras; the table of a distorted lens takes long to compute
        self._memories: dict[int, dict[int, CameraMemory]] = {}
        self._lenses: dict[int, dict[Lens, Lens]] = {}

    def answer(self, question: bytes) -> bytes:
        """Draw the image of a pickled `Job`; return the pickled image, or the text of an error."""
        answer: object
        try:
            answer = self._draw(pickle.loads(question))
        except Exception as error:
            answer = summary(error)
        return pickle.dumps(answer, protocol=5)

    def _draw(self, job: Job) -> Picture:
        for scene in job.gone:
            for table in (self._painters, self._memories, self._lenses):
                table.pop(scene, None)
        if job.painter is not None:
            self._painters[job.scene] = pickle.loads(job.painter)
            self._memories[job.scene], self._lenses[job.scene] = {}, {}
        order = job.order
        memory = None
        if job.camera is not None:
            memory = self._memories[job.scene].setdefault(job.camera, CameraMemory())
        order = order._replace(lens=self._lenses[job.scene].setdefault(order.lens, order.lens), memory=memory)
        (picture,) = self._painters[job.scene].draw(pickle.loads(job.instant), [order])
        return picture


class Drawing(Protocol):
    """A process that draws: a `Worker`, or an actor of a cluster."""

    @property
    def pid(self) -> int:
        """Its number, 0 on a cluster."""

    def ask(self, question: bytes, patience: float | None = None) -> bytes:
        """Send a pickled `Job` and wait for the answer; raise `WorkerError` if the process has died."""

    def kill(self) -> None:
        """End it at once."""

    def close(self) -> None:
        """End it."""


class ImageWorker:
    """A worker, and what it has received."""

    def __init__(self, process: Drawing) -> None:
        self.process = process
        self._scenes: frozenset[int] = frozenset()

    def draw(self, job: Job, painter: Painter, scenes: frozenset[int]) -> Picture:
        """Let the process draw an image.

        Args:
            job: without a painter.
            scenes: those that exist.

        Raises:
            RuntimeError: the image cannot be drawn.
            WorkerError: the process has died, or its answer is none.
        """
        new = None if job.scene in self._scenes else pickle.dumps(painter, protocol=5)
        gone = self._scenes - scenes
        question = pickle.dumps(job._replace(gone=gone, painter=new), protocol=5)
        try:
            image: object = pickle.loads(self.process.ask(question, PATIENCE))
        except WorkerError:
            raise
        # what a process has answered that is broken, or not ours, fails in any way when it is read
        except Exception as error:
            raise WorkerError(f", or does not answer as it should ({summary(error)})") from error
        if isinstance(image, Picture):
            self._scenes = self._scenes - gone | {job.scene}
            return image
        if isinstance(image, str):
            raise RuntimeError(f"in a process that renders images: {image}")
        raise WorkerError(f", or does not answer as it should (an image was expected, not {type(image).__name__})")

    def kill(self) -> None:
        """End the process at once."""
        self.process.kill()

    def close(self) -> None:
        """End the process."""
        self.process.close()


class _Awaited:
    """An image that a worker draws."""

    def __init__(self, picture: Future[Picture], stage: Stage) -> None:
        self._picture, self._stage = picture, stage

    def picture(self) -> Picture:
        """See `Shot`."""
        try:
            picture = self._picture.result()
        except WorkerError as error:
            raise RuntimeError(
                f"{_ATTEMPTS} processes that render images have failed over one image: the last one has ended{error}"
            ) from error
        return self._stage.named(picture)


class ImagePool:
    """Workers that draw images.

    Args:
        count: number of workers.
        start: starts the process of a worker.
    """

    def __init__(self, count: int, start: Callable[[], Drawing]) -> None:
        self._pool = WorkerPool(
            count, lambda: ImageWorker(start()), attempts=_ATTEMPTS, what="a process that renders images"
        )
        self._most = _MOST * count
        self._unfinished: deque[Future[Picture]] = deque()
        self._numbers = itertools.count()
        #: numbers of the painters and of the memories of cameras that exist
        self._scenes: dict[int, int] = {}
        self._cameras: weakref.WeakKeyDictionary[object, int] = weakref.WeakKeyDictionary()

    @property
    def workers(self) -> set[Drawing]:
        """The processes that live."""
        return {worker.process for worker in list(self._pool.workers)}

    def begin(self, stage: Stage, instant: Instant, orders: Sequence[Order]) -> list[Shot]:
        """Begin to draw images; wait first if too many are not complete."""
        painter, notes = stage.painter, pickle.dumps(instant, protocol=5)
        scene = self._number(painter)
        shots: list[Shot] = []
        for order in orders:
            while self._unfinished and (len(self._unfinished) >= self._most or self._unfinished[0].done()):
                wait([self._unfinished.popleft()])
            camera = None
            if order.memory is not None:
                camera = self._cameras.setdefault(order.memory, next(self._numbers))
            job = Job(scene, frozenset(), None, notes, camera, order._replace(memory=None))
            picture = self._pool.submit(
                lambda worker, job=job: worker.draw(job, painter, frozenset(self._scenes.values()))  # type: ignore[misc]
            )
            self._unfinished.append(picture)
            shots.append(_Awaited(picture, stage))
        return shots

    def _number(self, painter: Painter) -> int:
        key = id(painter)
        if key not in self._scenes:
            self._scenes[key] = next(self._numbers)
            weakref.finalize(painter, self._scenes.pop, key, None).atexit = False
        return self._scenes[key]

    def close(self) -> None:
        """End all workers; images that are not begun are not drawn."""
        self._pool.close()


@dataclass
class _Shared:
    """A pool, the end of its connection, and the number of its users."""

    pool: ImagePool
    end: Callable[[], None]
    users: int = 0


class ImagePools:
    """The pools of this process."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._pools: dict[tuple[int, int | str], _Shared] = {}

    def borrow(self, place: int | str) -> tuple[ImagePool, Callable[[], None]]:
        """Return a pool, which is started if nobody uses it yet, and the function that gives it back.

        Args:
            place: number of workers, or the address of a cluster: ``ray://auto``, ``ray://local`` or
                ``ray://host:port``.

        Raises:
            ImportError, ConnectionError: see `morse.system.ray_cluster.RayExecutor`.
        """
        # a process that was copied from this one has none of its threads
        key = os.getpid(), place
        with self._lock:
            if key not in self._pools:
                self._pools[key] = _start(place)
            shared = self._pools[key]
            shared.users += 1
        return shared.pool, lambda: self._give_back(key)

    def _give_back(self, key: tuple[int, int | str]) -> None:
        if key[0] != os.getpid():
            return
        with self._lock:
            shared = self._pools[key]
            shared.users -= 1
            if shared.users:
                return
            del self._pools[key]
        shared.pool.close()
        shared.end()


def _start(place: int | str) -> _Shared:
    if isinstance(place, int):
        return _Shared(ImagePool(place, lambda: Worker.program(__name__)), lambda: None)
    address = place.removeprefix(RAY)
    cluster = RayExecutor(address if address in ("auto", "local") else place)
    return _Shared(ImagePool(cluster.workers, lambda: cluster.worker(ImageServer)), cluster.shutdown)


pools = ImagePools()


def main() -> None:
    """Draw until the simulation ends."""
    serve_program(ImageServer)


if __name__ == "__main__":
    main()
