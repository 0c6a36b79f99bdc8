"""Kinds that modifiers change into other kinds: a pose in degrees of longitude becomes a fix."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from morse.core.declarations import DataField, KindUse


def uses_after_modifiers(uses: Iterable[KindUse], fields: Mapping[str, DataField]) -> Iterator[KindUse]:
    """Return the kinds after the modifiers have been applied.

    A pose whose position is longitude, latitude and altitude becomes a ``fix``, with an ``attitude`` on the sub-topic
    ``attitude`` if it has an orientation. A pose in geocentric coordinates has no specific kind.
    """
    for use in uses:
        frame = _frame_of_position(use, fields) if use.kind == "pose" else ""
        if frame == "wgs84":
            yield from _as_fix(use)
        elif frame != "geocentric":
            yield use


def _frame_of_position(use: KindUse, fields: Mapping[str, DataField]) -> str:
    position = use.slots["position"]
    first = position[0] if isinstance(position, (tuple, list)) else None
    field = fields.get(str(first))
    return "" if field is None else field.frame


def _as_fix(use: KindUse) -> Iterator[KindUse]:
    longitude, latitude, altitude = use.slots["position"]
    slots = {"latitude": latitude, "longitude": longitude, "altitude": altitude}
    yield use._replace(kind="fix", slots=slots)
    if "orientation" in use.slots:
        slots = {"orientation": use.slots["orientation"]}
        yield use._replace(kind="attitude", slots=slots, topic=f"{use.topic}/attitude".strip("/"))
