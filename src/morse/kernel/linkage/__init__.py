"""Linkages: bones that joints move, and the objects and collision shapes attached to them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.kernel.linkage.native import NativeLinkage
from morse.kernel.loading import library

if TYPE_CHECKING:
    from morse.kernel.linkage.arrays import LinkageArrays, LinkageWork

__all__ = ["linkage"]


def linkage(arrays: LinkageArrays) -> LinkageWork:
    """The function that moves a linkage."""
    return NativeLinkage(library(), arrays)
