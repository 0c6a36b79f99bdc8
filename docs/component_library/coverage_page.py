"""A page that lists for each feature of MORSE 1.4 whether it is available, and the tests that use it."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from component_library import component_pages, of_1_4, robot_pages
from component_library.markdown import code, page, section, table
from morse.assets import search
from morse.builder.names import catalog
from morse.middleware import registry

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

_TESTS = Path(__file__).parents[2] / "tests"
_INTRODUCTION = """The names that scene scripts of MORSE 1.4 can use, whether they are available, and which tests use
them. The table is generated from the code whenever the documentation is built.

All available sensors, actuators and robots follow [the contract](../testing.md#components-of-your-own) of components:
`tests/verification` checks each of them; these tests are not listed again."""
_MOST_TESTS = 4
#: tests that run through the whole library contain the names of all components
_GENERAL = ("verification", "docs", "cli", "journey", "benchmarks")


def pages() -> dict[str, str]:
    """Name of a page, below the folder of the library, to its text."""
    parts = [_components("Sensors", "sensors", of_1_4.SENSORS), _components("Actuators", "actuators", of_1_4.ACTUATORS)]
    robots = {name: f"robots/{name.lower()}.md" for name in robot_pages.robot_classes()}
    parts.append(section("Robots", _table("robot", of_1_4.ROBOTS, robots)))
    modifiers = {name for entry in catalog.modifiers() for name in entry.attributes["_names"]}
    parts.append(section("Modifiers", _table("modifier", of_1_4.MODIFIERS, dict.fromkeys(modifiers, "modifiers.md"))))
    worlds = dict.fromkeys(search.available("environments"), "models.md")
    parts.append(section("Environments", _table("environment", of_1_4.ENVIRONMENTS, worlds)))
    middlewares = dict.fromkeys(registry.installed(), "middlewares.md")
    parts.append(section("Middlewares", _table("middleware", of_1_4.MIDDLEWARES, middlewares)))
    return {"coverage": page("Coverage of MORSE 1.4", _INTRODUCTION, *parts)}


def missing() -> list[str]:
    """The names of MORSE 1.4 that are not available."""
    return re.findall(r"^\| (?:`)?([\w/-]+)(?:`)? \| no \|", pages()["coverage"], re.MULTILINE)


def _components(title: str, kind: str, names: Iterable[str]) -> str:
    there = {name: f"{kind}/{name.lower()}.md" for name in component_pages.builder_classes(kind)}
    return section(title, _table(kind[:-1], names, there))


def _table(head: str, names: Iterable[str], there: dict[str, str]) -> str:
    return table([head, "there", "tests"], (_row(name, there.get(name)) for name in names))


def _row(name: str, link: str | None) -> list[str]:
    if link is None:
        return [code(name), "no", ""]
    tests = list(_tests_of(name))
    more = f" and {len(tests) - _MOST_TESTS} more" if len(tests) > _MOST_TESTS else ""
    return [f"[{name}]({link})", "yes", ", ".join(map(code, tests[:_MOST_TESTS])) + more]


def _tests_of(name: str) -> Iterator[str]:
    """The test files that use a name: as a call, or as a quoted word."""
    used = re.compile(rf"\b{re.escape(name)}\(|['\"]{re.escape(name)}['\"]")
    for file, text in _files().items():
        if name in text and used.search(text):  # the first condition alone is quick
            yield file


@cache
def _files() -> dict[str, str]:
    found = sorted(_TESTS.glob("*/test_*.py")) + sorted(_TESTS.glob("*/*/test_*.py"))
    return {
        path.relative_to(_TESTS).as_posix(): path.read_text(encoding="utf-8")
        for path in found
        if path.relative_to(_TESTS).parts[0] not in _GENERAL
    }
