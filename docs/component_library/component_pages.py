"""A page for each sensor and each actuator that scene scripts can create."""

from __future__ import annotations

import inspect
import re
from importlib import import_module
from typing import Any

import morse.builder
from component_library import pictures, scenes
from component_library.declared import (
    data_table,
    kind_table,
    level_table,
    own_services,
    property_table,
    service_list,
    state_table,
)
from component_library.markdown import block, code, page, prose, section, table
from morse.builder import workspace
from morse.builder.creator import ActuatorCreator, ComponentCreator, SensorCreator
from morse.builder.names.catalog import load_class
from morse.core.classes.builder_defaults import BuilderDefaults, builder_defaults
from morse.core.declarations import data_fields
from morse.core.object import Object
from morse.middleware import registry

_NAMED = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)


def builder_classes(kind: str) -> dict[str, type[ComponentCreator]]:
    """The classes of scene scripts for ``sensors`` or ``actuators`` by name, sorted: of MORSE and of its plug-ins."""
    module = import_module(f"morse.builder.{kind}")
    found = {name: getattr(module, name) for name in module.__all__}
    of_plugins = re.compile(rf"morse\.plugins\.\w+\.{kind}\.")
    for name in morse.builder.__all__:
        value = getattr(morse.builder, name)
        if of_plugins.match(getattr(value, "_classpath", None) or ""):
            found[name] = value
    return {
        name: cls
        for name, cls in sorted(found.items())
        if inspect.isclass(cls) and issubclass(cls, ComponentCreator) and cls not in (SensorCreator, ActuatorCreator)
    }


def pages(kind: str) -> dict[str, str]:
    """Name of a page, below the folder of the library, to its text."""
    return {f"{kind}/{name.lower()}": _page(name, cls, kind) for name, cls in builder_classes(kind).items()}


def component_class(builder: type[ComponentCreator]) -> type[Any]:
    """The component class that the simulation runs."""
    assert builder._classpath is not None, f"{builder.__name__} does not say which class runs"
    return load_class(builder._classpath)


def source_of(builder: type[ComponentCreator]) -> str:
    """Where the formulas of a component come from, or the values of a product; empty if its class names no source."""
    cls = component_class(builder)
    product = builder_defaults(cls, builder.__name__) if builder.__name__ in _products(cls) else BuilderDefaults()
    return product.source or cls.__dict__.get("_source", "")


def _products(cls: type) -> set[str | None]:
    return {product.name for product in getattr(cls, "_products", ())}


def short_description(builder: type[ComponentCreator]) -> str:
    """What a component is, in one sentence."""
    text = inspect.getdoc(builder) or ""
    return prose(text).split("\n\n")[0].rstrip(".") + "."


def _sample(builder: type[ComponentCreator]) -> ComponentCreator | None:
    """A component as created by the builder, or None if the builder needs arguments."""
    needed = [p for p in inspect.signature(builder).parameters.values() if p.default is p.empty and p.kind in _NAMED]
    workspace.reset()
    return None if needed else builder(**scenes.ARGUMENTS.get(builder.__name__, {}))


def _page(name: str, builder: type[ComponentCreator], kind: str) -> str:
    cls = component_class(builder)
    sample = _sample(builder)
    sensor = kind == "sensors"
    fields = bool(data_fields(cls)) or cls.own_fields is not Object.own_fields
    interfaces = _interfaces(cls, "OUT" if sensor else "IN") if fields else ""
    facts = [["in scene scripts", code(f"{name}{_signature(builder.__init__) if sample is None else '()'}")]]
    facts.append(["runs", code(builder._classpath)])
    if source := source_of(builder):
        facts.append(["formula after", source])
    use = []
    if sample is not None:
        facts.append(["rate", f"{sample._frequency:g} Hz"])
    if sample is not None or name in scenes.OWN_SCENES:
        use.append(block("python", scenes.component_scene(name, sensor=sensor, fields=fields)))
        if interfaces:
            use += ["Its client:\n", block("python", scenes.client(name, cls, sensor=sensor))]
    changed = {} if sample is None else sample.scene_node.properties
    return page(
        name,
        short_description(builder),
        _more(cls),
        pictures.of(name),
        table(["", ""], facts),
        section("Use", *use),
        section("Data", "Data that it publishes.\n" if sensor else "Data of commands.\n", data_table(cls))
        if data_fields(cls)
        else "",
        section("Messages", kind_table(cls)),
        section("Properties", property_table(cls, changed)),
        section("State", state_table(cls)),
        section("Levels", level_table(cls)),
        section("In scene scripts", _own_methods(builder)),
        section("Services", service_list(cls, own_services(cls)), _common_services(sensor)),
        section("Middlewares", interfaces),
    )


def _more(cls: type) -> str:
    """The docstring of the class after its first sentence, if it is longer than the short description."""
    return prose(inspect.getdoc(cls))


def _common_services(sensor: bool) -> str:
    own = "`get_local_data`, " if sensor else ""
    return (
        f"Services of every component: {own}`get_properties`, `set_property`, `get_configurations` "
        "([services](../services.md))."
    )


def _interfaces(cls: type, direction: str) -> str:
    rows = []
    for name, middleware in registry.installed().items():
        stream = middleware.stream_of(cls, direction)
        if stream is not None:
            rows.append([code(name), code(stream.rpartition(".")[2])])
    return table(["middleware", "stream"], rows)


def _own_methods(builder: type[ComponentCreator]) -> str:
    """Methods of this builder class that other builder classes do not have."""
    lines = []
    for base in builder.__mro__:
        if base in (SensorCreator, ActuatorCreator):
            break
        for name, member in vars(base).items():
            if not name.startswith("_") and inspect.isfunction(member):
                lines.append(f"`{name}{_signature(member)}`\n: {' '.join(prose(inspect.getdoc(member)).split())}\n")
    return "\n".join(lines)


def _signature(function: Any) -> str:
    signature = inspect.signature(function)
    own = signature.replace(parameters=list(signature.parameters.values())[1:])
    return str(own).replace("'", "").removesuffix(" -> None")
