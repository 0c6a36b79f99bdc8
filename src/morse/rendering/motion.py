"""Motion blur and rolling shutter: images that are exposed over a time, not at an instant."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Motion:
    """When the rows of an image are exposed; the exposure of the last row ends at the tick of the image.

    Attributes:
        exposure: time for which each row is exposed, s.
        readout: time from the read-out of the first row to that of the last row, s.
        steps: number of instants of an exposure that are rendered, and number of bands of rows that are rendered apart.
    """

    exposure: float = 0.0
    readout: float = 0.0
    steps: int = 16

    def bands(self, height: int) -> list[Band]:
        """Return the bands of an image with that many rows."""
        count = min(self.steps, height) if self.readout else 1
        instants = self.steps if self.exposure else 1
        cuts = [height * number // count for number in range(count + 1)]
        return [
            Band(
                first,
                last,
                [
                    -self.readout * (1.0 - (first + last) / (2 * height)) - self.exposure * (n + 0.5) / instants
                    for n in range(instants)
                ],
            )
            for first, last in itertools.pairwise(cuts)
        ]


class Band(NamedTuple):
    """Rows that are exposed at the same time.

    Attributes:
        first, last: the first row, and one past the last row.
        times: the instants to render, s, relative to the tick of the image.
    """

    first: int
    last: int
    times: list[float]


def moved(
    positions: NDArray[np.float64],
    rotations: NDArray[np.float64],
    linear: NDArray[np.float64],
    angular: NDArray[np.float64],
    time: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return poses at another time, at constant velocities.

    Args:
        positions, rotations: (N, 3) and (N, 3, 3), frame of the world.
        linear, angular: (N, 3) m/s and (N, 3) rad/s, world axes.
        time: s, relative to that of the poses.
    """
    half = angular * (time / 2)
    square = half[:, 0] ** 2 + half[:, 1] ** 2 + half[:, 2] ** 2
    # the series of tan(a) / a: operations that are rounded the same everywhere
    x, y, z = (half * (1 + square / 3 + 2 * square**2 / 15 + 17 * square**3 / 315)[:, None]).T
    turn = np.empty((len(half), 3, 3))
    turn[:, 0] = np.stack([1 + x * x - y * y - z * z, 2 * (x * y - z), 2 * (x * z + y)], axis=1)
    turn[:, 1] = np.stack([2 * (x * y + z), 1 - x * x + y * y - z * z, 2 * (y * z - x)], axis=1)
    turn[:, 2] = np.stack([2 * (x * z - y), 2 * (y * z + x), 1 - x * x - y * y + z * z], axis=1)
    turn /= (1 + x * x + y * y + z * z)[:, None, None]
    rows = [
        sum((turn[:, i, k, None] * rotations[:, k] for k in (1, 2)), turn[:, i, 0, None] * rotations[:, 0])
        for i in range(3)
    ]
    return positions + linear * time, np.stack(rows, axis=1)
