"""Ray directions of laser scanners."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils import portable

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: maximum number of rays of a scanner
MOST_RAYS = 1_000_000
#: maximum number of layers: the layers of a scan of one ray each would take as long as so many rays in one layer
MOST_LAYERS = 1024


def fan(
    window: float, resolution: float, layers: float = 1, separation: float = 0.0, offset: float = 0.0
) -> NDArray[np.float64]:
    """Return unit vectors (N, 3) around the X axis, Y left, Z up.

    The vectors of a layer go from ``-window / 2`` (right) to ``window / 2`` (left) in steps of ``resolution``, both
    ends included. Layers are ordered from top to bottom. Every other layer, beginning with the first, is rotated by
    ``offset``; a single layer is not rotated.

    Args:
        window: horizontal field of view, degrees, 0 to 360.
        resolution: angle between two rays, degrees.
        layers: number of layers, 1 to `MOST_LAYERS`.
        separation: angle between two layers, degrees.
        offset: horizontal rotation of every other layer, degrees.

    Raises:
        ValueError: a value is not valid, or there are more than `MOST_RAYS` rays.
    """
    if not 0.0 <= window <= 360.0:
        raise ValueError(f"scan_window takes degrees from 0 to 360, got {window!r}")
    if not 0.0 < resolution < math.inf:
        raise ValueError(f"resolution takes degrees greater than 0, got {resolution!r}")
    if not (1 <= layers <= MOST_LAYERS and layers == int(layers)):
        raise ValueError(f"layers takes an integer from 1 to {MOST_LAYERS}, got {layers!r}")
    if not (math.isfinite(separation) and abs(separation) * (layers - 1) <= 180.0):
        raise ValueError(f"{layers:g} layers {separation!r} degrees apart (layer_separation) do not fit in 180 degrees")
    if not math.isfinite(offset):
        raise ValueError(f"layer_offset takes degrees, got {offset!r}")
    steps = window / resolution
    if (steps + 1) * layers > MOST_RAYS:
        raise ValueError(f"{window:g} degrees (scan_window) in steps of {resolution:g} (resolution) are too many rays")
    # tolerance for rounding: 31.5 / 0.1 is a little less than 315
    angles = np.radians(np.arange(math.floor(steps * (1.0 + 1e-12) + 1e-9) + 1) * resolution - window / 2)
    heights = np.radians((layers - 1) / 2 * separation - np.arange(int(layers)) * separation)
    turns = np.zeros(int(layers))
    if layers > 1:
        turns[::2] = math.radians(offset)
    azimuth = angles + turns[:, None]
    return np.stack(
        [
            portable.cos(azimuth) * portable.cos(heights)[:, None],
            portable.sin(azimuth) * portable.cos(heights)[:, None],
            np.broadcast_to(portable.sin(heights)[:, None], azimuth.shape),
        ],
        axis=2,
    ).reshape(-1, 3)
