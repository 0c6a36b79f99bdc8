"""The base class of modifiers, where 1.4 had it."""

from morse.core.modifier import AbstractModifier

__all__ = ["AbstractModifier"]
