"""Images rendered by the C functions."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.kernel import threads
from morse.kernel.drawing.arrays import ENCODED, SAMPLES, SEEN_BYTES, Pictures, tiles_of
from morse.kernel.drawing.structures import FrameStructure
from morse.kernel.memory import pointer

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.kernel.drawing.arrays import Drawing, Light, Poses

_OF_ONE_CALL = ("cameras", "jobs", "tiles", "starts", "counts", "firsts", "members", "rgba", "depth", "ids", "normals")


#: the positions of samples
_SAMPLES = {count: np.array(positions, np.float32) for count, positions in SAMPLES.items()}


class NativeDrawer:
    """Renders images; the twin of `morse.kernel.drawing.reference.ReferenceDrawer`.

    Attributes:
        drawing: the scene.
    """

    def __init__(self, library: ctypes.CDLL, drawing: Drawing) -> None:
        self._library = library
        self.drawing = drawing
        self._frame = frame = FrameStructure()
        frame.point(**drawing._asdict(), encoded=ENCODED)
        frame.part_count = len(drawing.parts)
        self._seen = np.empty((0, SEEN_BYTES), np.uint8)

    def draw(self, cameras: NDArray[Any], poses: Poses, light: Light, samples: int) -> Pictures:
        """Render the images of cameras.

        Args:
            cameras: (K,) `CAMERA`; their first tiles and pixels are set.
            samples: number of samples per pixel for the colour: 1 or 5.
        """
        frame, drawing = self._frame, self.drawing
        tiles = tiles_of(cameras)
        self._light(light, poses, samples)
        # one more than needed: an empty array has no address
        jobs = np.empty((len(cameras) * len(drawing.parts) + 1, 2), np.int32)
        frame.point(cameras=cameras, jobs=jobs, tiles=tiles)
        frame.camera_count, frame.tile_count = len(cameras), len(tiles)
        frame.job_count = count = self._library.morse_draw_find(ctypes.byref(frame))
        ends = np.cumsum(drawing.clusters[drawing.parts[jobs[:count, 1], 0], 3], dtype=np.int64)
        starts, counts = np.concatenate([np.zeros(1, np.int64), ends]), np.zeros(count + 1, np.int64)
        if starts[-1] >= len(self._seen):
            self._seen = np.empty((int(starts[-1]) * 5 // 4 + 1, SEEN_BYTES), np.uint8)
        frame.point(starts=starts, counts=counts, seen=self._seen)
        self._run("morse_draw_project", count)
        self._bin(len(cameras), len(tiles))
        pixels = int((cameras["width"].astype(np.int64) * cameras["height"]).sum())
        colour = np.empty((pixels if cameras["color"].any() else 0, 4), np.uint8)
        normals = np.empty((pixels if cameras["normals"].any() else 0, 3), np.float32)
        made = Pictures(colour, np.empty(pixels, np.float32), np.empty(pixels, np.int32), normals)
        frame.point(**made._asdict())
        self._run("morse_draw_pixels", len(tiles))
        frame.forget(*_OF_ONE_CALL)
        return made

    def cast_shadows(self, parts: NDArray[np.integer], poses: Poses, light: Light) -> NDArray[np.int32]:
        """Draw parts into the shadow map.

        Returns:
            (N, 4) the texels that each part may have filled: x0, y0, x1, y1, one past the end.
        """
        frame = self._frame
        self._light(light, poses, 1)
        jobs = np.ascontiguousarray(np.column_stack([np.zeros_like(parts), parts]), dtype=np.int32)
        rectangles = np.zeros((len(parts), 4), np.int32)
        frame.point(jobs=jobs)
        frame.job_count, frame.next = len(parts), 0
        self._library.morse_draw_shadow(ctypes.byref(frame), pointer(rectangles))
        frame.forget("jobs")
        return rectangles

    def _light(self, light: Light, poses: Poses, samples: int) -> None:
        frame, shadow, near, lamp = self._frame, light.shadow, light.near_shadow, light.lamp_shadow
        frame.point(**light._asdict())
        frame.point(samples=_SAMPLES[samples], models=poses.models, turns=poses.turns)
        frame.lamp_count, frame.sample_count = len(light.lamps), samples
        frame.shadow_height, frame.shadow_width = (0, 0) if shadow is None else shadow.shape
        frame.near_height, frame.near_width = (0, 0) if near is None else near.shape
        frame.lamp_height, frame.lamp_width = (0, 0) if lamp is None else lamp.shape

    def _bin(self, cameras: int, tiles: int) -> None:
        """Sort the triangles into tiles: count them, allocate memory, store them."""
        frame = self._frame
        firsts = np.zeros(tiles + 1, np.int64)
        frame.point(firsts=firsts, members=None)
        self._run("morse_draw_bin", cameras)
        ends = np.cumsum(firsts)
        members, firsts = np.empty(int(ends[-1]) + 1, np.int32), ends - firsts
        filled = firsts.copy()
        frame.point(firsts=filled, members=members)
        self._run("morse_draw_bin", cameras)
        frame.point(firsts=firsts)

    def _run(self, name: str, pieces: int) -> None:
        """Distribute the pieces of a task over threads."""
        self._frame.next = 0
        function, frame = getattr(self._library, name), ctypes.byref(self._frame)
        threads.together(lambda: function(frame), pieces)
