"""Laser scanners in fog, rain and snow."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from morse.core.modifier import AbstractModifier
from morse.plugins.weather.medium import Beam
from morse.plugins.weather.services import present

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.declarations import Option
    from morse.core.object import Object
    from morse.core.values import Options
    from morse.plugins.weather.medium import Conditions, Passage
    from morse.sensors.laserscanner import LaserScanner


class ScannerInWeather(AbstractModifier):
    """Loses echoes of distant and dark surfaces, and adds those of drops, flakes and fog.

    A scanner reports its strongest echo. Surfaces count as perpendicular to the beam: their normals would cost more
    than the scan.
    """

    _names = ("Weather",)
    _components = ("LaserScanner",)
    options: ClassVar[Mapping[str, Option]] = {}
    component_instance: LaserScanner
    not_state = (*AbstractModifier.not_state, "_known", "_passage")

    def __init__(self, component_instance: Object, kwargs: Options) -> None:
        super().__init__(component_instance, kwargs)
        self._known: tuple[Conditions, float] | None = None
        self._passage: Passage | None = None

    def modify(self) -> None:
        """Change ranges, points and remissions."""
        scanner, data = self.component_instance, self.data
        conditions = present(scanner.context)
        if conditions.is_clear:
            return
        reach = float(scanner.laser_range)
        if self._passage is None or self._known != (conditions, reach):
            self._known, self._passage = (conditions, reach), Beam(reach).through(conditions)
        passage = self._passage
        ranges = np.array(data["range_list"])
        is_hit = ranges < reach
        is_hit &= passage.detected(ranges)
        light = passage.received(ranges)
        echo = np.where(is_hit, passage.beam.white * light / np.maximum(ranges, 1e-3) ** 2, 0.0)

        random = scanner.tick_random("weather")
        drops = passage.first_drops(random, len(ranges))
        strength = np.where(np.isfinite(drops), passage.beam.threshold, 0.0)
        drops = np.minimum(drops, reach)
        fog_range, fog_echo = passage.fog_echo
        if fog_echo >= passage.beam.threshold:
            # speckle: the strength of the echo of many droplets is distributed exponentially
            in_fog = fog_echo * random.standard_exponential(len(ranges))
            is_fog = (in_fog >= passage.beam.threshold) & (in_fog > strength)
            drops, strength = np.where(is_fog, fog_range, drops), np.where(is_fog, in_fog, strength)
        is_false = (strength > echo) & (drops < ranges)
        data["range_list"] = np.where(is_false, drops, np.where(is_hit, ranges, reach))
        self._follow(is_hit, is_false, light)

    def _follow(self, is_hit: np.ndarray, is_false: np.ndarray, light: np.ndarray) -> None:
        """Compute the points and the remissions that belong to the changed ranges."""
        data, rays = self.data, self.component_instance.rays
        if "point_list" in data:
            there = np.where(is_hit | is_false, data["range_list"], 0.0)
            data["point_list"] = rays.directions * there[:, None] + 0.0
        if "remission_list" in data:
            seen = np.where(is_hit, np.asarray(data["remission_list"]) * light, 0.0)
            data["remission_list"] = np.where(is_false, 0.0, seen)
