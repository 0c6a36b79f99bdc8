"""The magnetic field of the earth: World Magnetic Model of NOAA and the British Geological Survey."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

from morse.mathutils.rotations import turn

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.helpers.geodesy import LocalPlane
    from morse.mathutils.rotations import Triple

#: first and last decimal year of each model
MODELS: dict[str, tuple[float, float]] = {
    "WMM2010": (2010.0, 2015.0),
    "WMM2015": (2015.0, 2020.0),
    "WMM2015v2": (2015.0, 2020.0),
    "WMM2020": (2020.0, 2025.0),
    "WMM2025": (2025.0, 2030.0),
}
#: decimal year of simulations without a date: the first year of the latest model
DEFAULT_YEAR = 2025.0
#: Size of cells in which the field is interpolated linearly, m. The second
#: derivative of a dipole at the surface is 12 B / r^2 < 2e-8 nT/m^2: at 350 m from the centre the error is 1e-3 nT.
_CELL = 400.0
_Cell = tuple["Triple", "tuple[float, ...]"]


def model_of(year: float) -> str:
    """Return the model for a decimal year, or the nearest model outside the range of all models.

    Of the two models of 2015, the first one is used, as in MORSE 1.4.
    """
    for name, (_, last) in MODELS.items():
        if year < last:
            return name
    return "WMM2025"


class MagneticField:
    """The magnetic field around a world on one day.

    The field vector is given along east, north and up at the position of the sensor, rotated by
    ``angle_against_north``. The world is flat, and gravity acts along its Z axis everywhere.

    Args:
        plane: position of the world on the earth.
        year: decimal year.
        model: one of `MODELS`; None for the model of the year.
    """

    def __init__(self, plane: LocalPlane, year: float, model: str | None = None) -> None:
        # imported on demand, because the import takes a long time
        from pygeomag import GeoMag

        self._plane = plane
        self._year = year
        name = (model or model_of(year)).replace("WMM", "WMM_")
        self._model = GeoMag(coefficients_file=f"wmm/{name}.COF")
        # reads the coefficients now: within a tick, there may be no file descriptor left
        self._exact((0.0, 0.0, 0.0))
        self._cell = lru_cache(maxsize=64)(self._worked_out)

    def at(self, position: Sequence[float]) -> Triple:
        """Return the field along the axes of the world, nT.

        Args:
            position: position in the world, m.
        """
        x, y, z = position
        i, j, k = round(x / _CELL), round(y / _CELL), round(z / _CELL)
        (fx, fy, fz), slope = self._cell(i, j, k)
        dx, dy, dz = turn(slope, (x - i * _CELL, y - j * _CELL, z - k * _CELL))
        return fx + dx, fy + dy, fz + dz

    def north_east_down(self, position: Sequence[float]) -> Triple:
        """Return the field towards north, east and down, nT.

        Args:
            position: position in the world, m.
        """
        east, north, up = self._plane.enu_of(self.at(position))
        return north, east, -up

    def _worked_out(self, i: int, j: int, k: int) -> _Cell:
        """Compute the field in the centre of a cell, and its gradient, row by row."""
        x, y, z = i * _CELL, j * _CELL, k * _CELL
        half = 0.5 * _CELL
        differences = [
            [(b - a) / _CELL for a, b in zip(self._exact(before), self._exact(after), strict=True)]
            for before, after in (
                ((x - half, y, z), (x + half, y, z)),
                ((x, y - half, z), (x, y + half, z)),
                ((x, y, z - half), (x, y, z + half)),
            )
        ]
        slope = tuple(differences[axis][component] for component in range(3) for axis in range(3))
        return self._exact((x, y, z)), slope

    def _exact(self, position: Sequence[float]) -> Triple:
        longitude, latitude, altitude = self._plane.geodetic_of(position)
        longitude = math.remainder(longitude, 360.0)
        result = self._model.calculate(
            glat=latitude, glon=longitude, alt=altitude / 1000.0, time=self._year, allow_date_outside_lifespan=True
        )
        return self._plane.world_of_enu((result.y, result.x, -result.z))
