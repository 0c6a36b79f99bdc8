"""The declarations of a class together with those of its bases."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from morse.core.declarations.fields import DataField, KindUse, Level, Property, StateVariable


def _merged(cls: type, attribute: str) -> dict[str, Any]:
    union: dict[str, object] = {}
    for base in reversed(cls.__mro__):
        union.update(vars(base).get(attribute, {}))
    return union


def data_fields(cls: type) -> dict[str, DataField]:
    """Return the data fields of a class and its bases, in the order of declaration, bases first."""
    return _merged(cls, "_data_fields")


def fields_of_component(component: object) -> dict[str, DataField]:
    """The data fields of a component: those of its class, and those that follow from its model."""
    return {**data_fields(type(component)), **getattr(component, "own_fields", {})}


def properties(cls: type) -> dict[str, Property]:
    """Return the properties of a class and its bases: Python name to declaration."""
    return _merged(cls, "_properties")


def state_variables(cls: type) -> dict[str, StateVariable]:
    """Return the declared state of a class and its bases: name of the attribute to declaration."""
    return _merged(cls, "_state_variables")


def levels(cls: type) -> dict[str, Level]:
    """Return the abstraction levels of a class and its bases."""
    return _merged(cls, "_levels")


def kinds(cls: type) -> tuple[KindUse, ...]:
    """Return the message kinds that a class declares, or those of its bases if it declares none."""
    for base in cls.__mro__:
        own = vars(base).get("_kinds")
        if own is not None:
            return tuple(own)
    return ()


def says_nothing(cls: type) -> bool:
    """Whether a class declares that it has no message kinds (``add_kind(None)``): no middleware carries its data."""
    own_kinds = (vars(base).get("_kinds") for base in cls.__mro__)
    return next((not own for own in own_kinds if own is not None), False)
