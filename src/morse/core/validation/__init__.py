"""Validation of all input: commands, properties, arguments of services, options of scripts.

The checks are derived from the declarations of the component (`morse.core.declarations`) or from the annotations of the
service.
"""

from morse.core.validation.arguments import Arguments, Range
from morse.core.validation.commands import ClientCommands, Commands
from morse.core.validation.fields import checked_options, checked_property, checked_value, with_defaults
from morse.core.validation.spec import CommandError, OptionError, PropertyError

__all__ = [
    "Arguments",
    "ClientCommands",
    "CommandError",
    "Commands",
    "OptionError",
    "PropertyError",
    "Range",
    "checked_options",
    "checked_property",
    "checked_value",
    "with_defaults",
]
