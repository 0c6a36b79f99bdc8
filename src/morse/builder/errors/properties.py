"""Validation of properties in scripts against the declarations of the component."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from morse.builder.errors import checks
from morse.builder.legacy import declared_values
from morse.core import declarations
from morse.core.validation import checked_value

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from morse.core.values import Properties


logger = logging.getLogger(__name__)

#: these properties are read by MORSE itself, independent of the declarations of the component
_GENERAL = frozenset({"classpath", "frequency", "abstraction_level", "Component_Tag", "Robot_Tag"})


#: likeness of a misspelled name, where other names are allowed
_ALIKE = 0.8


def warn_if_misspelled(owner: str, names: Iterable[str], known: Iterable[str]) -> None:
    """Warn about properties that are nearly those that the owner has; others are the user's own."""
    words = list(known)
    for name in names:
        near = checks.closest(name, words, _ALIKE) if name not in words else None
        if near is not None:
            logger.warning("%s has no property '%s'; did you mean '%s'? (it is kept)", owner, name, near)


def check_declared(cls: type, values: Mapping[str, object]) -> Properties:
    """Return properties as they are to be stored, with a warning for those that a component does not declare.

    Raises:
        PropertyError: a value has the wrong type, or is outside of the declared range or choices.
    """
    properties = {p.name: p for p in declarations.properties(cls).values()}
    values = declared_values.properties(cls.__name__, properties, values)
    for name, value in values.items():
        if name in properties:
            checked_value(cls.__name__, properties[name], value, script=True)
        elif name not in _GENERAL:
            logger.warning(
                "%s has no property '%s'%s (it is kept, but %s does not use it)",
                cls.__name__,
                name,
                checks.suggestion(name, properties),
                cls.__name__,
            )
    return values
