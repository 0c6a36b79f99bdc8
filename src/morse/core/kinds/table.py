"""The table of message kinds.

A new optional slot does not change the version of a kind. A changed unit, frame, shape or meaning requires a new kind.
"""

from __future__ import annotations

import logging
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple, TypeGuard

from morse.core.classes.plugins import PluginError, entry_points, load
from morse.core.declarations.fields import Shape  # noqa: TC001 - part of the annotations of a NamedTuple
from morse.core.exceptions import MorseDeclarationError
from morse.core.reports.quoting import nearest, shown
from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from importlib.metadata import EntryPoint

    from morse.core.declarations.fields import KindUse
    from morse.core.values import Value

#: how a slot changes when it is converted into another frame
POINT, VECTOR, ORIENTATION, FREE = "point", "vector", "orientation", ""


class Slot(NamedTuple):
    """A part of a message.

    Attributes:
        name: name of the slot.
        shape: shape of the value; ``()`` for a single value, None for an axis of any length.
        dtype: numpy dtype; or ``str`` or ``bool``.
        unit: see `morse.core.units`; empty for none.
        frame: frame of the value unless the field declares another frame; empty for none.
        optional: whether a message may be without this slot.
        moves: how the value changes with the frame: ``point``, ``vector``, ``orientation``, or empty for not at all.
        choices: the allowed strings; empty for any.
        covariance_of: the slots whose covariance this slot contains, in the order of its axes.
        shapes: other shapes that are accepted.
        dtypes: other dtypes that are accepted.
        doc: description of the slot.
    """

    name: str
    shape: Shape = ()
    dtype: str = "float64"
    unit: str = ""
    frame: str = ""
    optional: bool = False
    moves: str = FREE
    choices: tuple[str, ...] = ()
    covariance_of: tuple[str, ...] = ()
    shapes: tuple[Shape, ...] = ()
    dtypes: tuple[str, ...] = ()
    doc: str = ""


class Kind(NamedTuple):
    """A message kind.

    Attributes:
        name: name for components and middlewares.
        slots: slots by name, in order.
        published: whether sensors send it.
        commanded: whether actuators receive it.
        version: changes when a slot changes its unit, frame, shape or meaning.
        doc: one sentence.
    """

    name: str
    slots: dict[str, Slot]
    published: bool
    commanded: bool
    version: int
    doc: str


class Message:
    """The data of a component at one time.

    A message has two forms: `slots`, which have the names, units and frames of the kind, and `fields`, which are the
    data as the component declares them. A ``general`` message has the same names in both.

    Every slot of the kind can be read as an attribute: ``message.position``. Arrays are C-contiguous numpy arrays
    of the dtype of the slot, read-only; single values are Python objects. A slot that the component does not fill is
    None.

    Args:
        stamp: simulated time of the measurement, whole ns, or the function that computes it.
        slots: values by slot name, or the function that computes them when they are first read.
        fields: data of the component by name; default: the slots.

    Attributes:
        kind: see `morse.core.kinds.KINDS`.
        frame: frame of the first slot, see `morse.core.declarations.FRAMES`.
        topic: sub-topic of the topic of the component; empty for the topic itself.
    """

    __slots__ = ("_fields", "_slots", "_stamp", "frame", "kind", "topic")

    def __init__(
        self,
        kind: Kind,
        stamp: int | Callable[[], int],
        frame: str,
        slots: Mapping[str, object] | Callable[[], Mapping[str, object]],
        fields: Mapping[str, object] | None = None,
        topic: str = "",
    ) -> None:
        self.kind, self.frame, self.topic = kind, frame, topic
        self._stamp, self._slots, self._fields = stamp, slots, fields

    @property
    def stamp(self) -> int:
        """Simulated time of the measurement, whole ns, even if the data are delivered later."""
        stamp = self._stamp
        if callable(stamp):
            stamp = self._stamp = stamp()
        return stamp

    def complete(self) -> Message:
        """Compute everything now, so that the message can be read after its tick, in any thread."""
        _ = self.stamp, self.slots
        return self

    @property
    def slots(self) -> Mapping[str, Value]:
        """Values by slot name. They are computed when they are first read, which must be in the tick of the message."""
        slots = self._slots
        if callable(slots):
            slots = self._slots = slots()
        return slots

    @property
    def fields(self) -> Mapping[str, Value]:
        """The data of the component by field name, in the order of their declaration.

        They are those of the component itself: do not change them, and copy those that are needed after the tick.
        """
        return self.slots if self._fields is None else self._fields

    def __getattr__(self, name: str) -> Value:
        try:
            return self.slots[name]
        except KeyError:
            if name in self.kind.slots:
                return None
            raise AttributeError(f"a message of kind '{self.kind.name}' has no slot '{name}'") from None

    def __repr__(self) -> str:
        inside = ", ".join(f"{name}={value!r}" for name, value in self.slots.items())
        return f"{self.kind.name}(stamp={self.stamp}, frame={self.frame!r}, {inside})"


GENERAL = "general"


def _kind(name: str, direction: str, doc: str, *slots: Slot, version: int = 1) -> Kind:
    return Kind(name, {slot.name: slot for slot in slots}, "s" in direction, "c" in direction, version, doc)


def _number(name: str, unit: str = "", doc: str = "", *, optional: bool = False, dtype: str = "float64") -> Slot:
    return Slot(name, (), dtype, unit, optional=optional, doc=doc)


def _maybe(name: str, unit: str = "", doc: str = "") -> Slot:
    return _number(name, unit, doc, optional=True)


def _word(name: str, doc: str, *choices: str, optional: bool = False) -> Slot:
    return Slot(name, (), "str", choices=choices, optional=optional, doc=doc)


def _three(name: str, unit: str, frame: str, doc: str = "", *, moves: str = VECTOR, optional: bool = False) -> Slot:
    return Slot(name, (3,), "float64", unit, frame, optional, moves, doc=doc)


def _quaternion(frame: str, *, optional: bool = True) -> Slot:
    return Slot("orientation", (4,), "float64", "", frame, optional, ORIENTATION, doc="unit quaternion w, x, y, z")


def _covariance(size: int, *of: str, name: str = "covariance") -> Slot:
    return Slot(name, (size, size), optional=True, covariance_of=of, doc=f"of {' and '.join(of)}, row-major")


def _variance(unit: str, of: str) -> Slot:
    return Slot("variance", (), unit=unit, optional=True, covariance_of=(of,), doc=f"of {of}")


_POSITION = _three("position", "m", "world", moves=POINT)
_LINEAR, _ANGULAR = _three("linear", "m/s", "own"), _three("angular", "rad/s", "own")

_ALL = (
    _kind("pose", "sc", "Position and orientation.",
          _POSITION, _quaternion("world"), _maybe("tolerance", "m"), _maybe("speed", "m/s"),
          _covariance(6, "position", "orientation")),
    _kind("twist", "sc", "Linear and angular velocity.", _LINEAR, _ANGULAR, _covariance(6, "linear", "angular")),
    _kind("accel", "s", "Acceleration of the coordinates, without gravity.",
          _three("linear", "m/s^2", "own"), _three("angular", "rad/s^2", "own", optional=True),
          _covariance(6, "linear", "angular")),
    _kind("attitude", "sc", "Orientation and angular velocity.",
          _quaternion("world"), _three("rates", "rad/s", "own", optional=True),
          _maybe("thrust", "", "share of the largest thrust, 0..1"),
          _covariance(3, "orientation", name="orientation_covariance"),
          _covariance(3, "rates", name="rates_covariance")),
    _kind("odometry", "s", "Pose since the start, and velocity.",
          _three("position", "m", "start", moves=POINT), _quaternion("start", optional=False), _LINEAR, _ANGULAR,
          _covariance(6, "position", "orientation", name="pose_covariance"),
          _covariance(6, "linear", "angular", name="twist_covariance")),
    _kind("wrench", "sc", "Force and torque.", _three("force", "N", "own"), _three("torque", "N·m", "own")),
    _kind("imu", "s", "Angular velocity and specific force (+9.81 upward at rest).",
          _three("angular_velocity", "rad/s", "own"), _three("linear_acceleration", "m/s^2", "own"),
          _quaternion("world"),
          _covariance(3, "angular_velocity", name="angular_velocity_covariance"),
          _covariance(3, "linear_acceleration", name="linear_acceleration_covariance"),
          _covariance(3, "orientation", name="orientation_covariance")),
    _kind("magnetic_field", "s", "The magnetic field.", _three("field", "T", "own"), _covariance(3, "field")),
    _kind("fix", "sc", "A position on the earth.",
          Slot("latitude", unit="deg", frame="wgs84"), Slot("longitude", unit="deg", frame="wgs84"),
          Slot("altitude", unit="m", frame="wgs84", doc="above the ellipsoid"),
          _three("velocity", "m/s", "enu", optional=True),
          _maybe("course", "deg", "over ground, from north, clockwise; infinite if unknown"),
          Slot("utc", (), "str", optional=True, doc="ISO 8601"),
          Slot("covariance", (3, 3), unit="m^2", frame="enu", optional=True)),
    _kind("pressure", "s", "Pressure of air or water.",
          _maybe("absolute", "Pa"), _maybe("differential", "Pa"),
          _variance("Pa^2", "absolute")),
    _kind("temperature", "s", "A temperature.", _number("temperature", "°C"), _variance("K^2", "temperature")),
    _kind("battery", "s", "Charge of a battery.",
          _number("charge", "1", "0..1"), _word("status", "", "unknown", "charging", "discharging", "full"),
          _maybe("voltage", "V"), _maybe("current", "A", "negative while it discharges"), _maybe("temperature", "°C")),
    _kind("range", "s", "Distance of the nearest object in a cone about the X axis.",
          _number("distance", "m", "+inf: too far, -inf: too near, NaN: invalid", dtype="float32"),
          _number("min", "m"), _number("max", "m"), _number("fov", "rad", "full angle of the cone"),
          _word("radiation", "kind of radiation", "infrared", "ultrasound", "radar"), _variance("m^2", "distance")),
    _kind("scan", "s", "Distances in one plane, counter-clockwise about the Z axis.",
          Slot("ranges", (None,), "float32", "m", doc="+inf: too far, -inf: too near, NaN: invalid"),
          Slot("intensities", (None,), "float32", optional=True),
          _number("angle_min", "rad"), _number("angle_increment", "rad"),
          _number("range_min", "m"), _number("range_max", "m")),
    _kind("cloud", "s", "Points.",
          Slot("points", (None, 3), "float32", "m", "own", moves=POINT, shapes=((None, None, 3),)),
          Slot("intensity", (None,), "float32", optional=True, shapes=((None, None),)),
          Slot("color", (None, 3), "uint8", optional=True, shapes=((None, None, 3),)),
          Slot("ring", (None,), "uint16", optional=True, shapes=((None, None),)),
          Slot("id", (None,), "uint32", optional=True, shapes=((None, None),))),
    _kind("image", "sc", "An image, the top row first.",
          Slot("pixels", (None, None), "uint8", frame="optical", shapes=((None, None, None),),
               dtypes=("uint16", "float32", "float64")),
          _word("encoding", "as ROS names it"), _word("unit", "unit of the values of pixels", optional=True),
          _maybe("high", "", "the largest value")),
    _kind("camera_info", "s", "Projection of a camera.",
          _number("width", "px", dtype="int32"), _number("height", "px", dtype="int32"),
          Slot("k", (3, 3), unit="px", frame="optical", doc="intrinsic matrix"),
          Slot("d", (None,), doc="distortion"), _word("model", "of the distortion"),
          Slot("r", (3, 3), optional=True), Slot("p", (3, 4), unit="px", optional=True)),
    _kind("detections", "s", "Recognized objects: a list of records.",
          Slot("records", (None,), "object", frame="optical",
               doc="dictionaries with id, label, and perhaps score, position, orientation, size, box")),
    _kind("contact", "s", "Whether there is a contact.",
          Slot("touching", (), "bool"), Slot("names", (None,), "str", optional=True, doc="names of the touched "
                "objects"),
          Slot("points", (None, 3), unit="m", frame="world", optional=True, moves=POINT),
          Slot("normals", (None, 3), frame="world", optional=True, moves=VECTOR),
          Slot("forces", (None, 3), unit="N", frame="world", optional=True, moves=VECTOR)),
    _kind("joints", "sc", "Positions, speeds and forces of joints.",
          Slot("names", (None,), "str"),
          Slot("position", (None,), optional=True, doc="rad or m"),
          Slot("velocity", (None,), optional=True, doc="rad/s or m/s"),
          Slot("effort", (None,), optional=True, doc="N·m or N")),
    _kind("actuators", "sc", "One value for each of several motors.",
          Slot("values", (None,), doc="in the unit of the field"), Slot("names", (None,), "str", optional=True)),
    _kind("switch", "sc", "On or off, or one of several states.",
          Slot("on", (), "bool", optional=True), Slot("choice", (), "str", optional=True)),
    _kind("clock", "s", "Simulated time.", _number("now", "s")),
    _kind(GENERAL, "sc", "All fields as they are declared, for components without a kind."),
)  # fmt: skip

KINDS: dict[str, Kind] = {kind.name: kind for kind in _ALL}

#: kinds of cameras, which have no message while the camera does not capture
PICTURES = ("image", "cloud", "camera_info")
#: kinds whose messages need at least one of the optional slots
NEEDS_ONE = ("attitude", "pressure", "joints", "switch")


logger = logging.getLogger(__name__)


def kind_named(name: str) -> Kind | None:
    """Return the kind of that name, from MORSE or from an installed package; None if there is none."""
    return KINDS.get(name) or kinds_of_packages().get(name)


def kinds_of_packages() -> dict[str, Kind]:
    """Return the kinds of all installed packages by name."""
    kinds: dict[str, Kind] = {}
    for point in entry_points("morse.kinds"):
        for kind in _loaded(point):
            if kind.name in KINDS or kind.name in kinds:
                logger.warning(
                    "the message kind '%s' of %s already exists, and is left out",
                    kind.name,
                    point.value,
                    extra=OF_MACHINE,
                )
            else:
                kinds[kind.name] = kind
    return kinds


@lru_cache(maxsize=64)
def _loaded(point: EntryPoint) -> tuple[Kind, ...]:
    try:
        kinds = load(point, _as_kinds)
    except PluginError as error:  # a broken package must not prevent loading the others
        logger.warning("the message kinds of %s cannot be loaded: %s", point.value, error, extra=OF_MACHINE)
        return ()
    good = tuple(kind for kind in kinds if _is_kind(kind))
    if len(good) < len(kinds):
        logger.warning(
            "%s provides an object that is not a message kind (morse.core.kinds.Kind)", point.value, extra=OF_MACHINE
        )
    return good


def _as_kinds(entry: object) -> tuple[object, ...]:
    # a kind is itself a tuple
    return tuple(entry) if isinstance(entry, (list, tuple)) and not isinstance(entry, Kind) else (entry,)


def _is_kind(kind: object) -> TypeGuard[Kind]:
    return (
        isinstance(kind, Kind)
        and isinstance(kind.name, str)
        and isinstance(kind.slots, dict)
        and all(isinstance(slot, Slot) and slot.name == name for name, slot in kind.slots.items())
    )


def check_use(use: KindUse) -> None:
    """Raise an error for an unknown kind, an unknown slot, or a missing slot.

    Raises:
        MorseDeclarationError: the message contains the location in the source and the nearest name.
    """
    kind = kind_named(use.kind)
    if kind is None:
        raise MorseDeclarationError(
            f"{use.where}: there is no message kind {shown(use.kind)}{nearest(use.kind, KINDS, limit=30)}"
        )
    for name in use.slots:
        if name not in kind.slots:
            raise MorseDeclarationError(
                f"{use.where}: kind '{kind.name}' has no slot '{name}'{nearest(name, kind.slots)}"
            )
    absent = [name for name, slot in kind.slots.items() if not slot.optional and name not in use.slots]
    if absent:
        raise MorseDeclarationError(f"{use.where}: kind '{kind.name}' needs the slot {_quoted(absent)}")
    if kind.name in NEEDS_ONE and not use.slots:
        raise MorseDeclarationError(f"{use.where}: kind '{kind.name}' needs one of the slots {_quoted(kind.slots)}")


def _quoted(names: Iterable[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)
