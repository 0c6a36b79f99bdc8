"""A picture of a world from anywhere, without a camera in the scene."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.mathutils import Euler
from morse.rendering.lens import Lens
from morse.rendering.renderer import Renderer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.physics import World

_FAR = 1000.0


class Tripod:
    """Holds a camera that looks along its own -Z axis, as those of Blender and of ``env.set_camera_rotation`` do.

    Args:
        location: metres in the world.
        rotation: Euler angles about X, Y and Z, radians.
    """

    def __init__(self, location: Sequence[float], rotation: Sequence[float]) -> None:
        self._location = _three(location, "location")
        axes = np.array([list(row) for row in Euler(_three(rotation, "rotation")).to_matrix()])
        # the renderer looks along Z, with Y down
        self._axes = (axes * (1.0, -1.0, -1.0)).ravel()

    def world_pose(self) -> tuple[Any, Any]:
        """Position, and the rows of the rotation."""
        return self._location, self._axes


def _three(values: Sequence[float], what: str) -> tuple[float, ...]:
    numbers = tuple(float(value) for value in values)
    if len(numbers) != 3 or not all(map(math.isfinite, numbers)):
        raise ValueError(f"the {what} of a camera is three finite numbers, got {values!r:.80}")
    return numbers


def photograph(
    world: World,
    width: int = 960,
    height: int = 600,
    location: Sequence[float] | None = None,
    rotation: Sequence[float] | None = None,
    focal_length: float | None = None,
) -> NDArray[np.uint8]:
    """Draw a world as it is now.

    Args:
        width: pixels.
        height: pixels.
        location: of the camera, m; None for where the live view begins.
        rotation: Euler angles about X, Y, Z, rad: ``[0, 0, 0]`` looks straight down; None for that of the live view.
        focal_length: mm, of a sensor 32 mm wide; None for that of the live view.

    Returns:
        (height, width, 3) uint8, red, green and blue.

    Raises:
        ValueError: numbers that make no picture.
    """
    view = world.scene.settings.view
    focal = view.camera_focal_length if focal_length is None else focal_length
    lens = Lens.of_focal_length(width, height, focal, view.camera_clip[0], _FAR)
    place = view.camera_location if location is None else location
    turned = view.camera_rotation if rotation is None else rotation
    renderer = Renderer(world)
    request = renderer.request(Tripod(place, turned), lens)  # type: ignore[arg-type] # all that it asks for is the pose
    renderer.serve([request])
    assert request.picture is not None
    assert request.picture.rgb is not None
    return request.picture.rgb
