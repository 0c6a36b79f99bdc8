"""Convex decomposition by CoACD, if it is installed.

X. Wei et al., "Approximate convex decomposition for 3D meshes with collision-aware concavity and tree search" (2022).
"""

from __future__ import annotations

import importlib
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.assets.shapes.parts import hull_part

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.assets.shapes.parts import ConvexPart

#: concavity that is tolerated (the default of CoACD), and vertices of a hull
_THRESHOLD, _VERTICES = 0.05, 64


@cache
def coacd_version() -> str:
    """The version of CoACD; empty if it is not installed."""
    try:
        return version("coacd")
    except PackageNotFoundError:
        return ""


def coacd_parts(vertices: NDArray[np.float64], triangles: NDArray[np.int64], budget: int) -> list[ConvexPart]:
    """Return convex parts of a mesh of vertices (V, 3), m, and triangles (T, 3).

    Args:
        budget: maximum number of parts.
    """
    coacd: Any = importlib.import_module("coacd")
    coacd.set_log_level("off")
    hulls = coacd.run_coacd(
        coacd.Mesh(vertices, triangles),
        threshold=_THRESHOLD,
        max_convex_hull=budget,
        decimate=True,
        max_ch_vertex=_VERTICES,
        seed=0,
    )
    return [hull_part(np.asarray(points, dtype=np.float64)) for points, _ in hulls]
