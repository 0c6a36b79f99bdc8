"""Groups bundles that are cast together in one call of the kernel."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.rays import Fan
from morse.physics.rays.bundle import Scan

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.physics.rays.bundle import RayBundle
    from morse.physics.rays.caster import Caster
    from morse.physics.rays.solids import Solids


class _Group:
    """Bundles of one shape."""

    def __init__(self, bundles: list[RayBundle], solids: Solids) -> None:
        self._bundles, self._solids = bundles, solids
        self._first = first = bundles[0]
        self._mountings = [bundle.obj.offset for bundle in bundles]
        self._directions = first.directions
        self.fan = Fan(
            [bundle.obj.slot for bundle in bundles],
            np.array([position for position, _ in self._mountings]),
            np.array([rotation for _, rotation in self._mountings]).reshape(-1, 3, 3),
            first.directions,
            first.origins,
            first.upright,
            first.limit,
            [solids.owner_of(bundle.obj.slot) for bundle in bundles],
        )

    def holds(self) -> bool:
        """Whether the bundles are unchanged."""
        directions = self._directions
        for bundle, mounting in zip(self._bundles, self._mountings, strict=True):
            if bundle.directions is not directions or bundle.obj.invalid or bundle.obj.offset != mounting:
                return False
        return True

    def cast(self, caster: Caster, stamp: int) -> None:
        """Cast the rays, and store the results in the bundles."""
        scan = Scan(self._first, caster.cast(self.fan), self._solids)
        for row, bundle in enumerate(self._bundles):
            bundle.take(scan, row, stamp)


class Plan:
    """Some bundles, grouped by shape; each shape needs one call of the kernel."""

    def __init__(self, bundles: Sequence[RayBundle], solids: Solids) -> None:
        groups: dict[tuple[int, int, float, bool], list[RayBundle]] = {}
        for bundle in bundles:
            # a removed sensor has no results
            if len(bundle) and not bundle.obj.invalid:
                groups.setdefault(bundle.shape, []).append(bundle)
        self._groups = [_Group(group, solids) for group in groups.values()]

    def holds(self) -> bool:
        """Whether the plan is still valid: mountings and directions of the sensors are unchanged."""
        for group in self._groups:  # noqa: SIM110 (a loop takes half the time of a generator)
            if not group.holds():
                return False
        return True

    @property
    def fans(self) -> list[Fan]:
        """The rays of each shape."""
        return [group.fan for group in self._groups]

    def cast(self, caster: Caster, stamp: int) -> None:
        """Cast the rays of all bundles."""
        for group in self._groups:
            group.cast(caster, stamp)
