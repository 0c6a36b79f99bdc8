"""The magnetic field of the earth."""

from __future__ import annotations

import datetime
import math
from functools import lru_cache
from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind, add_property, add_state
from morse.helpers.geodesy import LocalPlane
from morse.mathutils.rotations import turn, turn_back

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.robot import Robot
    from morse.core.world import Body
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


def field_around(sensor: Sensor, year: float | None = None, model: str | None = None) -> MagneticField:
    """Return the magnetic field in the world of a sensor.

    Args:
        year: decimal year; None for the date at which the scene begins, or `DEFAULT_YEAR` if it has none.

    Raises:
        GeodesyError: the environment does not declare its position on the earth.
    """
    if year is None:
        absolute = not sensor.context.scene.settings.relative_time
        year = _decimal_year(sensor.clock.time) if absolute else DEFAULT_YEAR
    return MagneticField(LocalPlane.of(sensor.context.scene.properties), year, model)


def _decimal_year(seconds: float) -> float:
    date = datetime.datetime.fromtimestamp(seconds, datetime.UTC)
    begin = datetime.datetime(date.year, 1, 1, tzinfo=datetime.UTC)
    end = datetime.datetime(date.year + 1, 1, 1, tzinfo=datetime.UTC)
    return date.year + (date - begin) / (end - begin)


class Magnetometer(Sensor):
    """Measures the magnetic field of the earth, from the World Magnetic Model.

    The data are the field towards north, east and down, rotated into the sensor as if these were the axes of the world,
    as in MORSE 1.4: a sensor that is not rotated has X north, Y east and Z down. Messages of the kind
    ``magnetic_field`` contain the field along the axes of the sensor.

    The environment has to declare its position on the earth:
    ``env.properties(longitude=..., latitude=..., altitude=...)``.
    """

    _name = "Magnetometer"
    _short_desc = "A sensor returning the magnetic field of the earth"
    _source = "World Magnetic Model of NOAA/NCEI and BGS, 2010 to 2025; computed by pygeomag"
    _builder = BuilderDefaults(visual=Visual("cube", (0.04, 0.04, 0.02), (0.3, 0.3, 0.9)))

    add_data("x", 0.0, "float", "Field towards north, if the sensor is not rotated", unit="nT", frame="ned_as_world")
    add_data("y", 0.0, "float", "Field towards east, if the sensor is not rotated", unit="nT", frame="ned_as_world")
    add_data("z", 0.0, "float", "Field downwards, if the sensor is not rotated", unit="nT", frame="ned_as_world")
    add_property(
        "_date",
        None,
        "date",
        "float",
        "Decimal year; none for the date of the scene, which is 2025.0 unless it has a date or absolute time",
        low=2010.0,
        high=2030.0,
        allow=("none",),
    )
    add_property(
        "_model",
        "auto",
        "Model",
        "string",
        "Name of the model; auto for the model of the date",
        choices=("auto", *MODELS),
    )
    add_kind("magnetic_field", field=("x", "y", "z"))

    add_state("_wanted", tuple, "Date and model of the field in use")

    _date: float | None
    _model: str

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._take_model()

    def _take_model(self) -> None:
        self._wanted = (self._date, self._model)
        self._field = field_around(self, self._date, None if self._model == "auto" else self._model)

    def measure(self) -> None:
        """Measure the field."""
        if self._wanted != (self._date, self._model):
            self._take_model()
        position, rotation = self.position_3d.get_pose()
        data = self.local_data
        data["x"], data["y"], data["z"] = turn_back(rotation, self._field.north_east_down(position))
