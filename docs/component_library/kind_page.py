"""A page on the message kinds, from their table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from component_library import component_pages
from component_library.markdown import code, page, section, table
from morse.core.classes.plugins import entry_points
from morse.core.declarations import FRAMES, kinds
from morse.core.kinds import KINDS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.core.kinds import Kind, Slot

_INTRODUCTION = """A component declares its message kinds, and which of its data fields is which slot. A middleware maps
kinds, never single components: every middleware supports your own components, too. How to declare kinds:
[architecture](../architecture.md#declarations-of-data).

Every message has a `stamp` (simulated time of the measurement, whole nanoseconds) and a `frame` (that of its first
slot). Slots in *italics* are optional. A component without a kind has the kind `general`: all its fields, unchanged."""


def pages() -> dict[str, str]:
    """Name of a page, below the folder of the library, to its text."""
    frames = table(["frame", "what"], ([code(name), what] for name, what in FRAMES.items()))
    return {"message-kinds": page("Message kinds", _INTRODUCTION, *map(_section, known()), section("Frames", frames))}


def known() -> list[Kind]:
    """The kinds of MORSE and of its plug-ins."""
    points = [point for point in entry_points("morse.kinds") if point.value.startswith("morse.")]
    return [*KINDS.values(), *(kind for point in points for kind in point.load())]


def _section(kind: Kind) -> str:
    ways = [way for way, possible in (("sensors", kind.published), ("actuators", kind.commanded)) if possible]
    facts = f"{kind.doc} Version {kind.version}; for {' and '.join(ways)}.\n"
    speakers = ", ".join(dict.fromkeys(_speakers(kind.name)))
    return section(
        kind.name,
        facts,
        table(["slot", "shape", "type", "unit", "frame", "what"], map(_row, kind.slots.values())),
        f"Used by {speakers}.\n" if speakers else "",
    )


def _row(slot: Slot) -> list[str]:
    shape = "×".join("N" if size is None else str(size) for size in slot.shape)
    what = ", ".join(code(word) for word in slot.choices) if slot.choices else slot.doc
    name = f"*{slot.name}*" if slot.optional else code(slot.name)
    return [name, shape, slot.dtype, slot.unit, slot.frame, what]


def _speakers(kind: str) -> Iterator[str]:
    for group in ("sensors", "actuators"):
        for name, builder in component_pages.builder_classes(group).items():
            if any(use.kind == kind for use in kinds(component_pages.component_class(builder))):
                yield f"[{name}]({group}/{name.lower()}.md)"
