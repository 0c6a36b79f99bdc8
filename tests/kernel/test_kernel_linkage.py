"""Linkages: the C function equals its twin in Python, to the bit, and both say what geometry says."""

import math

import numpy as np
import pytest

from morse.kernel.linkage import FIXED, PRISMATIC, REVOLUTE, LinkageArrays, NativeLinkage
from tests.kernel.twins import linkage


def rotations(chance, count):
    turned, _ = np.linalg.qr(chance.normal(size=(count, 3, 3)))
    return (turned * np.linalg.det(turned)[:, None, None]).reshape(count, 9)


def poses(chance, count):
    return np.hstack([chance.uniform(-1, 1, (count, 3)), rotations(chance, count)])


def tree(chance, count):
    """Each hangs on an earlier one, or on nothing."""
    return np.array([chance.integers(-1, i) if i else -1 for i in range(count)], dtype=np.int64)


def some_linkage(seed):
    chance = np.random.default_rng(seed)
    bones, objects, shapes, geoms = (int(n) for n in chance.integers((1, 0, 0, 1), (8, 9, 7, 12)))
    shapes = shapes if objects else 0
    arrays = LinkageArrays(
        parents=tree(chance, bones),
        kinds=chance.choice([FIXED, REVOLUTE, PRISMATIC], bones).astype(np.int64),
        axes=chance.integers(0, 3, bones),
        places=chance.uniform(-1, 1, (bones, 3)), turns=rotations(chance, bones),
        outers=tree(chance, objects), hooks=chance.integers(-1, bones, objects), held=poses(chance, objects),
        geoms=chance.integers(0, geoms, shapes), owners=chance.integers(0, max(objects, 1), shapes),
        mounts=poses(chance, shapes),
        geom_positions=chance.normal(size=(geoms, 3)), geom_quaternions=np.zeros((geoms, 4)),
        geom_radii=chance.uniform(0, 1, geoms), geom_boxes=chance.uniform(0, 1, (geoms, 6)),
        all_geoms=np.arange(geoms), base=poses(chance, 1)[0], up=rotations(chance, 1)[0, 6:],
    )  # fmt: skip
    if objects and chance.random() < 0.3:
        # what is where the body is, but for rounding
        arrays.hooks[0], arrays.outers[0] = -1, -1
        arrays.base[:] = arrays.held[0] = [1e-16, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]
    angles = chance.uniform(-4, 4, bones)
    arrays.moves[:] = np.where(
        (arrays.kinds == PRISMATIC)[:, None], np.c_[angles, 0 * angles], np.c_[np.cos(angles), np.sin(angles)]
    )
    return arrays


def test_both_give_the_same_bits(build):
    for seed in range(150):
        mine, theirs = some_linkage(seed), some_linkage(seed)
        assert NativeLinkage(build, mine).move() == linkage.Linkage(theirs).move()
        for name in ("frames", "locals", "poses", "geom_positions", "geom_quaternions"):
            assert getattr(mine, name).tobytes() == getattr(theirs, name).tobytes(), (seed, name)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_shapes_are_where_matrices_put_them(axis):
    arrays = some_linkage(3)
    chance = np.random.default_rng(5)
    arrays = LinkageArrays(**{
        **{name: getattr(arrays, name) for name in ("geom_quaternions", "geom_boxes", "all_geoms", "up")},
        "geom_positions": arrays.geom_positions, "geom_radii": arrays.geom_radii,
        "parents": np.array([-1, 0]), "kinds": np.array([REVOLUTE, PRISMATIC]), "axes": np.array([axis, 1]),
        "places": chance.normal(size=(2, 3)), "turns": rotations(chance, 2),
        "outers": np.array([-1, 0]), "hooks": np.array([1, -1]), "held": poses(chance, 2),
        "geoms": np.array([0]), "owners": np.array([1]), "mounts": poses(chance, 1), "base": poses(chance, 1)[0],
    })  # fmt: skip
    angle, shift = 0.7, -0.3
    arrays.moves[:] = (math.cos(angle), math.sin(angle)), (shift, 0.0)
    reach, lowest = linkage.Linkage(arrays).move()

    def matrix(pose):
        result = np.eye(4)
        result[:3, 3], result[:3, :3] = pose[:3], np.reshape(pose[3:], (3, 3))
        return result

    turn, slide, (c, s) = np.eye(4), np.eye(4), (math.cos(angle), math.sin(angle))
    one, other = (axis + 1) % 3, (axis + 2) % 3
    turn[one, one], turn[one, other], turn[other, one], turn[other, other] = c, -s, s, c
    slide[1, 3] = shift
    bones = [matrix([*arrays.places[i], *arrays.turns[i]]) for i in (0, 1)]
    frame = bones[0] @ turn @ bones[1] @ slide
    placed = matrix(arrays.base) @ frame @ matrix(arrays.held[0]) @ matrix(arrays.held[1]) @ matrix(arrays.mounts[0])
    assert arrays.geom_positions[0] == pytest.approx(placed[:3, 3])
    w, x, y, z = arrays.geom_quaternions[0]
    assert [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)] == pytest.approx(placed[:3, 0])
    far = np.linalg.norm(arrays.geom_positions, axis=1) + arrays.geom_radii
    assert reach == pytest.approx(far.max())
    centre, half = arrays.geom_boxes[0, :3], arrays.geom_boxes[0, 3:]
    signs = np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
    corners = (centre + signs * half) @ placed[:3, :3].T + placed[:3, 3]
    assert lowest == pytest.approx((corners @ arrays.up).min())
