"""Linear light of colours."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils import portable

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray


def linear_light(codes: ArrayLike) -> NDArray[np.float64]:
    """Return the linear light, 0 to 1, of sRGB values, 0 to 1 (IEC 61966-2-1)."""
    values = np.asarray(codes, dtype=np.float64)
    return np.asarray(
        np.where(values <= 0.04045, values / 12.92, portable.power((np.maximum(values, 0.0) + 0.055) / 1.055, 2.4))
    )


def linear_color(color: Sequence[float]) -> tuple[float, float, float, float]:
    """Return the linear light and the opacity of a colour whose numbers programs show as they are, sRGB."""
    red, green, blue = linear_light(color[:3]).tolist()
    return red, green, blue, float(color[3])
