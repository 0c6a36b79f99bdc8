"""The base class of modifiers under the import path of MORSE 1.4."""

from morse.core.modifier import AbstractModifier

__all__ = ["AbstractModifier"]
