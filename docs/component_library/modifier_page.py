"""A page on the modifiers, from their declarations."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING

from component_library.declared import shown
from component_library.markdown import code, page, prose, section, table
from morse.builder.names import catalog
from morse.builder.names.catalog import load_class

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.core.modifier import AbstractModifier

_INTRODUCTION = """A modifier changes the data of a sensor before they reach the middleware, or the commands of an
actuator before they reach the actuator: `pose.alter('NED')`, with options as keywords:
`pose.alter('Noise', pos_std=0.1)`. Several modifiers are applied in the order of the script. A message contains the
frame, the unit and the covariance after all modifiers. The services of a modifier become services of the component."""


def pages() -> dict[str, str]:
    """Name of a page, below the folder of the library, to its text."""
    return {"modifiers": page("Modifiers", _INTRODUCTION, *_sections())}


def _sections() -> Iterator[str]:
    for entry in catalog.modifiers():
        cls: type[AbstractModifier] = load_class(entry.classpath)
        facts = [
            ["in scene scripts", ", ".join(code(f"alter({name!r})") for name in entry.attributes["_names"])],
            ["for", ", ".join(entry.attributes.get("_components", ()))],
        ]
        options = (
            [code(name), code(shown(option.default)), option.unit or "", option.doc]
            for name, option in cls.options.items()
        )
        yield section(
            cls.__name__,
            prose(inspect.getdoc(cls)) + "\n",
            table(["", ""], facts),
            table(["option", "default", "unit", "what"], options),
        )
