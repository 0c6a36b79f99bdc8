"""Laser scanners and range finders in fog, rain and snow."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from morse.core.declarations import Option
from morse.core.modifier import AbstractModifier
from morse.mathutils.portable import matmul
from morse.plugins.weather.ground import DARK, LEVEL
from morse.plugins.weather.medium import LIDAR, Beam, Passage
from morse.plugins.weather.radio import attenuation_of_sound
from morse.plugins.weather.services import present
from morse.plugins.weather.zones import is_number

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from morse.core.world import Body
    from morse.plugins.weather.zones import Atmosphere
    from morse.sensors.laserscanner import LaserScanner
    from morse.sensors.range_finder import RangeFinder

    Floats = NDArray[np.float64]

#: reflectivity of surfaces without a material
_GREY = 0.5
#: frequency of an ultrasonic range finder, Hz
_ULTRASOUND = 40e3
#: temperature, °C, and humidity at which the reach of a range finder holds, and the humidity of rain and fog
_USUAL_TEMPERATURE, _USUAL, _HUMID = 20.0, 0.5, 1.0


class ScannerInWeather(AbstractModifier):
    """Loses echoes of distant surfaces, and adds those of drops, flakes and fog.

    A scanner reports its strongest, its first or its last echo (option ``echo``). By default, all surfaces count as
    white and perpendicular to the beam. With ``surfaces="material"``, they are diffuse (J. Lambert): the power of an
    echo is proportional to the cosine of the angle of incidence and to the property ``lidar_reflectivity`` of the
    object, which is the mean of the colour of its material without it; level wet ground keeps 60 % of it. This holds
    in clear air as well.
    """

    _names = ("Weather",)
    _components = ("LaserScanner",)
    options: ClassVar[Mapping[str, Option]] = {
        "echo": Option(str, "strongest", "which echo is reported", choices=("strongest", "first", "last")),
        "surfaces": Option(str, "white", "how surfaces reflect", choices=("white", "material")),
    }
    component_instance: LaserScanner
    not_state = (*AbstractModifier.not_state, "_known", "_passages")
    #: the tables of the beam by conditions, for the reach of the scanner
    _known: tuple[Atmosphere, float] | None = None
    _passages: tuple[Passage, ...] = ()

    def modify(self) -> None:
        """Change ranges, points and remissions."""
        scanner, data = self.component_instance, self.data
        air = present(scanner.context)
        by_material = self.parameter("surfaces", default="white") == "material"
        if air.is_clear and not by_material:
            return
        reach = float(scanner.laser_range)
        if self._known != (air, reach):
            beam = Beam(reach)
            self._known, self._passages = (air, reach), tuple(beam.through(medium) for medium in air.media)
        ranges = np.array(data["range_list"])
        beam = self._passages[0].beam
        place = np.array(scanner.bge_object.worldPosition)
        passage = self._passage_at(air, place, reach)
        random = scanner.tick_random("weather")
        if passage is None:
            drops, light, fog = self._through_zones(air, place, ranges, random)
        else:
            drops, light, fog = passage.first_drops(random, len(ranges)), passage.received(ranges), passage.fog_echo
        if by_material:
            reflected = self._reflected(air.outside.wet)
            light = light * (reflected / beam.white)
            if "remission_list" in data:
                data["remission_list"] = np.full(len(ranges), beam.white)
        is_hit = (ranges < reach) & (light >= (ranges / reach) ** 2)
        data["range_list"] = self._reported(beam, np.where(is_hit, ranges, np.inf), light, drops, fog, random)
        self._follow(is_hit, data["range_list"] != ranges, light)

    def _reflected(self, wet: float) -> Floats:
        """Return the light that surfaces send back (N,), as a share of that of a perfect white one that faces it."""
        rays = self.component_instance.rays
        normals, ways = rays.normals, rays.directions
        up = np.array(self.component_instance.bge_object.worldOrientation)[2]
        cosine, rise = ((normals[:, 0] * x + normals[:, 1] * y + normals[:, 2] * z) for x, y, z in ((-ways).T, up))
        # one of the rays on each solid; the last place is that of no hit
        hit = rays.hit
        ray_of = np.full(int(hit.max(initial=-1)) + 2, -1)
        ray_of[hit] = np.arange(len(hit))
        ray_of[-1] = -1
        by_solid = np.zeros(len(ray_of))
        for solid in np.flatnonzero(ray_of >= 0).tolist():
            body = rays.object_of(int(ray_of[solid]))
            by_solid[solid] = 0.0 if body is None else _reflectivity(body)
        shares = by_solid[hit]
        shares[rise > LEVEL] *= 1.0 - (1.0 - DARK) * wet
        return np.asarray(shares * np.clip(cosine, 0.0, 1.0))

    def _passage_at(self, air: Atmosphere, place: Floats, reach: float) -> Passage | None:
        """Return the tables that hold on all rays, or None if they go through several media."""
        for number, (zone, _) in enumerate(air.zones, start=1):
            # how far the borders are away
            room = [c - float(np.sum(np.array(n) * place)) for n, c in zone.half_spaces()]
            if min(room) >= reach:
                return self._passages[number]
            if min(room) > -reach:
                return None
        return self._passages[0]

    def _through_zones(
        self, air: Atmosphere, place: Floats, ranges: Floats, random: np.random.Generator
    ) -> tuple[Floats, Floats, tuple[float, float]]:
        """Return the first detected drop, and the share of the light that comes back, of each ray (N,); and fog."""
        turn = np.array(self.component_instance.bge_object.worldOrientation)
        rays = matmul(self.component_instance.rays.directions, turn.T)
        ways = [np.ascontiguousarray(rays[:, axis]) for axis in range(3)]
        depth = air.along(place, ways, ranges, lambda one: one.extinction(LIDAR))
        light = Passage.faded(np.asarray(depth, np.float64))
        spans = [zone.span(place, ways) for zone, _ in air.zones]
        reach = self._passages[0].beam.reach
        # each ray is cut where it enters or leaves a zone
        cuts = [np.zeros(len(ranges)), np.full(len(ranges), reach)]
        cuts += [np.minimum(distance, reach) for span in spans for distance in span]
        borders = np.sort(np.array(cuts), axis=0)
        drawn = random.standard_exponential(len(ranges))
        drops = np.full(len(ranges), np.inf)
        for start, end in pairwise(borders):
            middle = 0.5 * (start + end)
            medium = np.zeros(len(ranges), np.intp)
            for number, (enter, leave) in enumerate(spans, start=1):
                medium[(enter <= middle) & (middle < leave)] = number
            for number, passage in enumerate(self._passages):
                here = np.flatnonzero((medium == number) & (start < end) & np.isinf(drops))
                added = passage.drops_within(start[here], end[here])
                is_drop = drawn[here] < added
                drops[here[is_drop]] = passage.place_of_drop(start[here[is_drop]], drawn[here[is_drop]])
                drawn[here] -= added
        return drops, light, self._passages[air.number_at(place.tolist())].fog_echo

    def _reported(
        self,
        beam: Beam,
        ranges: Floats,
        light: Floats,
        drops: Floats,
        fog: tuple[float, float],
        random: np.random.Generator,
    ) -> Floats:
        """Return the ranges of the echoes that the scanner reports; its reach for none.

        Args:
            beam: the light of the scanner.
            ranges: of detected surfaces; infinite for none.
            light: the share of the light that comes back from them.
            drops: ranges of the first detected drops; infinite for none.
            fog: distance and strength of the echo of fog.
            random: for its speckle.
        """
        reach, mode = beam.reach, self.parameter("echo", default="strongest")
        strength = np.where(np.isfinite(ranges), beam.white * light / np.maximum(ranges, 1e-3) ** 2, 0.0)
        # what is behind a surface is not seen
        of_drop = np.where(drops < np.minimum(ranges, reach), beam.threshold, 0.0)
        candidates = [(ranges, strength), (drops, of_drop)]
        fog_range, fog_echo = fog
        if fog_echo >= beam.threshold:
            # speckle: the strength of the echo of many droplets is distributed exponentially
            in_fog = fog_echo * random.standard_exponential(len(ranges))
            in_fog[(in_fog < beam.threshold) | (ranges <= fog_range)] = 0.0
            candidates.append((np.full(len(ranges), fog_range), in_fog))
        best = np.full(len(ranges), reach)
        most = np.zeros(len(ranges))
        for there, power in candidates:
            if mode == "strongest":
                is_better = power > most
            elif mode == "first":
                is_better = (power > 0.0) & ((most == 0.0) | (there < best))
            else:
                is_better = (power > 0.0) & ((most == 0.0) | (there > best))
            best, most = np.where(is_better, there, best), np.where(is_better, power, most)
        return best

    def _follow(self, is_hit: NDArray[np.bool_], is_other: NDArray[np.bool_], light: Floats) -> None:
        """Compute the points and the remissions that belong to the changed ranges."""
        data, rays = self.data, self.component_instance.rays
        ranges = data["range_list"]
        if "point_list" in data:
            there = np.where(ranges < self.component_instance.laser_range, ranges, 0.0)
            data["point_list"] = rays.directions * there[:, None] + 0.0
        if "remission_list" in data:
            seen = np.where(is_hit & ~is_other, np.asarray(data["remission_list"]) * light, 0.0)
            data["remission_list"] = seen


def _reflectivity(body: Body) -> float:
    given = body.get("lidar_reflectivity")
    if is_number(given) and math.isfinite(given):
        return min(max(float(given), 0.0), 1.0)
    node = body.node
    materials = [*node.materials, *(node.mesh.materials if node.mesh is not None else ())]
    colours = [one.color[:3] for one in materials if one is not None]
    return min(max(sum(colours[0]) / 3.0, 0.0), 1.0) if colours else _GREY


class RangeFinderInWeather(AbstractModifier):
    """Shortens the reach of a range finder with one beam: no drop or flake is an echo.

    Infrared light fades as that of a scanner. Ultrasound is absorbed by the air (ISO 9613-1), whose humidity is 50 % in
    clear air and 100 % in fog, rain and snow; its temperature is the property ``Temperature`` of the environment.
    """

    _names = ("Weather",)
    _components = ("RangeFinder",)
    options: ClassVar[Mapping[str, Option]] = {}
    component_instance: RangeFinder

    def modify(self) -> None:
        """Lose what is too far away."""
        finder, distance = self.component_instance, float(self.data["distance"])
        air = present(finder.context)
        if air.is_clear or not 0.0 < distance < math.inf or finder.radiation == "radar":
            return
        # in nepers of power, there and back, beside those of clear air at the reach
        reach, place = finder._range, np.array(finder.bge_object.worldPosition)
        if finder.radiation == "ultrasound":
            given = finder.context.scene.properties.get("Temperature")
            celsius = float(given) if isinstance(given, (int, float)) and -60.0 <= given <= 60.0 else _USUAL_TEMPERATURE
            humidity = _USUAL if air.at(place.tolist()).is_clear else _HUMID
            lost = attenuation_of_sound(_ULTRASOUND, celsius, humidity) * distance
            usual = attenuation_of_sound(_ULTRASOUND, _USUAL_TEMPERATURE, _USUAL) * reach
            fade = 2.0 * (lost - usual) * math.log(10.0) / 10.0
            is_lost = fade + 4.0 * math.log(distance / reach) > 0.0
        else:
            way = np.array(finder.bge_object.worldOrientation)[:, :1]
            depth = air.along(place, list(way), np.array([distance]), lambda one: one.extinction(LIDAR))
            is_lost = 2.0 * float(depth[0]) + 2.0 * math.log(distance / reach) > 0.0
        if is_lost:
            self.data["distance"] = math.inf
