"""Updates data that the engine computes from the shapes of a body only at compile time."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from morse.physics.state.engine_state import EngineState

#: m; larger than the distance of any shape from its body
_FAR = 1e6


class MovedShapes:
    """Bodies whose shapes have moved within them.

    The engine finds pairs of shapes that may touch with a tree of bounding boxes, which it never updates. For a body
    whose shapes have moved, the boxes are made so large that every pair of shapes is tested.
    """

    def __init__(self, state: EngineState) -> None:
        self._state = state
        self._boxes: dict[int, NDArray[np.float64]] = {}

    def note(self, body: int) -> None:
        """Enlarge the boxes of a body whose shapes have moved."""
        if body in self._boxes:
            return
        model = self._state.model
        start, count = int(model.body_bvhadr[body]), int(model.body_bvhnum[body])
        rows = slice(start, start + count)
        if count:
            self._boxes[body] = model.bvh_aabb[rows].copy()
            model.bvh_aabb[rows] = (0.0, 0.0, 0.0, _FAR, _FAR, _FAR)

    def reset(self) -> None:
        """Restore the boxes, because all shapes are at their compiled poses."""
        model = self._state.model
        for body, boxes in self._boxes.items():
            start = int(model.body_bvhadr[body])
            model.bvh_aabb[start : start + len(boxes)] = boxes
        self._boxes.clear()
