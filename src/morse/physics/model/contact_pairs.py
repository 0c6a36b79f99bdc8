"""Pairs of shapes that collide although the engine ignores their contacts otherwise."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.physics.model.collision_bits import ALL_BITS, OF_FILE

if TYPE_CHECKING:
    import mujoco


#: smallest weight of contact parameters that counts
_LEAST = 1e-15


def add_pair(spec: mujoco.MjSpec, one: mujoco.MjsGeom, other: mujoco.MjsGeom) -> None:
    """Add a pair of geoms to a `mujoco.MjSpec`, with the parameters that a contact of these geoms has.

    The rules are those of the section "Contact parameters" of MuJoCo's documentation; the engine does not apply them to
    pairs.
    """
    pair = spec.add_pair(geomname1=one.name, geomname2=other.name)
    pair.margin, pair.gap = one.margin + other.margin, one.gap + other.gap
    if one.priority != other.priority:
        source = max(one, other, key=lambda geom: geom.priority)
        pair.condim, pair.solref, pair.solimp = source.condim, source.solref, source.solimp
        friction = np.array(source.friction)
    else:
        pair.condim = max(one.condim, other.condim)
        share = _share(float(one.solmix), float(other.solmix))
        stiffness, others = np.array(one.solref), np.array(other.solref)
        mixes = stiffness[0] > 0.0 and others[0] > 0.0
        pair.solref = share * stiffness + (1.0 - share) * others if mixes else np.minimum(stiffness, others)
        pair.solimp = share * np.array(one.solimp) + (1.0 - share) * np.array(other.solimp)
        friction = np.maximum(one.friction, other.friction)
    slide, torsion, roll = friction
    pair.friction = [slide, slide, torsion, roll, roll]


def touch_floors(spec: mujoco.MjSpec, floors: set[str]) -> None:
    """Let the shapes that an MJCF file pairs with floors touch the objects of a scene as they would touch these.

    The floors are not part of the scene. The objects of the scene touch any shape with the bits of a file, those of the
    same file only touch the shape if it has others as well.
    """
    first = 1 + max((geom.priority for geom in spec.geoms), default=0)
    for pair in spec.pairs:
        names = {pair.geomname1, pair.geomname2}
        if len(names & floors) != 1:
            continue
        geom = spec.geom((names - floors).pop())
        if geom is None:
            continue
        geom.priority, geom.condim, geom.margin, geom.gap = first, pair.condim, pair.margin, pair.gap
        geom.solref, geom.solimp = pair.solref, pair.solimp
        geom.friction = [pair.friction[0], pair.friction[2], pair.friction[3]]
        if not geom.contype and not geom.conaffinity:
            geom.contype, geom.conaffinity = OF_FILE, ALL_BITS


def _share(one: float, other: float) -> float:
    """The weight of the first geom."""
    if one >= _LEAST and other >= _LEAST:
        return one / (one + other)
    return 0.5 if max(one, other) < _LEAST else float(one >= _LEAST)
