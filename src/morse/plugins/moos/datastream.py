"""Sends and receives data streams as variables of a MOOS database."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.core.datastream import DatastreamManager
from morse.core.exceptions import MorseMiddlewareError
from morse.core.mapping import maps
from morse.core.reports.quoting import shown
from morse.core.streams.kind_stream import KindStream
from morse.plugins.moos import MANAGER_OPTIONS, STREAM_OPTIONS
from morse.plugins.moos.database import Database
from morse.wire.encoding import from_json, written

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Mapping

    from morse.core.context import Context
    from morse.core.kinds import Message
    from morse.core.object import Object
    from morse.core.sensor import Sensor
    from morse.core.values import Fields, Options

    Value = float | str
    Variables = Iterator[tuple[str, Value]]


_AXES = "xyz"
#: variable, after the prefix, of each field of a component class; messages of these variables are numbers
_OF_SENSORS = {
    "GPS": {"x": "GPS_E_X", "y": "GPS_N_Y", "z": "GPS_ALT_Z"},
    "Gyroscope": {name: f"GYRO_{name.upper()}" for name in ("yaw", "roll", "pitch")},
    "Pose": {"timestamp": "TIME"} | {name: f"SIM_{name.upper()}" for name in (*_AXES, "yaw", "roll", "pitch")},
}
_MOTION = {"v": "VELOCITY", "w": "YAWRATE", "steer": "STEER", "force": "THROTTLE", "brake": "BRAKE"}
_OF_ACTUATORS = {
    "Light": {"LIGHT": "emit"},
    "Teleport": {f"SET_{name.upper()}": name for name in (*_AXES, "roll", "pitch", "yaw")},
    **{
        name: {f"MOTION_{word}": field for field, word in _MOTION.items()}
        for name in ("SteerForce", "MotionVW", "MotionVWDiff")
    },
}


def form_of(component: Object) -> Callable[[Any], Variables]:
    """Return the function that gives the variables of a sensor, without their prefix."""
    for cls in type(component).__mro__:
        if cls.__name__ in _OF_SENSORS and _OF_SENSORS[cls.__name__].keys() <= component.local_data.keys():
            table = _OF_SENSORS[cls.__name__]
            return lambda sensor: ((name, float(sensor.local_data[field])) for field, name in table.items())
        if cls.__name__ == "IMU":
            return _imu
        if cls.__name__ == "LaserScanner":
            return _scan
    return _general


def commands_of(component: Object) -> dict[str, str]:
    """Return the fields of an actuator by the names of their variables, without the prefix."""
    fields = component.local_data
    for cls in type(component).__mro__:
        if cls.__name__ in _OF_ACTUATORS:
            return {name: field for name, field in _OF_ACTUATORS[cls.__name__].items() if field in fields}
    return {_general_name(component, field): field for field in fields if field != "timestamp"}


def _general_name(component: Object, field: str) -> str:
    return f"{component.name()}_{field}".replace(".", "_").upper()


def _general(sensor: Sensor) -> Variables:
    """All fields as strings."""
    for field, value in sensor.local_data.items():
        yield _general_name(sensor, field), value if isinstance(value, str) else written(value)


def _imu(sensor: Sensor) -> Variables:
    for field, word in (("angular_velocity", "GYRO"), ("linear_acceleration", "ACCEL")):
        for axis, value in zip(_AXES, sensor.local_data[field], strict=True):
            yield f"IMU_{word}_{axis.upper()}", float(value)


def _scan(scanner: Any) -> Variables:
    ranges = [float(distance) for distance in scanner.local_data["range_list"]]
    yield "LIDAR_DIST", f"[1x{len(ranges)}]{{{','.join(map(repr, ranges))}}}"


def constants_of(component: Any) -> Variables:
    """The variables of a sensor that are published once."""
    if any(cls.__name__ == "LaserScanner" for cls in type(component).__mro__):
        yield "LIDAR_SCANANGLE", float(component.scan_window)
        yield "LIDAR_SCANRESOLUTION", float(component.resolution)
        yield "LIDAR_SCANRANGE", float(component.laser_range)


#: words for a boolean field
_WORDS = {"true": True, "on": True, "1": True, "false": False, "off": False, "0": False}
#: maximum size of a command, characters
_LONGEST = 1 << 16


class MoosStream(KindStream):
    """A stream with variables.

    Attributes:
        database: the connection.
    """

    options = STREAM_OPTIONS
    manager: MOOSDatastreamManager

    def initialize(self) -> None:
        """Check the prefix, and find the database.

        Raises:
            MorseMiddlewareError: it is not part of a name of MOOS.
        """
        super().initialize()
        self.prefix = self.kwargs["prefix"]
        if not self.prefix.isprintable() or any(letter in self.prefix for letter in " ,=*?") or not self.prefix:
            raise MorseMiddlewareError(
                f"{self.component_name}: the prefix is {shown(self.prefix)}, expected a part of a name, such as 'MORSE'"
            )
        self.database: Database = self.manager.database_of(self.kwargs)


class MoosPublisher(MoosStream):
    """Publishes the data of a sensor at each of its measurements."""

    def initialize(self) -> None:
        """Determine the variables."""
        super().initialize()
        self._form = form_of(self.component_instance)
        self._connection = 0
        self._is_claimed = False

    def variables(self, connection: int) -> Iterator[tuple[str, float | str]]:
        """The variables of a measurement; with the constants in the first one of each connection.

        Args:
            connection: number of the connection.
        """
        constants = constants_of(self.component_instance) if connection != self._connection else ()
        self._connection = connection
        for name, value in constants:
            yield f"{self.prefix}_{name}", value
        for name, value in self._form(self.component_instance):
            variable = f"{self.prefix}_{name}"
            if not self._is_claimed:
                self._is_claimed = True
                self.manager.claim(self.database, variable, self.component_name)
            yield variable, value


class MoosReader(MoosStream):
    """Writes variables into the data of an actuator; of several values of a variable, the last one."""

    what = "command"

    def initialize(self) -> None:
        """Register the variables."""
        super().initialize()
        #: the last value of each field that has arrived
        self._values: Fields = {}
        self.fields = {f"{self.prefix}_{name}": field for name, field in commands_of(self.component_instance).items()}
        for variable in self.fields:
            self.manager.listen(self.database, variable, self.take)

    def finalize(self) -> None:
        """End the registrations."""
        for variable in self.fields:
            self.manager.ignore(self.database, variable, self.take)

    @property
    def waiting(self) -> Collection[object]:
        """Fields that have arrived."""
        return self._values

    def take(self, variable: str, value: float | str) -> None:
        """Keep the value of a variable that has arrived."""
        field = self.fields[variable]
        try:
            self._values[field] = self._read_value(field, value)
        except ValueError as error:
            self.complain(variable, f"{variable} is refused: {error}: {shown(value)}")

    def _read_value(self, field: str, value: object) -> object:
        present = self.data.get(field)
        if isinstance(value, bytes) or (isinstance(value, str) and len(value) > _LONGEST):
            raise ValueError("expected a number or a short string")
        if isinstance(present, bool):
            word = str(value).strip().lower() if isinstance(value, str) else str(int(value != 0.0))
            if word not in _WORDS:
                raise ValueError(f"expected one of {', '.join(_WORDS)}")
            return _WORDS[word]
        if isinstance(present, str) or not isinstance(value, str):
            return value
        return from_json(value.encode("utf-8", "replace"))

    def arrived(self) -> Iterable[Fields]:
        """The fields that have arrived, one by one: a wrong variable does not invalidate the others."""
        if not self._values or self.rests:
            return ()
        fields, self._values = self._values, {}
        return [{field: value} for field, value in fields.items()]


logger = logging.getLogger(__name__)


#: options that tell databases apart
_PLACE = ("moos_host", "moos_port", "moos_name")


class MOOSDatastreamManager(DatastreamManager):
    """Variables of sensors are published, and variables of actuators are registered.

    Streams with the same ``moos_host``, ``moos_port`` and ``moos_name`` share a connection. A stream that does not set
    them uses the options of the manager.
    """

    classpath = "morse.middleware.moos_datastream.MOOSDatastreamManager"
    manager_options = MANAGER_OPTIONS
    by_component = True

    def __init__(self, options: Options, context: Context) -> None:
        super().__init__(options, context)
        self._databases: dict[tuple[object, ...], Database] = {}
        self._takers: dict[tuple[Database, str], list[Callable[[str, float | str], object]]] = {}
        self._owners: dict[tuple[Database, str], str] = {}

    def database_of(self, options: Mapping[str, object]) -> Database:
        """The connection of a stream with these options."""
        own_options = {name: options[name] for name in _PLACE if options[name] is not None}
        all_options = {**self.options, **own_options}
        place = tuple(all_options[name] for name in _PLACE)
        if place not in self._databases:
            database = self._databases[place] = Database(all_options)
            logger.info("moos: the database is expected at %s", database.place)
        return self._databases[place]

    def wanted(self, stream: MoosStream, topic: str) -> bool:
        """Whether the database is connected."""
        return stream.database.connected

    @maps("general")
    def general(self, stream: MoosPublisher, message: Message) -> None:
        """The variables of a sensor."""
        for name, value in stream.variables(stream.database.connections):
            stream.database.publish(name, value)

    def claim(self, database: Database, variable: str, name: str) -> None:
        """Log if two components publish the same variable: 1.4 has no names of robots in some variables."""
        owner = self._owners.setdefault((database, variable), name)
        if owner != name:
            logger.warning(
                "moos: %s and %s publish the same variable %s; set prefix='...' for one of them", owner, name, variable
            )

    def listen(self, database: Database, variable: str, take: Callable[[str, float | str], object]) -> None:
        """Call ``take`` before each tick with the variables that have arrived."""
        takers = self._takers.setdefault((database, variable), [])
        takers.append(take)
        if len(takers) == 1:
            database.register(variable)

    def ignore(self, database: Database, variable: str, take: Callable[[str, float | str], object]) -> None:
        """End `listen`."""
        takers = self._takers.get((database, variable), [])
        if take in takers:
            takers.remove(take)
        if not takers and self._takers.pop((database, variable), None) is not None:
            database.unregister(variable)

    def closed(self, stream: Any) -> None:
        """Release the variables of a component."""
        self._owners = {key: owner for key, owner in self._owners.items() if owner != stream.component_name}

    def action(self) -> None:
        """Pass on the variables that have arrived."""
        for database in self._databases.values():
            for variable, value in database.received():
                for take in self._takers.get((database, variable), ()):
                    take(variable, value)

    def drain(self) -> None:
        """See `DatastreamManager.drain`."""
        self.action()

    def finalize(self) -> None:
        """Disconnect."""
        super().finalize()
        for database in self._databases.values():
            database.close()
