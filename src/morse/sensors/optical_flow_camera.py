"""Measures the motion of the visible points in the image."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.helpers.components import add_data, add_kind, add_state
from morse.sensors.camera import CAMERA_INFO, INTRINSIC, Camera

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.robot import Robot
    from morse.core.world import Body
    from morse.rendering import Picture


def _vectors(camera: OpticalFlowCamera) -> NDArray[np.float32]:
    """(H, W, 2), the top row first."""
    return camera.top_first(camera.local_data["image"])


class OpticalFlowCamera(Camera):
    """Measures optical flow: the displacement of each visible point in the image since the previous image.

    The flow is exact, because it is computed from the poses of the camera and of all objects. The first image has no
    flow.
    """

    _name = "Optical flow camera"
    _short_desc = "A camera that measures the motion of each point in the image"

    add_data(
        "image",
        np.zeros((0, 0, 2), np.float32),
        "buffer",
        "Displacement of each pixel since the previous image, px, to the right and down; NaN for points that were "
        "not in front of the camera",
        unit="px",
        frame="optical",
        shape=(None, None, 2),
        dtype="float32",
        allow=("nan",),
    )
    add_data("intrinsic_matrix", **INTRINSIC)

    add_kind("image", pixels=_vectors, encoding="32FC2", unit="px")
    add_kind("camera_info", **CAMERA_INFO)

    add_state("_before", object, "Poses at the last image")

    color = False
    uses = ("depth", "ids", "names", "models", "eye", "axes")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        #: a `morse.rendering.flow.Moment`: the poses of the previous image
        self._before: tuple[Any, ...] | None = None

    def take(self, picture: Picture) -> None:
        """Compare with the last image."""
        from morse.rendering.flow import Moment, moment_of, optical_flow

        now = moment_of(picture)
        before = now if self._before is None else Moment(*self._before)
        flow = optical_flow(picture, self.lens, before)
        self.local_data["image"] = self.ordered(flow)
        self._before = tuple(now)

    def noisy_fields(self) -> tuple[str, ...]:
        """Return no fields, because noise cannot be added to an image."""
        return ()
