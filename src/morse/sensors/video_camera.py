"""Colour images."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.helpers.components import add_data, add_kind, add_property, add_state
from morse.sensors.camera import CAMERA_INFO, INTRINSIC, Camera

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.realism import Noise
    from morse.core.robot import Robot
    from morse.core.world import Body
    from morse.rendering import Picture
    from morse.sensors.delayed_pictures import Exposure


#: codes of 18 % of the light, the grey of photographers; codes are approximately the light to the power of this number
_MIDDLE, _GAMMA = 118.0, 2.2
#: share of the difference that is corrected in one image; limits in stops, for one image and in all
_SPEED, _MOST_STOPS, _FARTHEST = 0.4, 1.0, 12.0


def _pixels(camera: VideoCamera) -> NDArray[np.uint8]:
    """(H, W, 4) RGBA, the top row first."""
    return camera.top_first(camera.local_data["image"])


class VideoCamera(Camera):
    """Captures colour images."""

    _name = "Video camera"
    _short_desc = "A camera capturing RGBA image"

    add_data(
        "image",
        np.zeros((0, 0, 4), np.uint8),
        "buffer",
        "The image, RGBA",
        frame="optical",
        shape=(None, None, 4),
        dtype="uint8",
        low=0,
        high=255,
    )

    add_data("intrinsic_matrix", **INTRINSIC)

    add_property(
        "exposure", 0.0, "exposure", "float", "Exposure in stops; each stop doubles the light", low=-20.0, high=20.0
    )
    add_property(
        "auto_exposure",
        False,
        "auto_exposure",
        "bool",
        "Adjust the exposure from image to image, until the mean of all codes is 118: 18 % of the light",
    )
    add_property(
        "full_well",
        0.0,
        "full_well",
        "float",
        "Number of electrons of the brightest pixel, which determines the shot noise; 0 for no shot noise",
        low=0.0,
        high=1e9,
    )
    add_property(
        "read_noise",
        0.0,
        "read_noise",
        "float",
        "Standard deviation of the read-out, as a share of the brightest light",
        low=0.0,
        high=1.0,
    )
    add_property(
        "stuck_pixels",
        0.0,
        "stuck_pixels",
        "float",
        "Share of dead pixels, which are always black or white",
        low=0.0,
        high=1.0,
    )

    add_property(
        "exposure_time",
        0.0,
        "exposure_time",
        "float",
        "Time for which the image is exposed, until its tick: motion blur",
        unit="s",
        low=0.0,
        high=1.0,
    )
    add_property(
        "readout_time",
        0.0,
        "readout_time",
        "float",
        "Time from the read-out of the top row to that of the bottom row, at the tick of the image: rolling shutter",
        unit="s",
        low=0.0,
        high=1.0,
    )
    add_property(
        "motion_steps",
        16,
        "motion_steps",
        "integer",
        "Number of instants of an exposure, and of bands of rows, that are rendered separately",
        low=2,
        high=64,
    )

    add_property(
        "compression",
        "",
        "compression",
        "string",
        "Format of image files in streams over the socket, instead of RGBA",
        choices=("", "jpeg", "png"),
    )
    add_property("quality", 90, "quality", "integer", "Of JPEG", low=1, high=100)

    add_kind("image", pixels=_pixels, encoding="rgba8")
    add_kind("camera_info", **CAMERA_INFO)

    add_state("_adjusted", float, "Exposure of the last image")
    add_state("_random", np.random.Generator, "Noise of the pixels")

    uses = ("rgb",)
    noise_mend = "because an image has 'full_well', 'read_noise', 'stuck_pixels'; field='image' adds noise to its codes"
    exposure: float
    auto_exposure: bool
    full_well: float
    read_noise: float
    stuck_pixels: float
    exposure_time: float
    readout_time: float
    motion_steps: int
    compression: str
    quality: int

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._random = self.context.random(f"{self.name()}/pixels")
        #: stops that the automatic exposure adds
        self._adjusted = 0.0

    def _wants(self) -> bool:
        for exposure in self.under_way:
            self._meter(exposure)
        # the property may have been set while the simulation runs
        self.request.exposure = math.exp2(self.exposure + (self._adjusted if self.auto_exposure else 0.0))
        self.request.motion = None
        if self.exposure_time or self.readout_time:
            from morse.rendering import Motion

            self.request.motion = Motion(self.exposure_time, self.readout_time, self.motion_steps)
        return super()._wants()

    def develop(self, exposure: Exposure) -> None:
        """Adjust the exposure of the next image, and store this one."""
        self._meter(exposure)
        super().develop(exposure)

    def _meter(self, exposure: Exposure) -> None:
        """Adjust the exposure by the light of an image, once."""
        if not self.auto_exposure or exposure.is_metered:
            return
        exposure.is_metered = True
        rgba = exposure.picture().rgba
        assert rgba is not None
        pixels = rgba.shape[0] * rgba.shape[1]
        # the sum of contiguous memory is several times faster; the opacity is 255 everywhere
        self._adjust((int(rgba.sum(dtype=np.int64)) - 255 * pixels) / (3 * pixels))

    def take(self, picture: Picture) -> None:
        """Store the image."""
        image = picture.rgba
        assert image is not None
        if self.full_well or self.read_noise or self.stuck_pixels:
            from morse.rendering.picture import Chip, exposed

            chip = Chip(self.full_well, self.read_noise, self.stuck_pixels)
            image = image.copy()
            flaws = self.context.random(f"{self.name()}/stuck pixels")
            image[..., :3] = exposed(chip, image[..., :3], self._random, flaws)
        self.local_data["image"] = self.ordered(image)

    def _adjust(self, mean: float) -> None:
        """Adjust the exposure towards images that are neither dark nor bright."""
        target = _GAMMA * math.log2(_MIDDLE / max(mean, 1.0))
        step = min(max(_SPEED * target, -_MOST_STOPS), _MOST_STOPS)
        self._adjusted = min(max(self._adjusted + step, -_FARTHEST), _FARTHEST)

    def noisy_fields(self) -> tuple[str, ...]:
        """Return no fields, because properties of the camera determine the noise of its sensor."""
        return ()

    def add_noise(self, field: str, noise: Noise, before: object) -> None:
        """Add errors to the colours of an image, but not to its opacity."""
        super().add_noise(field, noise, before)
        image = self.local_data[field]
        if field == "image" and image is not before and image.size:
            image[..., 3] = 255
