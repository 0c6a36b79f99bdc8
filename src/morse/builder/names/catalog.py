"""The catalogue of components and modifiers, read from their files without executing them; and their classes.

A scene with three sensors should not load forty sensors, and should not fail because one of the others is broken. A
class is included if its body sets ``_name`` (components) or ``_names`` (modifiers): names in scene scripts. The body of
a modifier also contains the components for which it is suitable::

    class CoordinatesToNED(AbstractModifier):
        _names = ("NED",)
        _components = ("Pose", "GPS")
"""

from __future__ import annotations

import logging
import pkgutil
import traceback
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec, resolve_name
from pathlib import Path
from typing import TYPE_CHECKING, Any

from morse.builder.errors import checks
from morse.core.classes import classpath as classpaths
from morse.core.classes.definitions import indexed
from morse.core.classes.plugins import PluginError, attempt, entry_points
from morse.core.exceptions import MorseBuilderError, MorseBuilderNoComponentError
from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.core.classes.definitions import Definition

logger = logging.getLogger(__name__)

#: file names of the import machinery of Python, which is between a module and its imports in a traceback
_OURS = str(Path(__file__).parents[2])


def load_class(classpath: str) -> type[Any]:
    """The class of a component, e.g. ``ranger_sim.actuators.eyes.Eyes``.

    Raises:
        MorseBuilderNoComponentError: the class does not exist, or its file has an error; the message contains the file
            and the line.
    """
    try:
        return classpaths.load_class(classpath)
    except classpaths.ClassPathError as error:
        raise MorseBuilderNoComponentError(str(error)) from None
    except Exception as error:
        raise MorseBuilderNoComponentError(_broken(classpath, error)) from error


def _broken(classpath: str, error: Exception) -> str:
    if isinstance(error, SyntaxError):
        place, message = f"{error.filename}:{error.lineno}", error.msg
    else:
        trace = traceback.extract_tb(error.__traceback__)
        frames = [f for f in trace if not f.filename.startswith(("<frozen", _OURS))] or trace
        place, message = f"{frames[-1].filename}:{frames[-1].lineno}", str(error)
    return f"the component class {classpath} cannot be loaded: {type(error).__name__}: {message} ({place})"


def classes(package: str) -> Iterator[tuple[str, Definition]]:
    """The public classes in the files of a package, with the names of their modules.

    Raises:
        SyntaxError: one of the files cannot be parsed.
    """
    for module, file in files(package):
        for definition in classes_of(file):
            yield module, definition


def files(package: str) -> Iterator[tuple[str, Path]]:
    """The file of a package, or of a module without others in it, and its public modules and their files.

    Empty if the package does not exist.
    """
    try:
        spec = find_spec(package)
    except ModuleNotFoundError:
        spec = None
    if spec is None:
        return
    if spec.has_location and spec.origin is not None and spec.origin.endswith(".py"):
        yield package, Path(spec.origin)
    # without folders, `iter_modules` would go through all modules of the import path
    for info in pkgutil.iter_modules(spec.submodule_search_locations or ()):
        if info.ispkg or info.name.startswith("_"):
            continue
        finder = info.module_finder
        module = finder.find_spec(f"{package}.{info.name}", None)
        if module is None or module.origin is None:
            continue
        yield f"{package}.{info.name}", Path(module.origin)


def classes_of(file: Path) -> Iterator[Definition]:
    """The public classes of a file.

    Raises:
        SyntaxError: the file cannot be parsed.
    """
    yield from indexed(file)


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


def components(package: str) -> dict[str, Entry]:
    """The components of a package such as ``morse.sensors`` or ``my_lab.robots`` by name, sorted."""
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


def base_classes(package: str, classpath: str) -> tuple[str, ...]:
    """The class paths of the base classes of a public class of a package; empty if it has no such class."""
    for module, definition in _definitions(package):
        if f"{module}.{definition.name}" == classpath:
            return tuple(resolve_name(base, module) for base in definition.bases)
    return ()


def _definitions(package: str) -> tuple[tuple[str, Definition], ...]:
    # projects in one process may have packages of the same name
    return _own_definitions(package) if package.startswith("morse.") else tuple(classes(package))


@cache
def _own_definitions(package: str) -> tuple[tuple[str, Definition], ...]:
    return tuple(classes(package))


def _text(defaults: dict[str, object], doc: str) -> str:
    return str(defaults.get("doc") or doc).strip()


def modifiers() -> tuple[Entry, ...]:
    """The modifiers of ``morse.modifiers`` and of the packages that the entry points ``morse.modifiers`` name."""
    # those of packages are read again, because projects in one process may have packages of the same name
    places = (point.value for point in entry_points("morse.modifiers"))
    return (*_own_modifiers(), *(entry for place in places for entry in _modifiers_at(place)))


@cache
def _own_modifiers() -> tuple[Entry, ...]:
    return tuple(_modifiers_at("morse.modifiers"))


def _modifiers_at(place: str) -> tuple[Entry, ...]:
    """The modifiers in a package or a module, or the class ``module:Class``."""
    try:
        return attempt(lambda: tuple(_named_modifiers(place)))
    except PluginError as error:
        # an error in a third-party package must not prevent the scene from being built
        logger.warning("the modifiers of %s are left out: %s", place, error, extra=OF_MACHINE)
        return ()


def _named_modifiers(place: str) -> Iterator[Entry]:
    package, _, wanted = (part.strip() for part in place.partition(":"))
    definitions = [one for one in classes(package) if not wanted or one[1].name == wanted]
    is_found = False
    for module, definition in definitions:
        attributes = definition.attributes
        if "_names" not in attributes:
            continue
        is_found = True
        for name in ("_names", "_components"):
            names = attributes.get(name, ())
            if not isinstance(names, (tuple, list)) or not all(isinstance(one, str) for one in names):
                text = f"{name} of {definition.name} is {names!r}, expected a tuple of names, such as ('Pose',)"
                raise MorseBuilderError(text)
        yield Entry(definition.name, f"{module}.{definition.name}", definition.doc or "", attributes)
    if not is_found:
        if not any(files(package)):
            raise MorseBuilderError(f"there is no package or module '{package}'")
        raise MorseBuilderError(f"it has no class{wanted and ' '}{wanted} with _names, such as _names = ('Drift',)")


def fitting_modifier(name: str, component: type) -> str | None:
    """The class path of the modifier of that name for a component; None if it has none."""
    fitting = modifier_classes().get(name, {})
    return next((fitting[base.__name__] for base in component.__mro__ if base.__name__ in fitting), None)


def find_modifier(name: str, component: type | None) -> str:
    """The class path of the modifier of that name for a component.

    Raises:
        MorseBuilderError: there is no such modifier; the message lists the existing ones.
    """
    bases = {base.__name__ for base in component.__mro__} if component is not None else set()
    suitable: dict[str, str] = {}
    others: set[str] = set()
    for entry in modifiers():
        names, fits = entry.attributes["_names"], entry.attributes.get("_components", ())
        if name in names:
            others.update(fits or ["nothing: its class has no _components"])
        if bases & set(fits):
            suitable.update(dict.fromkeys(names, entry.classpath))
    if name in suitable:
        return suitable[name]
    what = component.__name__ if component is not None else "an object without behaviour"
    choices = f"; there are {', '.join(sorted(suitable))}" if suitable else f"; there are none for {what}"
    hint = checks.suggestion(name, suitable) or choices
    if others:
        raise MorseBuilderError(f"the modifier '{name}' is for {', '.join(sorted(others))}, not for {what}{hint}")
    if not hint.endswith("?"):
        hint += "; name a class of your own by classpath=, or its package by the entry point morse.modifiers"
    raise MorseBuilderError(f"there is no modifier '{name}' for {what}{hint}")


def modifier_classes() -> dict[str, dict[str, str]]:
    """The class paths of all modifiers, by name and by the name of the component class."""
    classes: dict[str, dict[str, str]] = {}
    for entry in modifiers():
        for name in entry.attributes["_names"]:
            classes.setdefault(name, {}).update(dict.fromkeys(entry.attributes.get("_components", ()), entry.classpath))
    return classes
