"""Sends the fields of view of cameras to pages."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.viewer.view_messages import Frustum

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.core.values import JsonObject
    from morse.rendering.lens import Lens
    from morse.viewer.server import ViewServer

#: number of directions for each side of an image: a fisheye lens bends the sides
SIDE = 8
#: number of steps from the border of an image to its centre, to find the first valid pixel
_STEPS = 64


class ViewFrustums:
    """Sends the fields of view of the cameras whose overlays are shown, after every change of a lens."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._last_frustums: JsonObject = {}

    def restarted(self) -> None:
        """Send everything again, because the components are described again."""
        self._last_frustums.clear()

    def update(self) -> None:
        """Send the changes since the last call."""
        for name in sorted(self._server.wishes.overlays):
            component = self._context.components.get(name)
            lens = getattr(component, "lens", None)
            if lens is not None and self._last_frustums.get(name) is not lens:
                self._last_frustums[name] = lens
                self._server.send(Frustum(name, [(x, y, z) for x, y, z in rim(lens).tolist()], lens.near, lens.far))


def rim(lens: Lens) -> NDArray[np.float64]:
    """The directions of the border of an image, (4 * SIDE, 3), clockwise from the upper left corner.

    Where pixels of the border are not valid, as in the corners of some fisheye images, the nearest valid pixel on the
    way to the centre is used.
    """
    share = np.arange(SIDE) / SIDE
    one, none = np.ones(SIDE), np.zeros(SIDE)
    across = np.concatenate([share, one, 1.0 - share, none])
    down = np.concatenate([none, share, one, 1.0 - share])
    table = getattr(lens, "directions", None)
    if table is None:
        image_points = np.stack(
            [(across * lens.width - lens.cx) / lens.fx, (down * lens.height - lens.cy) / lens.fy], axis=1
        )
        image_points = np.column_stack([image_points, np.ones(len(image_points))])
        return np.asarray(image_points / np.linalg.norm(image_points, axis=1, keepdims=True), float)
    directions, shows = table
    inward = np.linspace(0.0, 1.0, _STEPS)[:, None]
    columns = np.clip((across + (0.5 - across) * inward) * lens.width, 0, lens.width - 1).astype(int)
    rows = np.clip((down + (0.5 - down) * inward) * lens.height, 0, lens.height - 1).astype(int)
    first = shows[rows, columns].argmax(axis=0)
    every = np.arange(len(across))
    return np.asarray(directions[rows[first, every], columns[first, every]], float)
