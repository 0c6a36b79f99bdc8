"""The lamps and the sky of a scene, as the live view shows them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.kernel.drawing.arrays import HEMISPHERE, LAMP, POINT, SPOT, SUN
from morse.mathutils.portable import norm
from morse.rendering.textures import LINEAR

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from morse.physics import World
    from morse.scene import Node, Scene, ViewSettings

#: scale for which a white surface, lit perpendicularly by a lamp of energy 1, has full brightness
_FULL = math.pi
#: factor of the falloff, fitted to lamps whose intensity is half at their distance
_DECAY = 0.3
#: half of the opening angle of an area lamp, rad
_AREA = 1.5
#: direction to the sun in a scene without lamps
_TOWARDS_SUN = (0.45, -0.55, 0.75)
#: maximum number of lamps; the strongest ones are used, as in the live view
_MOST_LAMPS = 8
#: half of the opening angle of a spot, rad, up to which it casts shadows
_WIDEST_SHADOW = 1.05


def _srgb(code: int) -> NDArray[np.float64]:
    return np.asarray(LINEAR[[(code >> shift) & 255 for shift in (16, 8, 0)]], dtype=np.float64)


class Lamps(NamedTuple):
    """The lamps of a scene.

    Attributes:
        lamps: (L,) `LAMP`.
        sunny: (3,) unit vector to the sun that casts shadows.
        spot: the spot lamp that casts shadows, the strongest one; None if there is none.
    """

    lamps: NDArray[np.void]
    sunny: NDArray[np.float64]
    spot: Spot | None


class Spot(NamedTuple):
    """A spot lamp.

    Attributes:
        position: (3,) m, frame of the world.
        rotation: (9,) row by row; it shines along its -Z axis.
        angle: half of the opening angle, rad.
    """

    position: tuple[float, ...]
    rotation: tuple[float, ...]
    angle: float


def light_nodes(scene: Scene) -> list[Node]:
    """The nodes of all lamps."""
    return [node for node in scene.nodes() if node.light is not None]


def lamps_of(all_nodes: Sequence[Node], world: World) -> Lamps:
    """The lamps of a world at their present poses."""
    view = world.scene.settings.view
    nodes = [node for node in all_nodes if world.object_of(node).visible]
    suns = [node for node in nodes if node.light is not None and node.light.type == "SUN"]
    mixed = bool(suns) and len(suns) < len(nodes)
    rows: list[tuple[object, ...]] = []
    sunny, spot = None, None
    for node in _strongest_first(nodes, world, view)[:_MOST_LAMPS]:
        light = node.light
        assert light is not None
        position, rotation = world.object_of(node).world_pose()
        towards, color = np.array(rotation[2::3]), np.array(light.color)
        if light.type == "SUN" and sunny is None:
            sunny = towards
            strength = _FULL * light.energy * 0.85 * (1.5 if mixed else 1.0) * view.daylight
            rows.append(_lamp(SUN, (0, 0, 0), towards, color * strength, shape=(1.0, 0.0)))
        elif light.type == "SUN":
            rows.append(_lamp(SUN, (0, 0, 0), towards, color * _FULL * light.energy * view.daylight))
        elif light.type == "HEMI":
            half = _FULL * light.energy * 0.5 * view.daylight
            rows.append(_lamp(HEMISPHERE, (0, 0, 0), towards, color * half, ground=np.full(3, 0.051 * half)))
        else:
            share = 0.5 * (0.7 if mixed else 1.0) * max(light.distance, 0.0) ** _DECAY
            is_area = light.type == "AREA"
            angle, edge = (_AREA, 1.0) if is_area else (min(max(light.spot_size / 2, 1e-3), 1.5), 0.3)
            kind = SPOT if is_area or light.type == "SPOT" else POINT
            shape = (math.cos(angle), math.cos(angle * (1 - edge)))
            casts = light.type == "SPOT" and light.casts_shadow and angle <= _WIDEST_SHADOW and spot is None
            if casts:
                spot = Spot(tuple(position), tuple(rotation), angle)
            strength = _FULL * light.energy * share
            rows.append(_lamp(kind, position, towards, color * strength, shape=shape, ground=(float(casts), 0.0, 0.0)))
    if sunny is None:
        sunny = np.array(_TOWARDS_SUN) / norm(_TOWARDS_SUN)
        # with lamps in the scene, the sun is faint
        strength = _FULL * (0.35 if nodes else 0.95) * 0.85 * view.daylight
        rows.append(_lamp(SUN, (0, 0, 0), sunny, _srgb(0xFFF3E2) * strength, shape=(1.0, 0.0)))
    rows.append(_sky_light(view, bool(nodes), mixed))
    lamps = np.array(rows, dtype=LAMP)
    for name in LAMP.names or ():
        lamps[name] = np.nan_to_num(lamps[name], nan=0.0, posinf=1e6, neginf=-1e6)
    return Lamps(lamps, sunny, spot)


def _sky_light(view: ViewSettings, lit: bool, mixed: bool) -> tuple[object, ...]:
    above, below = _srgb(0xDFEEFF), _srgb(0xB9AEA0)
    if view.ambient_color:
        above = (above + np.array(view.ambient_color)) / 2
    strength = _FULL * (0.5 if lit else 0.62) * (0.65 if mixed else 1.0) * view.daylight
    return _lamp(HEMISPHERE, (0, 0, 0), (0, 0, 1), above * strength, ground=below * strength)


def sky_of(view: ViewSettings, sunny: NDArray[np.float64]) -> NDArray[np.float32]:
    """(20,) float32, see `morse.kernel.drawing.Light`."""
    horizon, zenith, nadir, glow = _srgb(0xF4F8FB), _srgb(0x6EA6DE), _srgb(0xC3CAD0), _srgb(0xFFF1D6)
    if view.horizon_color:
        horizon = np.array(view.horizon_color, dtype=np.float64)
        zenith, nadir, glow = horizon * 0.55, horizon * 0.7, glow * 0.3
    horizon, zenith, nadir, glow = (colour * view.daylight for colour in (horizon, zenith, nadir, glow))
    mist = (0.0, 0.0)
    if view.mist is not None and view.mist.enabled:
        mist = (view.mist.start, max(view.mist.depth, 1e-3))
    return np.concatenate([horizon, zenith, nadir, glow, sunny, mist, np.zeros(3)]).astype(np.float32)


def _strongest_first(nodes: Sequence[Node], world: World, view: ViewSettings) -> list[Node]:
    """Sort lamps by their light at the initial viewpoint, as in the live view."""

    def given(node: Node) -> float:
        light = node.light
        assert light is not None
        if light.type in ("SUN", "HEMI"):
            return light.energy
        apart = math.dist(world.object_of(node).world_pose()[0], view.camera_location)
        return light.energy / (1 + apart**2 / max(light.distance, 0.01) ** 2)

    return sorted(nodes, key=lambda node: -given(node))


def _lamp(
    kind: int,
    place: ArrayLike,
    towards: ArrayLike,
    color: ArrayLike,
    shape: tuple[float, float] = (0.0, 0.0),
    ground: ArrayLike = (0.0, 0.0, 0.0),
) -> tuple[object, ...]:
    """A row of `LAMP`; for a sun, ``shape`` is whether it casts shadows, for a spot, the range of its edge."""
    return (
        kind,
        tuple(np.asarray(place)),
        tuple(np.asarray(towards)),
        tuple(np.asarray(color)),
        _DECAY,
        *shape,
        tuple(np.asarray(ground)),
    )
