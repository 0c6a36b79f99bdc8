"""Properties that a script sets, against those that the component declares."""

from __future__ import annotations

import logging
from numbers import Real
from typing import TYPE_CHECKING, Any

from morse.builder import checks, naming
from morse.core import declarations

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.builder.abstractcomponent import AbstractComponent

logger = logging.getLogger("morse." + __name__)

#: read by MORSE itself, whatever the component declares
_GENERAL = frozenset({"classpath", "frequency", "abstraction_level", "Component_Tag", "Robot_Tag"})


def check_declared(component: AbstractComponent, given: Mapping[str, Any]) -> None:
    """Warn about properties that a component does not declare; refuse words where it wants numbers.

    Raises:
        TypeError: no number for a property whose default is one.
    """
    cls = component.component_class()
    if cls is None:
        return
    declared = {p.name: p for p in declarations.properties(cls).values()}
    for name, value in given.items():
        if name in declared:
            default = declared[name].default
            if isinstance(default, Real) and not isinstance(value, Real):
                kind = declared[name].type or type(default).__name__
                raise TypeError(
                    f"property '{name}' of {cls.__name__} takes a {kind} such as {default!r}, got {checks.shown(value)}"
                )
        elif name not in _GENERAL:
            logger.warning(
                "%s: %s has no property '%s'%s (kept, but %s does not read it)",
                naming.source_line() or "?",
                cls.__name__,
                name,
                checks.suggestion(name, declared),
                cls.__name__,
            )
