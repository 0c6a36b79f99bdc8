"""What cameras see: drawn in software, the same bits on every machine.

Nothing is imported by a scene without cameras.
"""

from morse.rendering.distortion import DistortedLens
from morse.rendering.lens import Lens
from morse.rendering.photograph import photograph
from morse.rendering.renderer import Renderer
from morse.rendering.request import CameraRequest, Picture

__all__ = ["CameraRequest", "DistortedLens", "Lens", "Picture", "Renderer", "photograph"]
