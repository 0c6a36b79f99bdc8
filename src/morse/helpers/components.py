"""The functions for declarations in component classes, under the import path of MORSE 1.4."""

from morse.core.declarations import (
    add_data,
    add_kind,
    add_level,
    add_property,
    add_state,
    computed,
    each,
    euler,
    mapped,
    prop,
    scaled,
)
from morse.core.rows.marks import on_read, while_same

__all__ = [
    "add_data",
    "add_kind",
    "add_level",
    "add_property",
    "add_state",
    "computed",
    "each",
    "euler",
    "mapped",
    "on_read",
    "prop",
    "scaled",
    "while_same",
]
