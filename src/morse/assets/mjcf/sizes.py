"""Refuses MJCF models with sizes that are too large for the physics."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.errors import AssetError

if TYPE_CHECKING:
    from pathlib import Path

    from morse.assets.mjcf.model import ModelData

#: largest accepted length, m, and mass, kg
_FARTHEST, _HEAVIEST = 1e6, 1e9


def check_sizes(model: ModelData, path: Path) -> None:
    """Check lengths and masses.

    Raises:
        AssetError: one of them is too large.
    """
    lengths = [
        *(("body", one.name, one.position) for one in model.bodies),
        *(("joint", one.name, (*one.position, *(one.limits or ()))) for one in model.joints if one.kind == "slide"),
        *(("shape", one.name, (*one.position, *one.size)) for one in model.geoms if one.kind != "plane"),
    ]
    for what, name, values in lengths:
        largest = max(map(abs, values), default=0.0)
        if not largest <= _FARTHEST:
            raise AssetError(
                path, f"the {what} '{name:.60}' has a length of {largest:.3g} m, more than {_FARTHEST:g} m"
            )
    for body in model.bodies:
        if not body.inertial[0] <= _HEAVIEST:
            raise AssetError(
                path, f"the body '{body.name:.60}' has a mass of {body.inertial[0]:.3g} kg, more than {_HEAVIEST:g} kg"
            )
