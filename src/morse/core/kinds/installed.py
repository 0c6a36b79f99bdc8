"""Message kinds of installed packages.

A package names a kind, or a list of kinds, by an entry point::

    [project.entry-points."morse.kinds"]
    my_lab = "my_lab.kinds:SONAR"
"""

from __future__ import annotations

import logging
from functools import lru_cache
from typing import TYPE_CHECKING

from morse.core.classes.plugins import entry_points
from morse.core.kinds.kind import Kind, Slot
from morse.core.kinds.table import KINDS
from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

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
        entry = point.load()
    except Exception as error:  # a broken package must not prevent loading the others
        logger.warning(
            "the message kinds of %s cannot be loaded: %s: %s",
            point.value,
            type(error).__name__,
            error,
            extra=OF_MACHINE,
        )
        return ()
    kinds = (entry,) if isinstance(entry, Kind) else tuple(entry) if isinstance(entry, (list, tuple)) else (entry,)
    good = tuple(kind for kind in kinds if _is_kind(kind))
    if len(good) < len(kinds):
        logger.warning(
            "%s provides an object that is not a message kind (morse.core.kinds.Kind)", point.value, extra=OF_MACHINE
        )
    return good


def _is_kind(kind: object) -> bool:
    return (
        isinstance(kind, Kind)
        and isinstance(kind.name, str)
        and isinstance(kind.slots, dict)
        and all(isinstance(slot, Slot) and slot.name == name for name, slot in kind.slots.items())
    )
