"""Renders the images of all cameras of a world."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.kernel.drawing import Light, drawer
from morse.kernel.drawing.arrays import CAMERA
from morse.rendering.contents import Contents, MeshStore
from morse.rendering.distortion import DistortedLens
from morse.rendering.exposures import averaged, cropped, joined
from morse.rendering.lights import lamps_of, light_nodes, sky_of
from morse.rendering.motion import moved
from morse.rendering.picture import Picture
from morse.rendering.request import CameraRequest
from morse.rendering.shadows import Shadows
from morse.rendering.spot_shadows import SpotShadows
from morse.rendering.textures import TextureStore
from morse.rendering.warp import Drawn

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from morse.kernel.drawing import Pictures, Poses
    from morse.physics import World
    from morse.rendering.lens import Lens
    from morse.rendering.motion import Motion
    from morse.rendering.request import Placed

#: number of samples of each pixel
_SAMPLES = 5
#: maximum number of pixels per call, so that many large cameras do not exhaust the memory
_MOST_PIXELS = 1 << 25


class Renderer:
    """Renders camera images; all cameras of a tick are rendered in one call.

    Attributes:
        contents: the contents of the world; set at the first image.
    """

    contents: Contents

    def __init__(self, world: World, samples: int = _SAMPLES) -> None:
        self._world = world
        self._samples = samples
        self._meshes, self._textures = MeshStore(), TextureStore()
        self._arrangement = self._repaints = -1
        self._shadows: Shadows | None = None

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
        """Render the requested images."""
        asked = [request for request in requests if request.wanted()]
        for request in asked:
            if request.motion is not None:
                self._draw_over_time(request, request.motion)
        wanted = [request for request in asked if request.motion is None]
        while wanted:
            pixels, count = 0, 0
            for request in wanted:
                pixels += sum(view.lens.width * view.lens.height for view in _views(request))
                if count and pixels > _MOST_PIXELS:
                    break
                count += 1
            self._draw(wanted[:count])
            wanted = wanted[count:]

    def _draw_over_time(self, request: CameraRequest, motion: Motion) -> None:
        """Render an image with motion blur or rolling shutter."""
        bands = []
        for band in motion.bands(request.lens.height):
            pictures = []
            for time in band.times:
                lens = cropped(request.lens, band.first, band.last)
                part = self.request(request.obj, lens, color=request.color, normals=request.normals)
                part.exposure = request.exposure
                self._draw([part], time)
                assert part.picture is not None
                pictures.append(part.picture)
            bands.append(averaged(pictures))
        request.picture = joined(bands)

    def _draw(self, requests: Sequence[CameraRequest], time: float = 0.0) -> None:
        self._look()
        contents = self.contents
        poses = contents.poses(time)
        views = [view for request in requests for view in _views(request)]
        cameras = np.zeros(len(views), CAMERA)
        for row, view in zip(cameras, views, strict=True):
            _fill(row, view, time)
        light = self._light
        if cameras["color"].any():
            light = self._lit(poses)
            assert self._shadows is not None
            self._shadows.update(poses)
        made = self._drawer.draw(cameras, poses, light, self._samples)
        rows = iter(cameras)
        for request in requests:
            flats = [_cut(made, next(rows)) for _ in _views(request)]
            lens = request.lens
            drawn = lens.warp.gather(flats) if isinstance(lens, DistortedLens) else flats[0]
            position, rotation = _pose_of(request.obj, time)
            request.picture = Picture(
                drawn.rgb,
                drawn.depth,
                drawn.ids,
                drawn.normals,
                contents.nodes,
                poses.models,
                np.array(position, np.float32),
                np.reshape(np.array(rotation, np.float32), (3, 3)).T.copy(),
            )

    def _look(self) -> None:
        """Read the world again if objects were added or removed, or a colour has changed."""
        world = self._world
        if self._arrangement == world.arrangement and not self._is_repainted():
            return
        self.contents = Contents(world, self._meshes, self._textures)
        self._drawer = drawer(self.contents.drawing)
        self._light_nodes = light_nodes(world.scene)
        self._shadows, self._spot_shadows = None, SpotShadows()
        lamps, sunny, _ = lamps_of(self._light_nodes, world)
        self._light = Light(lamps, sky_of(world.scene.settings.view, sunny), np.zeros(16, np.float32), None)
        self._arrangement, self._repaints = world.arrangement, world.repaints
        self._colors = [node.color for node in self.contents.nodes]

    def _is_repainted(self) -> bool:
        """Whether a colour has changed; changes of visibility do not require reading the world again."""
        if self._repaints == self._world.repaints:
            return False
        self._repaints = self._world.repaints
        return self._colors != [node.color for node in self.contents.nodes]

    def _lit(self, poses: Poses) -> Light:
        """The present lamps, with the shadows of the sun and of a spot lamp."""
        lamps, sunny, spot = lamps_of(self._light_nodes, self._world)
        if self._shadows is None or not np.array_equal(self._shadows.sunny, sunny):
            self._shadows = Shadows(self.contents, self._drawer, sunny, self._light)
        sky = sky_of(self._world.scene.settings.view, sunny)
        self._shadows.light = self._shadows.light._replace(lamps=lamps, sky=sky)
        return self._spot_shadows.update(self._shadows.light, spot, poses, self._drawer)


class _View(NamedTuple):
    """An undistorted image for a camera.

    Attributes:
        request: the request of the camera.
        lens: the lens of the undistorted image.
        turn: (3, 3) its axes in the frame of the camera, in columns.
    """

    request: CameraRequest
    lens: Lens
    turn: NDArray[np.float64]


_STRAIGHT = np.eye(3)


def _views(request: CameraRequest) -> list[_View]:
    lens = request.lens
    if isinstance(lens, DistortedLens):
        return [_View(request, flat.lens, flat.turn) for flat in lens.warp.flats]
    return [_View(request, lens, _STRAIGHT)]


def _pose_of(obj: Placed, time: float) -> tuple[Any, Any]:
    """Position and rotation at a time relative to the present, at the present velocity."""
    position, rotation = obj.world_pose()
    velocity = getattr(obj, "velocity", None)
    if not time or velocity is None:
        return position, rotation
    linear, angular = (np.nan_to_num(np.array([part], np.float64)) for part in velocity())
    places, turns = moved(np.array([position]), np.reshape(np.array(rotation), (1, 3, 3)), linear, angular, time)
    return places[0], turns[0]


def _fill(row: Any, view: _View, time: float) -> None:
    request, lens = view.request, view.lens
    position, rotation = _pose_of(request.obj, time)
    for name in ("fx", "fy", "cx", "cy", "near", "far", "width", "height"):
        row[name] = getattr(lens, name)
    # the rotations of undistorted images permute axes, so that these products are exact
    row["axes"] = (np.reshape(rotation, (3, 3)) @ view.turn).T.ravel()
    row["eye"], row["color"], row["exposure"] = position, request.color, request.exposure
    row["normals"] = request.normals


def _cut(made: Pictures, row: Any) -> Drawn:
    """One of the rendered images."""
    shape, first = (int(row["height"]), int(row["width"])), int(row["pixel"])
    part = slice(first, first + shape[0] * shape[1])
    return Drawn(
        made.rgb[part].reshape(*shape, 3) if row["color"] else None,
        made.depth[part].reshape(shape),
        made.ids[part].reshape(shape),
        made.normals[part].reshape(*shape, 3) if row["normals"] else None,
    )
