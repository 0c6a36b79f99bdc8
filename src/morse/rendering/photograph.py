"""Images of a world from any pose, without a camera in the scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.rendering.lens import Lens
from morse.rendering.renderer import Renderer
from morse.rendering.viewpoint import Viewpoint

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.physics import World

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
