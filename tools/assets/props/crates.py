"""Wooden crates: one closed crate as an obstacle, two open ones."""

from __future__ import annotations

from common.crates import crate_woods, large_crate, lid, small_crate, transport_box


def build() -> None:
    planks, frame, wall, iron = crate_woods()
    small_crate("small_crate", wall, frame)
    large_crate("large_crate", planks, frame, iron)
    lid("cap_large_crate", planks, frame)
    transport_box("transport_box", planks, frame, iron)
