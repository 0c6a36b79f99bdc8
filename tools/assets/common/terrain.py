"""Land: flat around given positions, with hills towards its borders."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from common.parts import Part

if TYPE_CHECKING:
    from collections.abc import Sequence

    import bpy

    from common.objects import Triple

SPREAD = 6.0  # metres: range of a given height
SMOOTH = 0.05  # smoothing of given heights


class Terrain:
    """A height for every position of a rectangle.

    Args:
        low: smallest (x, y).
        high: largest (x, y).
        rise: height of the hills near the border, m.
        level: positions and their heights.
    """

    def __init__(self, low: Sequence[float], high: Sequence[float], rise: float, level: Sequence[Triple], seed: int):
        self.low, self.high, self.rise = np.array(low), np.array(high), rise
        self._waves = np.random.default_rng(seed).uniform(0.0, 2 * np.pi, (4, 3))
        self._places = np.array([place[:2] for place in level]).reshape(-1, 2)
        heights = np.array([place[2] for place in level])
        self._weights = np.zeros(len(level))
        if len(level):
            missing = heights - self._hills(self._places)
            self._weights = np.linalg.solve(self._reach(self._places) + SMOOTH * np.eye(len(level)), missing)

    def __call__(self, places: np.ndarray) -> np.ndarray:
        """Heights at (N, 2) positions."""
        heights = self._hills(places)
        if len(self._places):
            heights = heights + self._reach(places) @ self._weights
        return np.where(np.abs(heights) < 0.02, 0.0, np.clip(heights, 0.0, self.rise))

    def _reach(self, places: np.ndarray) -> np.ndarray:
        squared = ((places[:, None, :] - self._places[None, :, :]) ** 2).sum(axis=-1)
        return np.exp(-squared / (2 * SPREAD**2))

    def _hills(self, places: np.ndarray) -> np.ndarray:
        middle, half = (self.low + self.high) / 2, (self.high - self.low) / 2
        edge = np.abs((places - middle) / half).max(axis=1)
        x, y = places[:, 0], places[:, 1]
        waves = sum(
            np.sin(x / (9.0 + 4 * k) + a) * np.cos(y / (11.0 + 3 * k) + b) + 0.3 * np.sin((x + y) / 17 + c)
            for k, (a, b, c) in enumerate(self._waves)
        )
        return self.rise * np.clip((edge - 0.72) / 0.28, 0.0, 1.0) ** 1.5 * np.clip(0.55 + 0.22 * waves, 0.0, 1.0)

    def part(self, cell: float, paint: bpy.types.Material, metres: float) -> Part:
        """The surface in squares of about ``cell`` metres, with a texture from above."""
        counts = [max(round(extent / cell), 1) + 1 for extent in self.high - self.low]
        x, y = (np.linspace(a, b, n) for a, b, n in zip(self.low, self.high, counts, strict=True))
        grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
        vertices = np.column_stack([grid, self(grid)])
        width = counts[1]
        faces = [
            (i * width + j, (i + 1) * width + j, (i + 1) * width + j + 1, i * width + j + 1)
            for i in range(counts[0] - 1)
            for j in range(width - 1)
        ]
        return Part(vertices, faces, paint, [grid[list(face)] / metres for face in faces])
