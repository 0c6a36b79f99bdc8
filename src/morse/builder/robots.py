"""The robots of MORSE, for scene scripts: one class for each of `morse.robots`."""

from __future__ import annotations

from morse.builder.derive import derived_classes

_derived = derived_classes("morse.robots", __name__)
globals().update(_derived)

__all__ = [*_derived]
