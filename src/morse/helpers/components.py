"""The declarations that component classes are written with."""

from morse.core.declarations import add_data, add_kind, add_level, add_property, each, euler, mapped, prop, scaled

__all__ = ["add_data", "add_kind", "add_level", "add_property", "each", "euler", "mapped", "prop", "scaled"]
