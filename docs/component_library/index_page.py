"""The first pages of the component library: an overview of each kind."""

from __future__ import annotations

from typing import TYPE_CHECKING

from component_library import component_pages, pictures, robot_pages
from component_library.markdown import page, section, table

if TYPE_CHECKING:
    from collections.abc import Iterable

_INTRODUCTION = """Everything that a scene script can use. These pages are generated from the declarations in the code,
and are always up to date.

![All robots of MORSE](../pictures/robots.webp)"""
KINDS = ("robots", "sensors", "actuators")


def pages() -> dict[str, str]:
    """Name of a page, below the folder of the library, to its text."""
    kinds = {
        f"{kind}/index": page(kind.capitalize(), _list(kind, ""), _tree(map(str.lower, _names(kind)))) for kind in KINDS
    }
    parts = [section(kind.capitalize(), _list(kind, f"{kind}/")) for kind in KINDS]
    others = {
        "modifiers": "Modifiers",
        "models": "Environments and objects",
        "message-kinds": "Message kinds",
        "middlewares": "Middlewares",
        "services": "Services of the simulation",
        "world": "The world of a component",
        "coverage": "Coverage of MORSE 1.4, which is made when the documentation is built",
    }
    parts.append(section("And", *(f"- [{title}]({name}.md)" for name, title in others.items())))
    parts.append(_tree([*kinds, *others]))
    return {"index": page("Component library", _INTRODUCTION, *parts), **kinds}


def _names(kind: str) -> list[str]:
    return list(robot_pages.robot_classes() if kind == "robots" else component_pages.builder_classes(kind))


def _list(kind: str, folder: str) -> str:
    if kind == "robots":
        return table(
            ["", "robot", "what it is", "moved by"],
            (
                [
                    pictures.thumbnail(name, "../" if folder else "../../"),
                    _link(folder, name),
                    robot_pages.short_description(cls),
                    robot_pages.moved_by(cls),
                ]
                for name, cls in robot_pages.robot_classes().items()
            ),
        )
    return table(
        [kind[:-1], "description"],
        (
            [_link(folder, name), component_pages.short_description(cls)]
            for name, cls in component_pages.builder_classes(kind).items()
        ),
    )


def _link(folder: str, name: str) -> str:
    return f"[{name}]({folder}{name.lower()}.md)"


def _tree(names: Iterable[str]) -> str:
    return "\n".join(["```{toctree}", ":hidden:", "", *names, "```"])
