"""The declarations that component classes are written with."""

from morse.core.declarations import add_data, add_level, add_property

__all__ = ["add_data", "add_level", "add_property"]
