"""Warnings about meshes whose collision shapes are less exact than the mesh."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(slots=True)
class Losses:
    """The record of lost accuracy.

    Attributes:
        coarse: error and size of each piece that was simplified, m.
        hulls: size of each piece that was replaced by its convex hull, m.
        grouped: size of each piece that shares a hull with other pieces, m, the largest first.
    """

    coarse: list[tuple[float, float]] = field(default_factory=list)
    hulls: list[float] = field(default_factory=list)
    grouped: list[float] = field(default_factory=list)

    def told(self, limit: int) -> list[str]:
        """Return a sentence for the user if the limit of parts reduced the accuracy; otherwise an empty string."""
        parts = []
        if self.coarse:
            error, size = max(self.coarse)
            parts.append(f"{_pieces(self.coarse, size)} simplified, with an error of up to {error:.2g} m")
        if self.hulls:
            parts.append(f"{_pieces(self.hulls, max(self.hulls))} replaced by the convex hull, which fills cavities")
        if self.grouped:
            parts.append(f"{_pieces(self.grouped, self.grouped[0])} combined with neighbours into hulls")
        if not parts:
            return []
        return [
            f"the mesh has too many faces for {limit} convex parts: {'; '.join(parts)}. "
            f"Give it collision shapes of its own, or fewer faces"
        ]


def _pieces(sizes: list[float] | list[tuple[float, float]], size: float) -> str:
    return f"a piece {size:.3g} m across was" if len(sizes) == 1 else f"{len(sizes)} pieces of up to {size:.3g} m were"
