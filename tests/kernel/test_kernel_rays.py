"""Rays of the C functions and of numpy are bit-identical, with any build and any number of threads."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from kernel_worlds import random_world, rotations, soup

from morse.kernel import rays as native
from morse.kernel import threads
from morse.kernel.rays import BOX, MESH, Fan, NativeRays, Poses, SolidArrays, TriangleMesh
from tests.kernel.twins.rays import ReferenceRays
from tests.kit.effort import examples

some = settings(max_examples=examples(60), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
NUMBERS = [np.nan, np.inf, -np.inf, 1e308, -1e300, 1e40, 1e-320, 0.0, -0.0]


def same(one, other):
    return all((np.asarray(a) == np.asarray(b)).all() for a, b in zip(one, other, strict=True))


@some
@given(
    seed=st.integers(0, 10**6),
    count=st.integers(0, 60),
    away=st.sampled_from([0.0, 1e3, 5e6]),
    limit=st.sampled_from([3.0, 9.0, 1e30]),
    origins=st.booleans(),
    upright=st.booleans(),
)
def test_random_worlds(build, seed, count, away, limit, origins, upright):
    made = random_world(seed, count, away=away)
    fan = made.fan(limit=limit, origins=origins, upright=upright)
    one, other = NativeRays(build, made.solids), ReferenceRays(made.solids)
    assert same(made.cast(one, fan), made.cast(other, fan))
    assert same((one.positions, one.rotations), (other.positions, other.rotations))


def test_random_worlds_are_no_empty_ones(build):
    shares = []
    for seed in range(10):
        made = random_world(seed)
        shares.append(np.isfinite(made.cast(NativeRays(build, made.solids), made.fan()).distances).mean())
    assert 0.2 < np.mean(shares) < 0.98


@pytest.mark.parametrize("count", [300, 3000])
def test_many_solids(build, count):
    made = random_world(7, count, slots=50, spread=20.0, largest=12)
    fan = made.fan(sensors=3, rays=100)
    assert same(made.cast(NativeRays(build, made.solids), fan), made.cast(ReferenceRays(made.solids), fan))


def test_a_large_mesh(build):
    rng = np.random.default_rng(3)
    made = random_world(3, 1)
    made.solids.kinds[:] = MESH
    made.solids.meshes[:] = [soup(rng, 20_000)]
    made.solids.halves[:] = 6.0
    fan = made.fan(sensors=2, rays=60)
    hits = made.cast(NativeRays(build, made.solids), fan)
    assert same(hits, made.cast(ReferenceRays(made.solids), fan))
    assert (hits.faces >= 0).any()


def test_moving_on_is_the_same_as_being_there(build):
    made, there = random_world(5, 30), random_world(5, 30)
    moved = there.poses.positions + np.array([1.0, -2.0, 0.5])
    there.poses = Poses(moved, there.poses.rotations, there.poses.anchor)
    caster, fan = NativeRays(build, made.solids), made.fan()
    made.moving[:] = there.moving[:] = True
    made.cast(caster, fan)
    caster.place(there.poses, moving=True)
    assert same(caster.cast(fan, there.poses, made.groups), there.cast(NativeRays(build, there.solids), fan))


@pytest.mark.parametrize("workers", [2, 3, 7])
def test_threads_change_nothing(build, monkeypatch, workers):
    made = random_world(11, 40)
    fan = made.fan(sensors=5, rays=121)
    alone = made.cast(NativeRays(build, made.solids), fan)
    monkeypatch.setattr(threads, "count", lambda: workers)
    monkeypatch.setattr(native, "_RAYS_A_THREAD", 50)
    for _ in range(5):
        assert same(made.cast(NativeRays(build, made.solids), fan), alone)


def test_of_surfaces_at_the_same_distance_the_first_counts(build):
    """Duplicate solids, and a mesh with duplicate triangles: the order of a tree does not matter."""
    vertices = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    faces = np.array([[0, 1, 2], [0, 2, 3]] * 40, dtype=np.int32)
    mesh, count = TriangleMesh(vertices, faces), 30
    places = np.zeros((count, 3))
    solids = SolidArrays(
        np.full(count, MESH),
        np.ones((count, 3)),
        np.zeros(count, dtype=int),
        places,
        np.tile(np.eye(3), (count, 1, 1)),
        np.zeros((count, 3)),
        np.tile([1.0, 1.0, 0.0], (count, 1)),
        [mesh] * count,
    )
    fan = Fan([0], np.array([[0.3, -0.2, 2.0]]), np.eye(3)[None], np.array([[0.0, 0, -1]]), None, False, 9.0, [9])
    poses = Poses(np.zeros((1, 3)), np.eye(3)[None], np.zeros(3))
    for caster in (NativeRays(build, solids), ReferenceRays(solids)):
        caster.gather(np.arange(count)[::-1], moving=False)
        caster.gather(np.arange(0), moving=True)
        caster.place(poses, moving=False)
        caster.place(poses, moving=True)
        hits = caster.cast(fan, poses, np.zeros(count, dtype=np.int64))
        assert (hits.distances.item(), hits.solids.item(), hits.faces.item()) == (2.0, 0, 0)


def test_no_ray_slips_through_an_edge(build):
    """Rays exactly at the vertices and edges of a closed surface, from inside."""
    t = (1 + 5**0.5) / 2
    vertices = np.array([(0, a, b * t) for a in (-1, 1) for b in (-1, 1)])
    vertices = np.concatenate([np.roll(vertices, shift, axis=1) for shift in range(3)])
    near = np.linalg.norm(vertices[:, None] - vertices, axis=2) < 2.01
    faces = [
        (i, j, k) for i in range(12) for j in range(i) for k in range(j) if near[i, j] and near[j, k] and near[i, k]
    ]
    assert len(faces) == 20  # an icosahedron
    rng = np.random.default_rng(0)
    turn = rotations(rng, 1)
    solids = SolidArrays(
        [MESH],
        np.ones((1, 3)),
        [0],
        np.zeros((1, 3)),
        turn,
        np.zeros((1, 3)),
        np.full((1, 3), t),
        [TriangleMesh(vertices, np.array(faces, dtype=np.int32))],
    )
    world = vertices @ turn[0].T
    corners = world[np.array(faces)]
    shares = rng.random((20, 200, 1))
    edges = (corners[:, None, 0] * shares + corners[:, None, 1] * (1 - shares)).reshape(-1, 3)
    origins = np.zeros((len(world) + len(edges), 3))
    ways = np.concatenate([world, edges])
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    fan = Fan([0], np.zeros((1, 3)), np.eye(3)[None], ways, origins, False, 9.0, [9])
    poses = Poses(np.zeros((1, 3)), np.eye(3)[None], np.zeros(3))
    caster = NativeRays(build, solids)
    caster.gather(np.arange(0), moving=False)
    caster.gather(np.arange(1), moving=True)
    caster.place(poses, moving=False)
    caster.place(poses, moving=True)
    assert np.isfinite(caster.cast(fan, poses, np.zeros(1, dtype=np.int64)).distances).all()


# -- invalid input ---------------------------------------------------------------------------


@some
@given(
    seed=st.integers(0, 10**6),
    where=st.sampled_from(["positions", "rotations", "directions", "offsets", "places", "sizes", "halves", "vertices"]),
    number=st.sampled_from(NUMBERS),
)
def test_numbers_that_make_no_sense(build, seed, where, number):
    """No crash, no hang, no NaN; and unaffected rays give the usual results."""
    made = random_world(seed, 12)
    fan = made.fan()
    arrays = {
        "positions": made.poses.positions,
        "rotations": made.poses.rotations,
        "directions": fan.directions,
        "offsets": fan.offsets,
        "places": made.solids.places,
        "sizes": made.solids.sizes,
        "halves": made.solids.halves,
        "vertices": next((mesh.vertices for mesh in made.solids.meshes if mesh), np.zeros(3)),
    }
    before = made.cast(NativeRays(build, made.solids), fan)
    native._trees.clear()
    chosen = arrays[where].reshape(-1)
    chosen[made.rng.integers(len(chosen))] = number
    after = made.cast(NativeRays(build, made.solids), fan)
    native._trees.clear()
    assert not np.isnan(after.distances).any()
    assert ((after.solids >= 0) == np.isfinite(after.distances)).all()
    if where == "directions":
        untouched = np.isfinite(fan.directions).all(axis=1)
        untouched &= np.abs(np.linalg.norm(np.clip(fan.directions, -9, 9), axis=1) - 1.0) < 1e-9
        assert (after.distances[:, untouched] == before.distances[:, untouched]).all()


def test_solids_and_sensors_that_are_nowhere(build):
    made = random_world(1, 25)
    made.poses.positions[0] = np.nan
    fan = made.fan(sensors=10)
    hits = made.cast(NativeRays(build, made.solids), fan)
    assert same(hits, made.cast(ReferenceRays(made.solids), fan))
    assert (hits.solids[fan.slots == 0] == -1).all()
    assert not np.isin(hits.solids, np.flatnonzero(made.solids.slots == 0)).any()


@pytest.mark.parametrize(("solids", "sensors", "rays"), [(0, 1, 1), (5, 0, 7), (5, 3, 0), (0, 0, 0), (1, 1, 1)])
def test_empty_arrays(build, solids, sensors, rays):
    made = random_world(2, solids)
    fan = made.fan(sensors=sensors, rays=rays)
    hits = made.cast(NativeRays(build, made.solids), fan)
    assert hits.distances.shape == (sensors, rays)
    assert same(hits, made.cast(ReferenceRays(made.solids), fan))


def test_many_boxes_at_one_place(build):
    """A tree cannot separate them."""
    made = random_world(4, 2000, slots=1)
    made.solids.kinds[:], made.solids.centres[:] = BOX, 0.0
    made.solids.places[:] = 1.0
    made.solids.sizes[:] = made.solids.halves[:] = 0.5
    fan = made.fan(sensors=1, rays=20)
    assert same(made.cast(NativeRays(build, made.solids), fan), made.cast(ReferenceRays(made.solids), fan))


def test_boxes_whose_sizes_grow_without_bounds(build):
    """The deepest possible tree: each split separates one box from all others."""
    made = random_world(4, 400, slots=1)
    made.solids.kinds[:], made.solids.centres[:] = BOX, 0.0
    scale = 1.3 ** np.arange(400)
    made.solids.places[:] = scale[:, None] * [1.0, 0.0, 0.0]
    made.solids.sizes[:] = made.solids.halves[:] = scale[:, None] * 0.01
    fan = made.fan(sensors=1, rays=20)
    assert same(made.cast(NativeRays(build, made.solids), fan), made.cast(ReferenceRays(made.solids), fan))


@pytest.mark.parametrize(
    "change",
    [{"offsets": np.zeros((2, 3))}, {"turns": np.eye(3)}, {"directions": np.zeros((4, 2))}, {"owners": [1, 2]}],
)
def test_arrays_of_another_shape_are_refused(change):
    right = {
        "slots": [0],
        "offsets": np.zeros((1, 3)),
        "turns": np.eye(3)[None],
        "directions": np.ones((4, 3)),
        "origins": None,
        "upright": False,
        "limit": 1.0,
        "owners": [0],
    }
    Fan(**right)
    with pytest.raises(ValueError, match=r"shape|owners"):
        Fan(**{**right, **change})
