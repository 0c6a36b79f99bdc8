"""The magnetic field of the earth."""

from __future__ import annotations

import datetime
from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind, add_property, add_state
from morse.helpers.geodesy import LocalPlane
from morse.helpers.magnetism import DEFAULT_YEAR, MODELS, MagneticField
from morse.mathutils.rotations import turn_back

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body


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
