"""Assign the values and the order of a saved state to the attributes of an object."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping


def replace(attributes: dict[str, Any], present: Iterable[str], state: Mapping[str, Any]) -> None:
    """Replace the attributes of an object with those of a state.

    Args:
        attributes: ``vars`` of the object.
        present: names of the attributes that belong to the present state; those that are not in ``state`` are deleted.
        state: name to value.
    """
    for name in [name for name in present if name not in state]:
        attributes.pop(name, None)
    attributes.update(state)
    reorder(attributes, state)


def reorder(attributes: dict[str, Any], order: Iterable[str]) -> None:
    """Reorder attributes as in a saved state, because the order is part of bitwise comparisons of states.

    Names that are not in the order come first.
    """
    wanted = [name for name in order if name in attributes]
    known = set(wanted)
    if [name for name in attributes if name in known] != wanted:
        for name in wanted:
            attributes[name] = attributes.pop(name)
