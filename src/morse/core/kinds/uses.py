"""Validation of the message kinds that a component class declares."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.exceptions import MorseDeclarationError
from morse.core.kinds.installed import kind_named
from morse.core.kinds.table import KINDS, NEEDS_ONE
from morse.core.reports.hints import nearest
from morse.core.reports.quoting import shown

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.core.declarations.fields import KindUse


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
