"""Cameras in fog, rain and snow."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from morse.mathutils import portable
from morse.plugins.weather.medium import DEPTH_OF_RANGE, VISIBLE, drops_of, falling_speed
from morse.plugins.weather.services import present
from morse.sensors.camera import PictureModifier

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from morse.core.declarations import Option
    from morse.core.object import Object
    from morse.core.values import Options
    from morse.plugins.weather.medium import Conditions, Drops
    from morse.rendering import Lens, Picture
    from morse.sensors.camera import Camera
    from morse.sensors.video_camera import VideoCamera

#: numbers of levels of the transmission, and of distances
_LEVELS, _DISTANCES = 256, 4096
#: colour of the light in fog, in codes: that of an overcast sky
_SKY = (196.0, 200.0, 204.0)
#: exposure of a camera without a time of exposure, s
_EXPOSURE = 1.0 / 60.0
#: m; drops that are farther than this are seen as haze, not as streaks
_NEAR, _FAR = 0.15, 1.5
#: mm; drops that are smaller than this leave no visible streak
_SMALLEST = 1.0
#: maximum number of streaks
_MOST = 3000
#: speeds of drops, m/s, by their diameters, mm
_DIAMETERS = np.linspace(0.0, 10.0, 101)
_SPEEDS = np.array([falling_speed(diameter) for diameter in _DIAMETERS.tolist()])
#: speed of flakes, m/s
_SPEED_OF_FLAKES = 1.2


class _OverDistance(PictureModifier):
    """Knows how far away each pixel is."""

    component_instance: Camera
    not_state = (*PictureModifier.not_state, "_lens", "_lengths")

    def __init__(self, component_instance: Object, kwargs: Options) -> None:
        super().__init__(component_instance, kwargs)
        self._lens: Lens | None = None
        self._lengths: NDArray[np.float32] | None = None

    def distances(self, picture: Picture) -> NDArray[np.float32]:
        """Return the lengths of the rays of a picture (H, W), m; 0 without a surface."""
        lens = self.component_instance.lens
        if self._lens is not lens or self._lengths is None:
            rays = lens.rays()
            self._lens, self._lengths = lens, np.sqrt((rays * rays).sum(axis=2))
        return picture.depth * self._lengths


class CameraInWeather(_OverDistance):
    """Veils what is far away, and draws the streaks of near drops and flakes.

    The light of a surface reaches the camera with the transmission ``exp(-extinction * distance)``; the air adds light
    of the sky for the rest (H. Koschmieder, 1924). The share of the exposure for which a drop covers a pixel is the
    opacity of its streak (K. Garg, S. Nayar, Vision and Rain, 2007).
    """

    _names = ("Weather",)
    _components = ("VideoCamera",)
    options: ClassVar[Mapping[str, Option]] = {}
    component_instance: VideoCamera
    not_state = (*_OverDistance.not_state, "_known", "_tables")

    def __init__(self, component_instance: Object, kwargs: Options) -> None:
        super().__init__(component_instance, kwargs)
        self._known: Conditions | None = None
        self._tables: tuple[float, NDArray[np.uint16], NDArray[np.uint8]] | None = None

    def modify_picture(self, picture: Picture, time: float) -> Picture:
        """Return the picture in the present weather."""
        camera = self.component_instance
        conditions = present(camera.context)
        if conditions.is_clear or picture.rgba is None:
            return picture
        if self._known != conditions:
            self._known, self._tables = conditions, _tables(conditions.extinction(VISIBLE))
        rgba = self._veiled(picture)
        random = camera.context.random_at(f"{camera.name()}/weather", round(time * 1e6))
        exposure = float(camera.exposure_time) or _EXPOSURE
        for drops in drops_of(conditions):
            _draw(rgba, drops, camera.lens, exposure, random, flakes=drops.reflectance > 0.5)
        return picture._replace(rgba=rgba)

    def _veiled(self, picture: Picture) -> NDArray[np.uint8]:
        assert self._tables is not None
        assert picture.rgba is not None
        per_metre, levels, mixed = self._tables
        scaled = self.distances(picture) * np.float32(per_metre)
        # what has no depth is the sky
        scaled[(picture.depth <= 0.0) | (scaled > _DISTANCES - 1)] = _DISTANCES - 1
        place = levels[scaled.astype(np.uint16)]
        rgba = np.empty_like(picture.rgba)
        for channel in range(3):
            rgba[..., channel] = mixed[channel].take(place | picture.rgba[..., channel])
        rgba[..., 3] = picture.rgba[..., 3]
        return rgba


def _tables(extinction: float) -> tuple[float, NDArray[np.uint16], NDArray[np.uint8]]:
    """Return steps of distance per metre; by step the first place of a row of codes; (3, places) the mixed codes."""
    farthest = 6.0 / extinction
    steps = np.arange(_DISTANCES) * (farthest / (_DISTANCES - 1))
    share = portable.exp(-extinction * steps)
    share[-1] = 0.0
    rows = np.round(share * (_LEVELS - 1)).astype(np.uint16)
    shares = np.arange(_LEVELS)[:, None] / (_LEVELS - 1)
    codes = portable.linear_light(np.arange(256) / 255.0)
    mixed = np.stack([_codes(shares * codes + (1.0 - shares) * codes[int(sky)]).ravel() for sky in _SKY])
    return (_DISTANCES - 1) / farthest, (rows << 8).astype(np.uint16), mixed


def _codes(light: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return the codes of light from 0 to 1: the nearest ones."""
    codes = portable.linear_light(np.arange(256) / 255.0)
    borders = 0.5 * (codes[1:] + codes[:-1])
    return np.searchsorted(borders, light).astype(np.uint8)


def _draw(
    rgba: NDArray[np.uint8], drops: Drops, lens: Lens, exposure: float, random: np.random.Generator, *, flakes: bool
) -> None:
    """Draw the streaks of the drops in front of a camera."""
    height, width = rgba.shape[:2]
    volume = width * height / (lens.fx * lens.fy) * (_FAR**3 - _NEAR**3) / 3.0
    smallest = 0.0 if flakes else _SMALLEST
    count = min(int(random.poisson(min(drops.number(smallest) * volume, 1e6))), _MOST)
    if not count:
        return
    # evenly in the volume that the camera sees: the largest of three numbers is the cube root of one
    depth = np.maximum(_FAR * random.random((3, count)).max(axis=0), _NEAR)
    diameter = smallest + random.standard_exponential(count) / drops.slope
    speed = np.full(count, _SPEED_OF_FLAKES)
    if not flakes:
        speed = np.interp(diameter, _DIAMETERS, _SPEEDS)
    x, y = random.random(count) * width, random.random(count) * height
    length = np.maximum(speed * exposure * lens.fy / depth, 1.0)
    broad = 0.001 * diameter * lens.fx / depth
    # the share of the exposure, and of the pixel
    opacity = np.minimum(0.001 * diameter / (speed * exposure + 0.001 * diameter) * np.minimum(broad, 1.0), 1.0)
    visible = opacity > 1.0 / 255.0
    x, y, length, broad, opacity = (values[visible] for values in (x, y, length, broad, opacity))
    thick = np.clip(np.ceil(broad), 1, 24).astype(int)
    veil = np.zeros((height, width), np.float32)
    for left, top, tall, wide, strength in zip(
        x.astype(int).tolist(), y.astype(int).tolist(), length.astype(int).tolist(), thick.tolist(), opacity.tolist(),
        strict=True,
    ):  # fmt: skip
        part = veil[max(top - tall, 0) : top + 1, left : left + wide]
        np.maximum(part, strength, out=part)
    row, column = np.nonzero(veil)
    share = veil[row, column, None]
    pixels = rgba[row, column, :3]
    rgba[row, column, :3] = pixels + (np.array(_SKY, np.float32) - pixels) * share


class DepthInWeather(_OverDistance):
    """A depth camera measures no farther than the meteorological range, where 5 % of the contrast are left."""

    _names = ("Weather",)
    _components = ("AbstractDepthCamera",)
    options: ClassVar[Mapping[str, Option]] = {}

    def modify_picture(self, picture: Picture, time: float) -> Picture:
        """Return the picture without what is too far away."""
        extinction = present(self.component_instance.context).extinction(VISIBLE)
        if not extinction:
            return picture
        is_far = self.distances(picture) * extinction > DEPTH_OF_RANGE
        return picture._replace(depth=np.where(is_far, np.float32(0.0), picture.depth))
