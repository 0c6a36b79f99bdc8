"""The catalogue of components and modifiers, read from their files without executing them.

A scene with three sensors should not load forty sensors, and should not fail because one of the others is broken. A
class is included if its body sets ``_name`` (components) or ``_names`` (modifiers).
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from functools import cache
from importlib.util import resolve_name
from typing import TYPE_CHECKING, Any

from morse.builder.names import sources
from morse.core.classes.plugins import entry_points
from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.core.classes.definitions import Definition


logger = logging.getLogger(__name__)


#: the folders of components
KINDS = ("sensors", "actuators", "robots")


@dataclass(frozen=True, slots=True)
class Entry:
    """A class of the catalogue, or a product that such a class simulates.

    Attributes:
        name: name in scene scripts.
        classpath: class path.
        doc: one-sentence description.
        attributes: the class attributes whose values are plain literals.
        defaults: the plain literals among the arguments of its `BuilderDefaults` or `RobotDefaults`, or None without
            such a declaration.
        product: the name of the product, or None for the class itself.
    """

    name: str
    classpath: str
    doc: str
    attributes: dict[str, Any]
    defaults: dict[str, Any] | None = None
    product: str | None = None


@cache
def components(package: str) -> dict[str, Entry]:
    """The components of ``morse.sensors``, ``morse.actuators`` or ``morse.robots`` by name, sorted."""
    entry_lists = (entry for module, definition in _definitions(package) for entry in entries(module, definition))
    return {entry.name: entry for entry in sorted(entry_lists, key=lambda entry: entry.name)}


def entries(module: str, definition: Definition, *, with_name: bool = False) -> Iterator[Entry]:
    """Return the entries of a class: the class itself, and the products that it simulates.

    Args:
        module: module of the class.
        definition: the class.
        with_name: include the class even if its body does not set ``_name``.
    """
    attributes = definition.attributes
    if not isinstance(attributes.get("_name"), str) and not with_name:
        return
    classpath = f"{module}.{definition.name}"
    doc = attributes.get("_short_desc") or definition.doc or attributes.get("_name", definition.name)
    defaults = next(iter(definition.defaults["_builder"]), None)
    values = defaults or {}
    yield Entry(values.get("name") or definition.name, classpath, _text(values, doc), attributes, defaults)
    for product in definition.defaults["_products"]:
        yield Entry(product["name"], classpath, _text(product, doc), attributes, product, product["name"])


@cache
def base_classes(package: str) -> dict[str, tuple[str, ...]]:
    """The class paths of the base classes of each public class in the files of a package, by class path."""
    return {
        f"{module}.{definition.name}": tuple(resolve_name(base, module) for base in definition.bases)
        for module, definition in _definitions(package)
    }


@cache
def _definitions(package: str) -> tuple[tuple[str, Definition], ...]:
    return tuple(sources.classes(package))


def _text(defaults: dict[str, object], doc: str) -> str:
    return str(defaults.get("doc") or doc).strip()


def modifiers() -> tuple[Entry, ...]:
    """The modifiers of ``morse.modifiers`` and of the packages that the entry points ``morse.modifiers`` name."""
    # those of packages are read again, because projects in one process may have packages of the same name
    packages = (point.value for point in entry_points("morse.modifiers"))
    return (*_own_modifiers(), *(entry for package in packages for entry in _modifiers_of(package)))


@cache
def _own_modifiers() -> tuple[Entry, ...]:
    return tuple(_modifiers_of("morse.modifiers"))


def _modifiers_of(package: str) -> Iterator[Entry]:
    try:
        for module, definition in sources.classes(package):
            if "_names" in definition.attributes:
                classpath = f"{module}.{definition.name}"
                yield Entry(definition.name, classpath, definition.doc or "", definition.attributes)
    except Exception as error:
        # an error in a third-party package must not prevent the scene from being built
        logger.warning("the modifiers of %s are left out: %r", package, error, extra=OF_MACHINE)
