"""Renders the images of all cameras of a world, and images from any pose."""

from __future__ import annotations

import math
import weakref
from collections import deque
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.random
from PIL import Image as Pillow

from morse.mathutils import Euler
from morse.mathutils.portable import norm
from morse.rendering.contents import MeshStore
from morse.rendering.lens import Lens
from morse.rendering.painter import Stage
from morse.rendering.picture import Finished
from morse.rendering.requests import CameraRequest, order_of
from morse.rendering.textures import TextureStore

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from concurrent.futures import Future

    from numpy.typing import NDArray

    from morse.physics import World
    from morse.rendering.contents import Contents
    from morse.rendering.painter import Instant
    from morse.rendering.picture import Picture, Shot
    from morse.rendering.requests import Order, Placed
    from morse.rendering.workers import ImagePool
    from morse.scene import ViewSettings


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


#: number of samples of each pixel
_SAMPLES = 5


def _nothing() -> None:
    """No workers are to be ended."""


class Renderer:
    """Renders camera images; all cameras of a tick are rendered in one call."""

    def __init__(self, world: World, samples: int = _SAMPLES) -> None:
        self._world = world
        self._samples = samples
        self._meshes, self._textures = MeshStore(), TextureStore()
        self._stage: Stage | None = None
        self._simplified = False
        self._beside = Beside()
        self._workers: int | str = 0
        self._pool: ImagePool | None = None
        self._end_workers: Callable[[], object] = _nothing
        # within a tick, there may be no file descriptor left for imports
        Pillow.preinit()

    def employ(self, workers: int | str) -> None:
        """Let that many other processes draw the images, from now on, 0 for none; or those of a cluster."""
        if workers == self._workers:
            return
        self.close()
        self._workers = workers
        if workers:
            # imported on demand, because few simulations need it
            from morse.rendering.workers import pools

            self._pool, give_back = pools.borrow(workers)
            self._end_workers = weakref.finalize(self, give_back)

    def close(self) -> None:
        """End the workers, if no other simulation needs them."""
        self._workers, self._pool, end = 0, None, self._end_workers
        self._end_workers = _nothing
        end()

    @property
    def contents(self) -> Contents:
        """The present contents of the world."""
        return self._present_stage().contents

    @property
    def drawn_tiles(self) -> int:
        """Number of tiles of 32 x 32 pixels that were rendered for the last images, not taken over."""
        return 0 if self._stage is None else self._stage.painter.drawn_tiles

    def request(
        self,
        obj: Placed,
        lens: Lens,
        *,
        color: bool = True,
        normals: bool = False,
        wanted: Callable[[], bool] = lambda: True,
    ) -> CameraRequest:
        """Create the request of a camera; see `CameraRequest`."""
        return CameraRequest(self, obj, lens, color=color, normals=normals, wanted=wanted)

    def serve(self, requests: Sequence[CameraRequest]) -> None:
        """Render the requested images, and begin those that are rendered while the simulation goes on."""
        active_requests = [request for request in requests if request.wanted()]
        if not active_requests:
            return
        stage = self._stage_for(active_requests)
        if self._pool is not None:
            self._begin(self._pool, stage, active_requests)
            return
        now = [request for request in active_requests if not request.beside]
        if now:
            orders = [order_of(request) for request in now]
            for request, picture in zip(now, stage.draw(stage.note(orders), orders), strict=True):
                request.shot = Finished(picture)
        if later := [request for request in active_requests if request.beside]:
            self._begin(self._beside, stage, later)

    @staticmethod
    def _begin(drawing: Beside | ImagePool, stage: Stage, requests: Sequence[CameraRequest]) -> None:
        orders = [order_of(request) for request in requests]
        for request, shot in zip(requests, drawing.begin(stage, stage.note(orders), orders), strict=True):
            request.shot = shot

    def prepare(self, requests: Sequence[CameraRequest]) -> None:
        """Render images and discard them: the first ones read meshes and textures, and take much longer than others."""
        active_requests = [request for request in requests if request.wanted()]
        if not active_requests:
            return
        stage = self._stage_for(active_requests)
        orders = [order_of(request) for request in active_requests]
        instant = stage.note(orders)
        if self._pool is None:
            stage.draw(instant, orders)
            return
        for shot in self._pool.begin(stage, instant, orders):
            shot.picture()

    def _stage_for(self, requests: Sequence[CameraRequest]) -> Stage:
        """The present objects, with levels of detail if an image allows an error."""
        if not self._simplified and any(request.screen_space_error > 0.0 for request in requests):
            # levels of detail take time and memory: they are made for the first camera that allows an error
            self._simplified, self._stage = True, None
            self._meshes = MeshStore(simplified=True)
        return self._present_stage()

    def _present_stage(self) -> Stage:
        """The present objects; the world is read again if objects were added or removed, or a colour has changed."""
        if self._stage is None or not self._stage.is_current():
            self._stage = Stage(self._world, self._meshes, self._textures, self._samples, self._stage)
        return self._stage


# Viewpoints that are not attached to a robot.


@dataclass(frozen=True)
class Viewpoint:
    """A pose in the world, for `CameraRequest.obj`.

    Attributes:
        position: (3,) m.
        axes: (3, 3) right, down, forward, in columns, world frame.
    """

    position: NDArray[np.float64]
    axes: NDArray[np.float64]

    def world_pose(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Position (3) and rotation (9, row by row)."""
        return tuple(self.position.tolist()), tuple(self.axes.ravel().tolist())

    @classmethod
    def looking_at(cls, position: Sequence[float], target: Sequence[float]) -> Viewpoint:
        """At a position, upright; for a view straight down or up, the Y axis of the world is up.

        Raises:
            ValueError: numbers are not finite, or both positions are equal.
        """
        here, there = np.array(_three(position, "location")), np.array(_three(target, "target"))
        forward = there - here
        if not norm(forward) > 1e-9:
            raise ValueError(f"the viewpoint and the point at which it looks are both {tuple(here.tolist())}")
        forward /= norm(forward)
        up = (0.0, 0.0, 1.0) if abs(forward[2]) < 0.9999 else (0.0, 1.0, 0.0)
        right = np.cross(forward, up)
        right /= norm(right)
        return cls(here, np.column_stack([right, np.cross(forward, right), forward]))

    @classmethod
    def turned(cls, location: Sequence[float], rotation: Sequence[float]) -> Viewpoint:
        """At a position, with the rotation of a camera of Blender and of ``env.set_camera_rotation``: along -Z, Y up.

        Args:
            location: m, world frame.
            rotation: Euler angles about X, Y and Z, radians; zeros look straight down.

        Raises:
            ValueError: numbers are not finite, or not three.
        """
        turn = np.array([list(row) for row in Euler(_three(rotation, "rotation")).to_matrix()])
        return cls(np.array(_three(location, "location")), turn * (1.0, -1.0, -1.0))

    @classmethod
    def of_script(cls, view: ViewSettings) -> Viewpoint:
        """Return the viewpoint of ``env.set_camera_location`` and ``set_camera_rotation``."""
        return cls.turned(view.camera_location, view.camera_rotation)


def _three(values: Sequence[float], what: str) -> tuple[float, ...]:
    numbers = tuple(float(value) for value in values)
    if len(numbers) != 3 or not all(map(math.isfinite, numbers)):
        raise ValueError(f"the {what} of a camera is three finite numbers, got {values!r:.80}")
    return numbers


def angle_of(view: ViewSettings) -> float:
    """Return the horizontal field of view of the viewpoint of a script, rad, for Blender's sensor width of 32 mm."""
    return 2 * math.atan(16.0 / max(view.camera_focal_length, 1e-3))


_FAR = 1000.0


def photograph(
    world: World,
    width: int = 960,
    height: int = 600,
    location: Sequence[float] | None = None,
    rotation: Sequence[float] | None = None,
    focal_length: float | None = None,
    renderer: Renderer | None = None,
) -> NDArray[np.uint8]:
    """Render a world at its present state.

    Args:
        width: pixels.
        height: pixels.
        location: of the camera, m; None for the initial viewpoint of the live view.
        rotation: Euler angles about X, Y, Z, rad: ``[0, 0, 0]`` looks straight down; None for that of the live view.
        focal_length: mm, for a sensor 32 mm wide; None for that of the live view.
        renderer: renderer of this world from an earlier call, which has read the meshes and the textures.

    Returns:
        (height, width, 3) uint8, red, green and blue.

    Raises:
        ValueError: the parameters are not valid.
    """
    view = world.scene.settings.view
    focal = view.camera_focal_length if focal_length is None else focal_length
    lens = Lens.of_focal_length(width, height, focal, view.camera_clip[0], _FAR)
    place = view.camera_location if location is None else location
    orientation = view.camera_rotation if rotation is None else rotation
    renderer = renderer or Renderer(world)
    request = renderer.request(Viewpoint.turned(place, orientation), lens)
    renderer.serve([request])
    assert request.picture is not None
    assert request.picture.rgb is not None
    return np.ascontiguousarray(request.picture.rgb)
