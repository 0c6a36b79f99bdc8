"""Validation of options in scripts against the declarations of middlewares and modifiers."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from morse.builder.legacy import declared_values
from morse.builder.names.classes import load_class
from morse.core.datastream import COMMON_OPTIONS
from morse.core.exceptions import MorseBuilderNoComponentError
from morse.core.validation import checked_options
from morse.middleware import registry

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.declarations import Option
    from morse.core.values import Options

logger = logging.getLogger(__name__)

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


def modifier_options(classpath: str, values: Mapping[str, object]) -> Options:
    """Return the options of a modifier; a class without ``options`` accepts any option.

    Args:
        classpath: class path of the modifier.
        values: options by name.

    Raises:
        OptionError: there is no such option, or the value is not valid.
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
    return checked_options(owner, options, declared_values.options(owner, options, values))
