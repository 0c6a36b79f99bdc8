"""The attributes of an object take the values and the order of a saved state."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping


def replace(attributes: dict[str, Any], present: Iterable[str], state: Mapping[str, Any]) -> None:
    """Put a state in the place of the attributes that are present.

    Args:
        attributes: what ``vars`` of the object gives.
        present: the names that belong to the state at present; names that are not in the state are deleted.
        state: name to value.
    """
    for name in [name for name in present if name not in state]:
        attributes.pop(name, None)
    attributes.update(state)
    reorder(attributes, state)


def reorder(attributes: dict[str, Any], order: Iterable[str]) -> None:
    """Let attributes follow each other as in a saved state: the order is a part of what is compared to the bit.

    Names that are not in the order come first.
    """
    wanted = [name for name in order if name in attributes]
    known = set(wanted)
    if [name for name in attributes if name in known] != wanted:
        for name in wanted:
            attributes[name] = attributes.pop(name)
