"""A page on the components that each middleware supports, from their declarations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from component_library import component_pages
from component_library.markdown import code, page, section, table
from morse.builder.names.catalog import load_class
from morse.core.declarations import data_fields, kinds
from morse.core.kinds.table import GENERAL
from morse.middleware import registry

if TYPE_CHECKING:
    from collections.abc import Iterator

_INTRODUCTION = """The message kinds that each middleware supports with messages of their own; *general* for the general
format (all fields of the component), – for none. Kinds in parentheses depend on the level or the properties of the
component."""
_WAYS = (("sensors", "OUT"), ("actuators", "IN"))


def pages() -> dict[str, str]:
    """Name of a page, below the folder of the library, to its text."""
    names = list(registry.installed())
    parts = [
        section(group.capitalize(), table(["component", *map(code, names)], _rows(group, direction, names)))
        for group, direction in _WAYS
    ]
    return {"middlewares": page("Middlewares", _INTRODUCTION, *parts)}


def _rows(group: str, direction: str, names: list[str]) -> Iterator[list[str]]:
    for name, builder in component_pages.builder_classes(group).items():
        cls = component_pages.component_class(builder)
        if data_fields(cls):
            yield [f"[{name}]({group}/{name.lower()}.md)", *(_form(cls, direction, other) for other in names)]


def _form(cls: type[Any], direction: str, middleware_name: str) -> str:
    middleware = registry.installed()[middleware_name]
    if middleware.stream_of(cls, direction) is None or middleware.stream_manager is None:
        return "–"
    manager = load_class(middleware.stream_manager)
    forms = []
    for use in kinds(cls):
        known = manager.has_form(use.kind, direction) and use.kind != GENERAL
        forms.append((use.kind if known else "*general*", use.when is not None or use.level != "all" or use.on_request))
    always = [form for form, depends in forms if not depends]
    perhaps = [form for form, depends in forms if depends and form not in always]
    return ", ".join(dict.fromkeys([*always, *(f"({form})" for form in perhaps)])) or "*general*"
