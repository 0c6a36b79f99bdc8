"""The table of message kinds.

A new optional slot does not change the version of a kind. A changed unit, frame, shape or meaning requires a new kind.
"""

from __future__ import annotations

import logging
from functools import lru_cache
from typing import TYPE_CHECKING, TypeGuard

from morse.core.classes.plugins import PluginError, entry_points, load
from morse.core.exceptions import MorseDeclarationError
from morse.core.kinds.kind import ORIENTATION, POINT, VECTOR, Kind, Slot
from morse.core.reports.quoting import nearest, shown
from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from collections.abc import Iterable
    from importlib.metadata import EntryPoint

    from morse.core.declarations.fields import KindUse


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
