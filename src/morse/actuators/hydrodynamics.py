"""Buoyancy, drag and current."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.core.limits import SPEED
from morse.helpers.components import add_data, add_kind, add_property
from morse.helpers.waves import Hull, Sea
from morse.kernel.water import WaterValues, pusher
from morse.mathutils.rotations import turn as turned
from morse.mathutils.rotations import turn_back
from morse.scene.extent import extent

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.core.limits import Limits
    from morse.core.robot import Robot
    from morse.core.world import Body

#: drag coefficients of a vessel along its axes, after those of streamlined bodies and of plates
_COEFFICIENTS = (0.2, 1.1, 1.1)
_THINNEST = 1e-3  # m
#: relative damping of heave, as that of the vessel Otter in Fossen's toolbox MSS
_HEAVE = 0.3
#: maximum force and torque of the engine, N and N·m
_MOST = 1e8
_SIZE: Limits = {"unit": "m", "low": 0.0, "high": 1e4}


class Hydrodynamics(Actuator):
    """Applies buoyancy, drag and the current of water to a robot.

    A box of eight cells approximates the robot. Each cell below the surface is pushed up by the weight of the water
    that it displaces, rho V g / 8. Drag on each cell is C v |v| / 8 along each axis of the robot, with the speed v of
    the cell relative to the water. C = rho c A / 2 is the coefficient of the whole robot along an axis: A is the
    cross-section of the box, and c is 0.2 along X and 1.1 along Y and Z. The same forces damp rotations, and turn a
    robot at the surface upright. The centre of mass of the robot is taken to be the centre of the box. In one tick,
    drag reduces the speed by at most half. This limit only affects robots that are very light for their size.

    Water moves along with the robot (the added mass): along each axis, that of a plate with the cross-section of the
    box, in proportion to the displaced water, half of it along Z at the surface. Waves that the robot makes damp heave,
    roll and pitch: each cell at the surface has 0.3 of the critical damping. ``AddedMass`` and ``WaveDamping`` are
    factors of both. Forces that couple axes, such as the Munk moment, are not modelled.

    ``env.properties(WaveHeight=0.5, WavePeriod=6.0, WaveDirection=0.0)`` makes waves of the sea, the same for all
    robots: significant height (m), period of the highest waves (s) and direction (rad), with the spectrum JONSWAP and
    phases by the seed. The surface at each cell lifts the robot and takes it along vertically. The horizontal motion of
    the water and diffraction are not modelled: waves are to be longer than the robot. Pictures show the calm surface.

    The weight of a robot without gravity, such as the Submarine, acts as well: above the water the robot falls.
    """

    applies_forces = True
    _name = "Hydrodynamics"
    _source = (
        "Archimedes; waves by JONSWAP, 1973; added mass of plates by DNV-RP-N103; damping of heave by T. I. Fossen, "
        "Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., 2021"
    )
    _short_desc = "Applies buoyancy, drag and the current of water to the robot"

    add_data("current", [0.0, 0.0, 0.0], "vec3<float>", "Velocity of the water", frame="world", shape=3, **SPEED)
    add_kind("twist", linear="current", angular=(None, None, None))
    add_property(
        "_surface",
        math.inf,
        "Surface",
        "float",
        "Height of the surface; inf: height of the object Water of the world, or water everywhere if there is none",
        unit="m",
        allow=("inf",),
    )
    add_property(
        "_density",
        1025.0,
        "Density",
        "float",
        "Density of the water: 1025 in the sea",
        unit="kg/m^3",
        low=0.0,
        high=1e5,
    )
    add_property(
        "_volume",
        0.0,
        "Volume",
        "float",
        "Volume of the robot; 0: chosen so that the robot floats",
        unit="m^3",
        low=0.0,
        high=1e9,
    )
    add_property("_length", 0.0, "Length", "float", "Length of the box; 0: length of the model", **_SIZE)
    add_property("_width", 0.0, "Width", "float", "Width of the box; 0: width of the model", **_SIZE)
    add_property("_height", 0.0, "Height", "float", "Height of the box; 0: height of the model", **_SIZE)

    add_property("_added", 1.0, "AddedMass", "float", "Factor of the added mass; 0: none", low=0.0, high=100.0)
    add_property(
        "_damping", 1.0, "WaveDamping", "float", "Factor of the damping at the surface; 0: none", low=0.0, high=3.0
    )

    _added: float
    _damping: float
    _surface: float
    _density: float
    _volume: float
    _length: float
    _width: float
    _height: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        body = self.robot_parent.bge_object
        low, high = _bounds(body)
        self._hull: tuple[tuple[float, ...], Hull] | None = None
        self._values = WaterValues()
        self._push = pusher(self._values)
        self._centre = tuple((a + b) / 2.0 for a, b in zip(low, high, strict=True))
        self._measured = tuple(b - a for a, b in zip(low, high, strict=True))
        water = self.context.scene.find("Water")
        random = self.context.random("waves")
        self._sea = Sea.of(self.context.scene.properties, self.context.scene.settings.gravity, random)
        self._water = None if water is None else float(water.world_matrix().translation[2])

    def surface(self) -> float:
        """Height of the surface, m; infinite for water everywhere."""
        return self._surface if math.isfinite(self._surface) or self._water is None else self._water

    def hull(self) -> Hull:
        """The box, and its drag coefficients."""
        sizes = (self._length, self._width, self._height, self._density)
        if self._hull is not None and self._hull[0] == sizes:
            return self._hull[1]
        x, y, z = (max(own or model, _THINNEST) for own, model in zip(sizes[:3], self._measured, strict=True))
        areas = (y * z, x * z, x * y)
        drag = tuple(0.5 * self._density * c * area for c, area in zip(_COEFFICIENTS, areas, strict=True))
        hull = Hull(self._centre, (x, y, z), drag)  # type: ignore[arg-type]
        self._hull = sizes, hull
        for cell, middle in zip(self._values.cells, hull.cells, strict=True):
            cell[:] = middle
        self._values.centre[:], self._values.drag[:] = hull.centre, hull.drag
        return hull

    def default_action(self) -> None:
        """Apply buoyancy, drag and current."""
        robot = self.robot_parent
        body, hull, surface = robot.bge_object, self.hull(), self.surface()
        g = self.context.scene.settings.gravity
        mass = body.mass
        water_mass = self._density * self._volume if self._volume else mass
        (_, _, height), turn = body.world_pose()
        linear, angular = body.velocity()
        # all vectors are in the frame of the body
        up = turn[6:9]
        values = self._values
        values.depth, values.half = surface - height, hull.size[2] / 2.0
        # drag reduces the speed by at most half in a tick
        values.lift, values.most = water_mass * g / 8.0, 0.5 * mass * self.frequency
        (vx, vy, vz), (cx, cy, cz) = linear, self.local_data["current"]
        values.up[:] = up
        values.linear[:] = turn_back(turn, (vx - cx, vy - cy, vz - cz))
        values.angular[:] = turn_back(turn, angular)
        self._move_water(water_mass, mass)
        if self._sea is not None:
            self._swell(self._sea)
        self._push()
        (fx, fy, fz), torque = values.force, values.torque
        if robot._no_gravity:
            weight = mass * g
            fx, fy, fz = fx - weight * up[0], fy - weight * up[1], fz - weight * up[2]
        body.wrench(_limited((fx, fy, fz)), _limited(torque), True)

    def _swell(self, sea: Sea) -> None:
        """Set the height and the speed of the surface at each column of two cells."""
        values, time = self._values, self.clock.time
        (x, y, _), turn = self.robot_parent.bge_object.world_pose()
        cells = self.hull().cells
        for column in range(4):
            (a, b, c), (_, _, d) = cells[2 * column], cells[2 * column + 1]
            east, north, _ = turned(turn, (a, b, (c + d) / 2.0))
            values.swell[column], values.rise[column] = sea.at(x + east, y + north, time)

    def _move_water(self, water_mass: float, mass: float) -> None:
        """Set the added mass, and the damping of a cell at the surface.

        Args:
            water_mass: mass of the water that the submerged box displaces, kg.
        """
        values, hull = self._values, self.hull()
        up, (cx, cy, cz), height = values.up, hull.centre, hull.size[2]
        # of the box, from the depth of its centre
        depth = values.depth - up[0] * cx - up[1] * cy - up[2] * cz
        share = min(max(depth / height + 0.5, 0.0), 1.0)
        x, y, z = (self._added * water_mass * part for part in hull.added)
        x, y, z = x * share, y * share, z * (0.5 if 0.0 < share < 1.0 else share)
        a, b, c = (part / 4.0 for part in hull.size)
        self.robot_parent.bge_object.set_added_mass(
            (x, y, z), (y * c * c + z * b * b, x * c * c + z * a * a, x * b * b + y * a * a)
        )
        # a quarter of the box stands on the water: stiffness lift / half
        critical = 2.0 * math.sqrt(values.lift / values.half * (mass + z) / 4.0)
        values.bob = min(self._damping * _HEAVE * critical, 0.1 * mass * self.frequency)


def _limited(parts: Iterable[float]) -> list[float]:
    return [min(max(part, -_MOST), _MOST) for part in parts]


def _bounds(body: Body) -> tuple[list[float], list[float]]:
    """Lower and upper corner of the colliding parts, or of all parts if none collides, in the frame of the body, m."""
    parts = list(body.node.walk())
    extents = extent([part for part in parts if part.body.collides], body.node) or extent(parts, body.node)
    return ([0.0] * 3, [0.0] * 3) if extents is None else (extents[0].tolist(), extents[1].tolist())
