"""The declarations of components as rows of tables and lists."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

from component_library.markdown import arguments, code, prose, table
from morse.core.declarations import data_fields, kinds, levels, properties, state_variables
from morse.core.object import Object
from morse.core.services import ServiceDeclaration, declared_services, signature_of
from morse.core.validation.arguments import argument_ranges

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

#: characters of a number that are shown in full
_MOST_DIGITS = 8
_COMMON = {declaration.name for declaration in declared_services(Object)} | {"get_local_data"}


def data_table(cls: type) -> str:
    """The data fields of a component."""
    has_levels = bool(levels(cls))
    rows = []
    for name, field in data_fields(cls).items():
        level = field.level if isinstance(field.level, str) else ", ".join(field.level)
        # some defaults are words that describe the initial value
        words = isinstance(field.default, str) and field.type not in ("string", "str")
        default = field.default if words else code(shown(field.default))
        row = [code(name), field.type, field.unit, field.frame, default, _bounds(field.low, field.high), field.doc]
        rows.append([*row, level] if has_levels else row)
    return table(
        ["field", "type", "unit", "frame", "initial value", "range", "description", *(["level"] if has_levels else [])],
        rows,
    )


def property_table(cls: type, changed: Mapping[str, Any]) -> str:
    """The properties of a component.

    Args:
        cls: its class.
        changed: the properties that its builder class sets.
    """
    return table(
        ["property", "type", "unit", "default", "range", "what"],
        (
            [
                code(prop.name),
                prop.type,
                prop.unit,
                code(shown(changed.get(prop.name, prop.default))),
                ", ".join(map(str, prop.choices)) or _bounds(prop.low, prop.high),
                prop.doc,
            ]
            for prop in properties(cls).values()
        ),
    )


def state_table(cls: type) -> str:
    """What a component keeps from tick to tick, besides its fields and what all components keep."""
    return table(
        ["attribute", "type", "unit", "what"],
        (
            [code(name), code(variable.type_name), variable.unit, variable.doc]
            for name, variable in state_variables(cls).items()
            if name not in state_variables(Object)
        ),
    )


def level_table(cls: type) -> str:
    """The abstraction levels of a component."""
    return table(
        ["level", "what", ""],
        ([code(name), level.doc, "default" if level.default else ""] for name, level in levels(cls).items()),
    )


def kind_table(cls: type) -> str:
    """The message kinds of a component."""
    rows = []
    for use in kinds(cls):
        level = use.level if isinstance(use.level, str) else ", ".join(use.level)
        link = f"[{use.kind}](../message-kinds.md#{use.kind.replace('_', '-')})"
        remark = "on request" if use.on_request else ""
        rows.append([link, ", ".join(use.slots), use.topic and code(use.topic), level, remark])
    return table(["kind", "slots", "sub-topic", "level", ""], rows)


def own_services(cls: type) -> list[ServiceDeclaration]:
    """The services of a component that other components do not have."""
    return [declaration for declaration in declared_services(cls) if declaration.name not in _COMMON]


def service_list(cls: type, declarations: Iterable[ServiceDeclaration]) -> str:
    """Services with their signatures and arguments."""
    return "\n".join(_service(cls, declaration) for declaration in declarations)


def _service(cls: type, declaration: ServiceDeclaration) -> str:
    method = getattr(cls, declaration.attribute)
    # the signature of a bound method, because clients do not pass `self`
    signature = signature_of(method.__get__(object()))
    shown = f"{declaration.name}{signature}".replace("'", "").removesuffix(" -> None")
    plain = inspect.getdoc(method) or ""
    lines = [f"`{shown}`", f": {' '.join(prose(plain).split())}"]
    if declaration.asynchronous:
        lines[1] += " Answers when it is done; can be cancelled."
    ranges = argument_ranges(method)
    explained = arguments(plain)
    lines += [f"  - `{name}`: {what}{f' ({ranges[name]})' if name in ranges else ''}" for name, what in explained]
    lines += [f"  - `{name}`: {what}" for name, what in ranges.items() if name not in dict(explained)]
    if len(lines) > 2:
        lines.insert(2, "")
    return "\n".join(lines) + "\n"


def _bounds(low: float | None, high: float | None) -> str:
    if low is None and high is None:
        return ""
    return f"{'' if low is None else f'{low:g}'} … {'' if high is None else f'{high:g}'}".strip()


def shown(value: Any) -> str:
    """A value in Python, with as many digits of a number as anybody would write: 5° in radians has sixteen."""
    if isinstance(value, float) and len(repr(value)) > _MOST_DIGITS:
        return f"{value:.4g}"
    return repr(value) if isinstance(value, str) else str(value)
