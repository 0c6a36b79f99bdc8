"""The closed parts of meshes: those of the C function are those of numpy."""

import math
from ctypes import byref

import numpy as np
import pytest

from morse.assets import solids
from morse.kernel.drawing import meshes
from morse.kernel.drawing import meshes as drawing_meshes
from morse.kernel.drawing.meshes import Simplification
from morse.kernel.linkage import FIXED, PRISMATIC, REVOLUTE, LinkageArrays, NativeLinkage
from morse.kernel.water import WaterValues
from tests.kernel.twins import closed, linkage, simplify, water


def some_mesh(seed):
    """Boxes and balls, moved, stretched and turned; some with a hole, a face inside out, or a dent."""
    rng = np.random.default_rng(seed)
    points, faces, first = [], [], 0
    for _ in range(12):
        shape = [solids.cube, lambda: solids.ico_sphere(1)][rng.integers(2)]()
        place = np.asarray(shape.vertices, float).reshape(-1, 3) @ rng.normal(size=(3, 3)) + rng.normal(size=3) * 5
        face = np.asarray(shape.triangles).reshape(-1, 3).copy()
        fault = rng.integers(5)
        if fault == 0:
            face = face[1:]
        elif fault == 1:
            face[0] = face[0, ::-1]
        elif fault == 2:
            place[0] = place.mean(axis=0)
        points.append(place), faces.append(face + first)
        first += len(place)
    faces = np.concatenate(faces)
    order = rng.permutation(len(faces))
    # some triangles twice, and some without an area
    faces[order[:2]] = faces[order[2:4]]
    faces[order[4], 1] = faces[order[4], 0]
    return np.concatenate(points).astype(np.float32), faces[order].astype(np.int32)


@pytest.mark.parametrize("seed", range(20))
def test_random_meshes_alike(build, seed):
    mesh = some_mesh(seed)
    labels = meshes.closed_labels(*mesh, build)
    np.testing.assert_array_equal(labels, closed.closed_labels(*mesh))


def test_random_meshes_have_parts_of_both_kinds(build):
    shares = [(meshes.closed_labels(*some_mesh(seed), build) >= 0).mean() for seed in range(20)]
    assert 0.05 < np.mean(shares) < 0.8


# -- simplified meshes: those of the C function are those of Python, to the bit --------------------


def kernel_simplify_some_mesh(seed):
    """A stretched ball of two materials; smooth or flat, dented, with a hole, or with vertices that became one."""
    rng = np.random.default_rng(seed)
    ball = solids.ico_sphere(2)
    index = np.asarray(ball.triangles, np.int32).reshape(-1, 3)
    points = np.asarray(ball.vertices, float).reshape(-1, 3) @ rng.normal(size=(3, 3))
    points += rng.normal(size=points.shape) * rng.choice([0.0, 0.01, 0.05])
    index = index[rng.permutation(len(index))]
    if rng.integers(2):
        index = index[3:]
    if rng.integers(2):
        # two vertices become one
        index[index == index[0, 0]] = index[5, 1]
    corners = points[index]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-30)[:, None]
    smooth = points / np.linalg.norm(points, axis=1)[:, None]
    textured = bool(rng.integers(2))
    uv = points[:, :2] if textured else np.zeros((len(points), 2))
    slots = (corners.mean(axis=1)[:, 0] > 0.3).astype(np.int32)
    rows = np.concatenate(
        [smooth[index] if rng.integers(2) else np.repeat(normal[:, None], 3, axis=1), uv[index]], axis=2
    )
    keyed = np.column_stack([rows.reshape(-1, 5), np.repeat(slots, 3)])
    looks, look = np.unique(keyed, axis=0, return_inverse=True)
    alive = (index != np.roll(index, 1, axis=1)).all(axis=1)
    return Simplification(
        points, np.ascontiguousarray(looks[:, :5]), looks[:, 5].astype(np.int32), index,
        look.reshape(-1, 3).astype(np.int32), np.zeros(len(index)), alive.astype(np.uint8), textured,
    )  # fmt: skip


def copied(mesh):
    return mesh._replace(**{name: getattr(mesh, name).copy() for name in ("vertices", "look", "errors", "alive")})


@pytest.mark.parametrize("seed", range(6))
def test_random_meshes_alike_kernel_simplify(build, seed):
    mine = kernel_simplify_some_mesh(seed)
    its = copied(mine)
    for limit in (0.03, 0.2):
        left = drawing_meshes.simplify(its, limit, build)
        assert left == simplify.simplify(mine, limit) == its.alive.sum()
        chosen = its.alive > 0
        np.testing.assert_array_equal(its.alive, mine.alive)
        for name in ("vertices", "look", "errors"):
            np.testing.assert_array_equal(getattr(its, name)[chosen], getattr(mine, name)[chosen])


def test_random_meshes_become_simpler(build):
    meshes = [kernel_simplify_some_mesh(seed) for seed in range(6)]
    left = [drawing_meshes.simplify(mesh, 0.2, build) for mesh in meshes]
    assert sum(left) < 0.7 * sum(len(mesh.alive) for mesh in meshes)


# -- water: the C function equals its twin in Python, to the bit -----------------------------------


def some_water(seed, **given):
    chance = np.random.default_rng(seed)
    values = WaterValues(
        depth=chance.uniform(-2, 2), half=chance.uniform(0.1, 1), lift=chance.uniform(0, 100), most=chance.uniform(0, 9)
    )
    values.bob = (seed % 2) * 7.3
    if seed % 3 == 0:
        values.swell[:], values.rise[:] = chance.normal(size=4), chance.normal(size=4)
    for name in ("centre", "drag", "up", "linear", "angular"):
        getattr(values, name)[:] = chance.normal(size=3)
    for cell in values.cells:
        cell[:] = chance.normal(size=3)
    for name, value in given.items():
        setattr(values, name, value)
    return values


def results(values):
    return [*values.force, *values.torque]


def test_both_give_the_same_bits(build):
    for seed in range(200):
        mine, theirs = some_water(seed), some_water(seed)
        build.morse_water(byref(mine))
        water.push(theirs)
        assert results(mine) == results(theirs)


def test_a_submerged_box_is_lifted_by_all_its_cells_and_slowed_by_the_square_of_its_speed():
    values = some_water(1, depth=100.0, half=0.5, lift=10.0, most=math.inf)
    values.up[:], values.angular[:], values.drag[:], values.linear[:] = (0, 0, 1), (0, 0, 0), (2, 3, 4), (3, -1, 0)
    water.push(values)
    assert list(values.force) == [-2.0 * 3.0**2, 3.0 * 1.0**2, 8 * 10.0]


# -- linkages: the C function equals its twin in Python, to the bit, and both say what geometry says


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


def test_both_give_the_same_bits_kernel_linkage(build):
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
