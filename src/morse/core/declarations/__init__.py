"""Declarations of a component class: data fields, properties, levels and message kinds.

The functions are called in the body of a component class and write into its namespace::

    class Thermostat(Sensor):
        _name = "Thermostat"
        _short_desc = "Measures the temperature of a room"

        add_data("temperature", 0.0, "float", "Temperature of the air", unit="°C", low=-273.15)
        add_property("_offset", 0.0, "Offset", "float", "Added to every reading", unit="K")
        add_state("_drift", float, "Error that grows while the thermostat runs", unit="K")
        add_level("raw", None, doc="the reading of the probe", default=True)
        add_kind("temperature", temperature="temperature")

Builder classes, documentation, default streams, the messages of all middlewares, the validation of input and the panels
of the live view are derived from them. An invalid declaration raises an error when the class is created.

A class whose formulas come from a standard, a data sheet or a book names it in ``_source``, for its page in the
component library.
"""

from morse.core.classes.builder_defaults import BuilderDefaults, RobotDefaults, Visual
from morse.core.declarations.fields import (
    Computed,
    DataField,
    Each,
    Euler,
    KindUse,
    Level,
    Mapped,
    Prop,
    Property,
    Scaled,
    StateVariable,
    computed,
    data_fields,
    each,
    euler,
    fields_of_component,
    kinds,
    levels,
    mapped,
    prop,
    properties,
    says_nothing,
    scaled,
    state_variables,
)
from morse.core.declarations.functions import Option, add_data, add_kind, add_level, add_property, add_state
from morse.core.declarations.refused import FRAMES

__all__ = [
    "FRAMES",
    "BuilderDefaults",
    "Computed",
    "DataField",
    "Each",
    "Euler",
    "KindUse",
    "Level",
    "Mapped",
    "Option",
    "Prop",
    "Property",
    "RobotDefaults",
    "Scaled",
    "StateVariable",
    "Visual",
    "add_data",
    "add_kind",
    "add_level",
    "add_property",
    "add_state",
    "computed",
    "data_fields",
    "each",
    "euler",
    "fields_of_component",
    "kinds",
    "levels",
    "mapped",
    "prop",
    "properties",
    "says_nothing",
    "scaled",
    "state_variables",
]
