"""Images of a world from any pose, without a camera in the scene."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils import Euler
from morse.mathutils.portable import norm
from morse.rendering.lens import Lens
from morse.rendering.renderer import Renderer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.physics import World
    from morse.scene import ViewSettings


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
