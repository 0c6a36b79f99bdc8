"""Validation of properties and options in scripts against the declarations of components, middlewares and modifiers."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from morse.builder.compatibility import value_of_today
from morse.builder.errors import checks
from morse.builder.names.catalog import load_class
from morse.core import declarations
from morse.core.datastream import COMMON_OPTIONS
from morse.core.exceptions import MorseBuilderNoComponentError
from morse.core.validation import checked_options, checked_value
from morse.core.validation.fields import check_settable, spec_of_option, spec_of_property
from morse.middleware import registry

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from morse.core.declarations import Option, Property
    from morse.core.validation.spec import Spec
    from morse.core.values import Options, Properties

logger = logging.getLogger(__name__)


def properties_of_today(
    owner: str, declarations: Mapping[str, Property], parameters: Mapping[str, object]
) -> Properties:
    """Return the properties of a component, with numbers and truth values instead of the texts for them."""
    return {
        name: _value(spec_of_property(declarations[name], script=True), value, f"the property '{name}' of {owner}")
        if name in declarations
        else value
        for name, value in parameters.items()
    }


def options_of_today(owner: str, declarations: Mapping[str, Option], parameters: Mapping[str, object]) -> Options:
    """Return the options of a modifier, with numbers and truth values instead of the texts for them."""
    return {
        name: _option(declarations[name], value, f"the option '{name}' of {owner}") if name in declarations else value
        for name, value in parameters.items()
    }


def _option(option: Option, value: object, what: str) -> object:
    if not isinstance(option.type, tuple):
        return _value(spec_of_option(option), value, what)
    if float not in option.type or str in option.type:
        return value
    # a number for each axis
    if isinstance(value, dict) and dict in option.type:
        return {axis: _number(part, f"{what} ({axis})") for axis, part in value.items()}
    return _number(value, what)


def _number(value: object, what: str) -> object:
    return value_of_today("number", value, what) if isinstance(value, str) else value


def _value(spec: Spec, value: object, what: str) -> object:
    if not isinstance(value, str):
        return value
    if spec.kind in ("number", "integer"):
        return value_of_today("number", value, what)
    return value_of_today("boolean", value, what) if spec.kind == "boolean" else value


#: these properties are read by MORSE itself, independent of the declarations of the component
_GENERAL = frozenset({"classpath", "frequency", "abstraction_level", "Component_Tag", "Robot_Tag"})


#: likeness of a misspelled name, where other names are allowed
_ALIKE = 0.8


def warn_if_misspelled(owner: str, names: Iterable[str], known: Iterable[str]) -> None:
    """Warn about properties that are nearly those that the owner has; others are the user's own."""
    words = list(known)
    for name in names:
        near = checks.closest(name, words, _ALIKE) if name not in words else None
        if near is not None:
            logger.warning("%s has no property '%s'; did you mean '%s'? (it is kept)", owner, name, near)


def check_declared(cls: type, values: Mapping[str, object], *, has_own: bool = False) -> Properties:
    """Return properties as they are to be stored, with a warning for those that a component does not declare.

    Args:
        has_own: whether others are properties of the user's own, as those of robots: only misspelt ones are named.

    Raises:
        PropertyError: a value has the wrong type, or is outside of the declared range or choices.
    """
    properties = {p.name: p for p in declarations.properties(cls).values()}
    values = properties_of_today(cls.__name__, properties, values)
    for name, value in values.items():
        if name in properties:
            check_settable(cls.__name__, properties[name])
            checked_value(cls.__name__, properties[name], value, script=True)
        elif not has_own and name not in _GENERAL:
            logger.warning(
                "%s has no property '%s'%s (it is kept, but %s does not use it)",
                cls.__name__,
                name,
                checks.suggestion(name, properties),
                cls.__name__,
            )
    if has_own:
        warn_if_misspelled(cls.__name__, values, properties)
    return values


#: options of any middleware; a script may keep them when it changes the middleware
_OF_SOME_MIDDLEWARE = ("topic", "frame_id", "parent_frame_id", "child_frame_id", "device")


def stream_options(manager: str, values: Mapping[str, object]) -> Options:
    """The options of a stream.

    Args:
        manager: class path of the stream manager.
        values: options by name.

    Raises:
        OptionError: there is no such option, or the value is not valid.
    """
    middleware = registry.middleware_of_stream_manager(manager)
    if middleware is None or middleware.stream_options is None:
        return dict(values)
    options = {**COMMON_OPTIONS, **middleware.stream_options}
    common = {}
    for name, value in values.items():
        if name in _OF_SOME_MIDDLEWARE and name not in options:
            logger.warning("the option '%s' has no effect on %s: leave it out", name, middleware.name)
        else:
            common[name] = value
    return checked_options(f"a stream of {middleware.name}", options, common)


def with_file_options(
    manager: str, values: Mapping[str, object], of_file: Mapping[str, object]
) -> Mapping[str, object]:
    """Add the options of topics that the file of a robot sets to those of the script, which come first."""
    middleware = registry.middleware_of_stream_manager(manager) if of_file else None
    if middleware is None or not middleware.names_topics_as_ros:
        return values
    options = middleware.stream_options or {}
    return {**{name: value for name, value in of_file.items() if name in options}, **values}


def manager_options(manager: str, values: Mapping[str, object]) -> Options:
    """The options of a stream manager.

    Args:
        manager: its class path.
        values: options by name.

    Raises:
        OptionError: there is no such option, or the value is not valid.
    """
    middleware = registry.middleware_of_stream_manager(manager)
    if middleware is None:
        return dict(values)
    options = middleware.manager_options
    if options is None and not manager.startswith("morse."):
        options = _declared_by_manager(manager)
    if options is None:
        return dict(values)
    return checked_options(f"the stream manager of {middleware.name}", options, values)


def _declared_by_manager(manager: str) -> Mapping[str, Option] | None:
    """The options that the class of a user's manager declares; None if it cannot be loaded here."""
    try:
        options: Mapping[str, Option] | None = getattr(load_class(manager), "manager_options", None)
    except MorseBuilderNoComponentError:
        return None
    return options


def options_of_classes(classpaths: Sequence[str], values: Mapping[str, object]) -> Options:
    """Return the options of a modifier that has a class for each kind of sensors: each takes those that it has.

    Args:
        classpaths: class paths of the modifier.
        values: options by name.

    Raises:
        OptionError: a value is not valid, or the name of an option is misspelt. An option that resembles none is left
            out, with a warning.
    """
    found: Options = {}
    rest = dict(values)
    for classpath in classpaths:
        try:
            known = getattr(load_class(classpath), "options", None)
        except MorseBuilderNoComponentError:
            known = None
        own = {name: value for name, value in values.items() if known is None or name in known}
        found |= modifier_options(classpath, own)
        rest = {name: value for name, value in rest.items() if name not in own}
    for classpath in classpaths:
        rest = modifier_options(classpath, rest)
    return found | rest


def modifier_options(classpath: str, values: Mapping[str, object]) -> Options:
    """Return the options of a modifier; a class without ``options`` accepts any option.

    Args:
        classpath: class path of the modifier.
        values: options by name.

    Raises:
        OptionError: a value is not valid, or the name of an option is misspelt. An option that resembles none is left
            out, with a warning.
    """
    if not values:
        return {}
    try:
        cls = load_class(classpath)
    except MorseBuilderNoComponentError:
        return dict(values)  # the error is reported when the scene is loaded
    options: Mapping[str, Option] | None = getattr(cls, "options", None)
    if options is None:
        return dict(values)
    owner = f"the modifier {cls.__name__}"
    known = dict(values)
    for name in values:
        if name not in options and checks.closest(name, options, _ALIKE) is None:
            logger.warning("%s has no option '%s'%s (it has no effect)", owner, name, checks.suggestion(name, options))
            del known[name]
    return checked_options(owner, options, options_of_today(owner, options, known))
