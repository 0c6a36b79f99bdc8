"""Images of surface normals."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.helpers.components import add_data, add_kind
from morse.sensors.camera import CAMERA_INFO, INTRINSIC, Camera

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.rendering import Picture


def _vectors(camera: NormalCamera) -> NDArray[np.float32]:
    """(H, W, 3), the top row first."""
    return camera.top_first(camera.local_data["image"])


class NormalCamera(Camera):
    """Measures the normal of the surface in each pixel.

    Normals are unit vectors in the frame of the camera and point out of the visible side of a surface. On smooth meshes
    they are interpolated between the vertices.
    """

    _name = "Normal camera"
    _short_desc = "A camera that measures the normals of surfaces"

    add_data(
        "image",
        np.zeros((0, 0, 3), np.float32),
        "buffer",
        "Normal of the surface in each pixel: X right, Y down, Z forward; (0, 0, 0) without a surface",
        frame="optical",
        shape=(None, None, 3),
        dtype="float32",
        low=-1.0,
        high=1.0,
    )
    add_data("intrinsic_matrix", **INTRINSIC)

    add_kind("image", pixels=_vectors, encoding="32FC3", unit="1")
    add_kind("camera_info", **CAMERA_INFO)

    color = False
    normals = True
    uses = ("normals",)

    def take(self, picture: Picture) -> None:
        """Store the normals."""
        assert picture.normals is not None
        self.local_data["image"] = self.ordered(np.clip(picture.normals, -1.0, 1.0))

    def noisy_fields(self) -> tuple[str, ...]:
        """Return no fields, because noise cannot be added to unit vectors."""
        return ()
