"""What a worker process does: it keeps the scenes that it has received, and draws images of their ticks."""

from __future__ import annotations

import pickle
from typing import TYPE_CHECKING, Any, NamedTuple

from morse.core.reports.faults import summary
from morse.rendering.camera_memory import CameraMemory

if TYPE_CHECKING:
    from morse.rendering.lens import Lens
    from morse.rendering.orders import Order
    from morse.rendering.painter import Painter


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


class Easel:
    """The scenes of a worker."""

    def __init__(self) -> None:
        self._painters: dict[int, Painter] = {}
        #: of each scene, the memories and lenses of its cameras; the table of a distorted lens takes long to compute
        self._memories: dict[int, dict[int, CameraMemory]] = {}
        self._lenses: dict[int, dict[Lens, Lens]] = {}

    def answer(self, message: bytes | bytearray) -> bytes:
        """Draw the image of a pickled `Job`; return the pickled image, or the text of an error."""
        try:
            answer: Any = self._draw(pickle.loads(message))
        except Exception as error:
            answer = summary(error)
        return pickle.dumps(answer, protocol=5)

    def _draw(self, job: Job) -> object:
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
