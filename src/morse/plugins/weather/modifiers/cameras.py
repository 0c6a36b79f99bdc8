"""Cameras in fog, rain and snow."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from morse.mathutils import portable
from morse.plugins.weather import PROPERTY
from morse.plugins.weather.drawing import draw_lens_drops, draw_streaks, sky_in
from morse.plugins.weather.ground import LEVEL, SNOWY, Ground
from morse.plugins.weather.medium import DEPTH_OF_RANGE, THERMAL, VISIBLE, drops_of
from morse.plugins.weather.services import present
from morse.sensors.camera import PictureModifier

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from morse.core.declarations import Option
    from morse.core.object import Object
    from morse.core.values import Options
    from morse.plugins.weather.zones import Atmosphere
    from morse.rendering import Lens, Picture
    from morse.sensors.camera import Camera
    from morse.sensors.thermal_camera import ThermalCamera
    from morse.sensors.video_camera import VideoCamera

#: numbers of levels of the transmission, and of steps of the optical depth up to `_DEEPEST`
_LEVELS, _STEPS, _DEEPEST = 256, 4096, 6.0
#: exposure of a camera without a time of exposure, s
_EXPOSURE = 1.0 / 60.0


class _InAir(PictureModifier):
    """Knows how much air is between the camera and each pixel."""

    component_instance: Camera
    not_state = (*PictureModifier.not_state, "_lens", "_rays", "_lengths")
    uses = ("depth", "eye", "axes")

    def __init__(self, component_instance: Object, kwargs: Options) -> None:
        super().__init__(component_instance, kwargs)
        self._lens: Lens | None = None
        self._rays = (np.zeros((0, 0), np.float32),) * 2
        self._lengths = self._rays[0]

    def rays(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return right and down (H, W) of what `Lens.rays` returns; ahead is 1."""
        lens = self.component_instance.lens
        if self._lens is not lens:
            x, y, ahead = np.ascontiguousarray(np.moveaxis(lens.rays(), 2, 0))
            self._lens, self._rays = lens, (x, y)
            self._lengths = np.sqrt(x * x + y * y + ahead * ahead)
        return self._rays

    def optical_depth(self, air: Atmosphere, picture: Picture, wavelength: float) -> NDArray[np.float32]:
        """Return the optical depth (H, W) up to the surface in each pixel, or up to the sky."""
        x, y = self.rays()
        distances = picture.depth * self._lengths
        is_sky = picture.depth <= 0.0
        right, down, ahead = picture.axes[:, 2]
        rise = (x[is_sky] * right + y[is_sky] * down + ahead) / self._lengths[is_sky]
        distances[is_sky] = air.outside.way_to_sky(rise, wavelength)
        if not air.zones:
            distances *= np.float32(air.outside.extinction(wavelength))
            return distances
        ways = [(x * right + y * down + ahead) / self._lengths for right, down, ahead in picture.axes.T]
        return air.along(picture.eye, ways, distances, lambda one: one.extinction(wavelength)).astype(np.float32)


class CameraInWeather(_InAir):
    """Veils what is far away, draws the streaks of near drops and flakes, and changes the ground and the lens.

    The light of a surface reaches the camera with the transmission ``exp(-extinction * distance)``; the air adds light
    of the sky for the rest (H. Koschmieder, 1924). The share of the exposure for which a drop covers a pixel is the
    opacity of its streak (K. Garg, S. Nayar, Vision and Rain, 2007).
    """

    _names = ("Weather",)
    _components = ("VideoCamera",)
    options: ClassVar[Mapping[str, Option]] = {}
    component_instance: VideoCamera

    def __init__(self, component_instance: Object, kwargs: Options) -> None:
        super().__init__(component_instance, kwargs)
        script: Any = self.component_instance.context.scene.properties.get(PROPERTY, {})
        # neither changes in a run
        if any(script.get("first", {}).get(name) for name in ("wet", "snow_cover")):
            self.use("normals")

    def modify_picture(self, picture: Picture, time: float) -> Picture:
        """Return the picture in the present weather."""
        camera = self.component_instance
        air = present(camera.context)
        outside = air.outside
        if picture.rgba is None:
            return picture
        if air.is_clear and not (outside.lens_drops or outside.wet or outside.snow_cover):
            return picture
        rgba = picture.rgba.copy()
        if outside.wet:
            Ground.of(picture, self.rays(), LEVEL).water(rgba, outside.wet, camera.lens)
        if outside.snow_cover:
            Ground.of(picture, self.rays(), SNOWY).snow(rgba, outside.snow_cover)
        if not air.is_clear:
            around = air.at(picture.eye.tolist())
            _veil(rgba, self.optical_depth(air, picture, VISIBLE), sky_in(around))
            random = camera.context.random_at(f"{camera.name()}/weather", round(time * 1e6))
            exposure = float(camera.exposure_time) or _EXPOSURE
            for drops in drops_of(around):
                draw_streaks(rgba, drops, camera.lens, exposure, random, flakes=drops.reflectance > 0.5)
        if outside.lens_drops:
            name = f"{camera.name()}/lens"
            draw_lens_drops(
                rgba, outside.lens_drops, time, lambda place, turn: camera.context.random_at(f"{name}/{place}", turn)
            )
        return picture._replace(rgba=rgba)


def _veil(rgba: NDArray[np.uint8], depth: NDArray[np.float32], sky: tuple[int, int, int]) -> None:
    """Mix the codes of pixels with those of the sky, by their optical depth."""
    levels, mixed = _tables(sky)
    place = levels[_steps_of(depth)]
    for channel in range(3):
        rgba[..., channel] = mixed[channel].take(place | rgba[..., channel])


def _steps_of(depth: NDArray[np.float32]) -> NDArray[np.uint16]:
    """Return the steps (H, W) of the tables for optical depths (H, W)."""
    scaled = np.minimum(depth * np.float32((_STEPS - 1) / _DEEPEST), np.float32(_STEPS - 1))
    return np.asarray(scaled.astype(np.uint16))


@lru_cache(1)
def _transmissions() -> NDArray[np.float64]:
    """Return the share of the light that is left (`_STEPS`,), by step of the optical depth."""
    return portable.exp(-np.arange(_STEPS) * (_DEEPEST / (_STEPS - 1)))


@lru_cache(32)
def _tables(sky: tuple[int, int, int]) -> tuple[NDArray[np.uint16], NDArray[np.uint8]]:
    """Return by step of the optical depth the first place of a row of codes; (3, places) the mixed codes."""
    share = _transmissions().copy()
    share[-1] = 0.0
    rows = np.round(share * (_LEVELS - 1)).astype(np.uint16)
    shares = np.arange(_LEVELS)[:, None] / (_LEVELS - 1)
    codes = portable.linear_light(np.arange(256) / 255.0)
    mixed = np.stack([_codes(shares * codes + (1.0 - shares) * codes[code]).ravel() for code in sky])
    return (rows << 8).astype(np.uint16), mixed


def _codes(light: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return the codes of light from 0 to 1: the nearest ones."""
    codes = portable.linear_light(np.arange(256) / 255.0)
    borders = 0.5 * (codes[1:] + codes[:-1])
    return np.searchsorted(borders, light).astype(np.uint8)


class DepthInWeather(_InAir):
    """A depth camera measures no farther than the meteorological range, where 5 % of the contrast are left."""

    _names = ("Weather",)
    _components = ("AbstractDepthCamera",)
    options: ClassVar[Mapping[str, Option]] = {}

    def modify_picture(self, picture: Picture, time: float) -> Picture:
        """Return the picture without what is too far away."""
        air = present(self.component_instance.context)
        if air.is_clear:
            return picture
        is_far = self.optical_depth(air, picture, VISIBLE) > DEPTH_OF_RANGE
        return picture._replace(depth=np.where(is_far, np.float32(0.0), picture.depth))


class ThermalInWeather(_InAir):
    """The air absorbs the radiation of surfaces, and adds its own: that of the temperature of the surroundings.

    Radiation grows as the fourth power of the temperature (Stefan-Boltzmann); the extinction is that at 10 µm.
    """

    _names = ("Weather",)
    _components = ("ThermalCamera",)
    options: ClassVar[Mapping[str, Option]] = {}
    component_instance: ThermalCamera
    not_state = (*_InAir.not_state, "_depth")

    def __init__(self, component_instance: Object, kwargs: Options) -> None:
        super().__init__(component_instance, kwargs)
        self._depth: NDArray[np.float32] | None = None

    def modify_picture(self, picture: Picture, time: float) -> Picture:
        """Keep the optical depth of the picture."""
        air = present(self.component_instance.context)
        self._depth = None if air.is_clear else self.optical_depth(air, picture, THERMAL)
        return picture

    def modify(self) -> None:
        """Mix the temperatures of the last picture with that of the air."""
        depth, self._depth = self._depth, None
        image = self.data["image"]
        if depth is None or not np.shape(image):
            return
        seen = self.component_instance.ordered(_transmissions()[_steps_of(depth)])
        square, air = (np.asarray(image, np.float64) + _ZERO) ** 2, (self.component_instance._ambient + _ZERO) ** 2
        power = air * air + seen * (square * square - air * air)
        self.data["image"] = (np.sqrt(np.sqrt(power)) - _ZERO).astype(np.float32)


#: 0 °C, K
_ZERO = 273.15
