"""Rules for the declarations of a class, checked without a simulation."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING

from morse.core.declarations import data_fields, levels, properties
from morse.core.declarations.refused import numbers_in, shape_of
from morse.core.services import declared_services
from morse.core.units import unit
from morse.verification.contract.report import Fault

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.core.declarations import DataField
    from morse.verification.contract.places import Places

DOCUMENTED, DECLARED = "documented", "data are declared"

#: base units of quantities with a direction, which need a frame
_DIRECTED = {"m", "rad", "A"}
#: names of numbers that are parts of a vector
_AXES = ("x", "y", "z", "roll", "pitch", "yaw", "vx", "vy", "vz", "wx", "wy", "wz")
#: words for numbers that are counted, not measured
_COUNTED = ("int", "integer", "uint8", "buffer")


def documented(cls: type, places: Places) -> Iterator[Fault]:
    """The class, its data, properties, levels and services have descriptions."""
    where = places.of_class(cls)
    if not (inspect.cleandoc(cls.__doc__ or "") or vars(cls).get("_short_desc")):
        yield Fault(DOCUMENTED, "the class has neither a docstring nor _short_desc: say in one what it does", where)
    for name, field in data_fields(cls).items():
        if not field.doc.strip():
            yield Fault(DOCUMENTED, f"the data field '{name}' has no description", places.of(cls, "add_data", name))
    for python_name, prop in properties(cls).items():
        if not prop.doc.strip():
            place = places.of(cls, "add_property", python_name)
            yield Fault(DOCUMENTED, f"the property '{prop.name}' has no description", place)
    for name, level in levels(cls).items():
        if not level.doc.strip():
            yield Fault(DOCUMENTED, f"the level '{name}' has no description", places.of(cls, "add_level", name))
    for declaration in declared_services(cls):
        if not inspect.getdoc(getattr(cls, declaration.attribute)):
            place = places.of(cls, "def", declaration.attribute)
            yield Fault(DOCUMENTED, f"the service '{declaration.name}' has no docstring", place)


def declared(cls: type, places: Places) -> Iterator[Fault]:
    """Numbers have a unit, directions a frame, lists of numbers a shape."""
    for name, field in data_fields(cls).items():
        for text in _missing(name, field):
            yield Fault(DECLARED, text, places.of(cls, "add_data", name))


def _missing(name: str, field: DataField) -> Iterator[str]:
    if not _is_measured(field):
        return
    is_sequence = hasattr(field.default, "__len__") and not isinstance(field.default, str)
    if is_sequence and field.shape is None:
        shape = shape_of(field.default) or (None,)
        yield f"the data field '{name}' is a list of numbers without a shape: add shape={shape} (None for any length)"
    if not field.unit and (field.low is None or field.high is None):
        yield (
            f"the data field '{name}' has no unit: add unit='m', unit='rad', ...; of a number without a unit, say its "
            "range by low= and high="
        )
    is_directed = (
        name in _AXES or field.quaternion or (is_sequence and field.shape is not None and field.shape[-1] == 3)
    )
    if field.unit and is_directed and not field.frame and _DIRECTED & {base for base, _ in unit(field.unit).dimension}:
        yield f"the data field '{name}' has a direction and no frame: add frame='own', frame='world', ..."


def _is_measured(field: DataField) -> bool:
    """Whether it contains quantities: neither words, nor flags, nor counts."""
    default: object = field.default
    if isinstance(default, (bool, dict)) or field.type in _COUNTED or field.dtype in ("uint8", "bool"):
        return False
    if isinstance(default, str):
        # a default may be a word that describes the initial number
        return field.type in ("float", "double")
    if isinstance(default, int) or "int" in field.type or "string" in field.type or "objects" in field.type:
        return False
    return field.shape is not None or next(numbers_in(default), None) is not None
