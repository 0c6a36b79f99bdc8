"""Software rendering of camera images, bit-identical on every machine.

Scenes without cameras do not import this package.
"""

from morse.rendering import distortion, flow, things  # noqa: F401 (cameras use them from the first image on)
from morse.rendering.distortion import DistortedLens
from morse.rendering.lens import Lens, Motion
from morse.rendering.picture import Picture
from morse.rendering.renderer import Renderer, photograph
from morse.rendering.requests import CameraRequest

__all__ = ["CameraRequest", "DistortedLens", "Lens", "Motion", "Picture", "Renderer", "photograph"]
