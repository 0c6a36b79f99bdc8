"""The first page of the component library."""

from __future__ import annotations

from typing import TYPE_CHECKING

from component_library import component_pages, markdown, robot_pages
from component_library.markdown import section, table

if TYPE_CHECKING:
    from collections.abc import Sequence

_INTRODUCTION = """Everything that a scene script can use. These pages are made from what the components say of
themselves, so they are never older than the code.

![All robots of MORSE](../pictures/robots.webp)"""


def page_of(kind: str, name: str) -> str:
    """A link to the page of a component."""
    return f"[{name}]({kind}/{name.lower()}.md)"


def page(names: Sequence[str]) -> str:
    """The page, with links to pages of these names."""
    parts = [section("Robots", _robots())]
    for kind in ("sensors", "actuators"):
        rows = [
            [page_of(kind, name), component_pages.short_description(cls)]
            for name, cls in component_pages.builder_classes(kind).items()
        ]
        parts.append(section(kind.capitalize(), table([kind[:-1], "what it does"], rows)))
    parts.append(section("And", "- [Environments and things](models.md)\n- [Services of the simulation](services.md)"))
    tree = "\n".join(["```{toctree}", ":hidden:", "", *names, "```"])
    return markdown.page("Component library", _INTRODUCTION, *parts, tree)


def _robots() -> str:
    rows = [
        [page_of("robots", name), robot_pages.short_description(cls), robot_pages.moved_by(cls)]
        for name, cls in robot_pages.robot_classes().items()
    ]
    return table(["robot", "what it is", "moved by"], rows)
