"""The robots of MORSE, for scene scripts: one class for each of `morse.robots`."""

from __future__ import annotations

from morse.builder.components.robots import BarePR2, BasePR2, LocalizedPR2, NavPR2
from morse.builder.derive import derived_classes

_derived = derived_classes("morse.robots", __name__)
globals().update(_derived)

__all__ = ["BarePR2", "BasePR2", "LocalizedPR2", "NavPR2", *_derived]

# earlier versions had modules below this one, which plug-ins may find
__path__: list[str] = []
