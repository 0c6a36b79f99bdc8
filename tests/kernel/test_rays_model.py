"""Rays at the geoms of many worlds are those of the closed formulas, each ray with each solid, with any build."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from kernel_worlds import half_sizes, rotations, soup

from morse.kernel.rays import MESH, PLANE, GeomPoses, ModelTargets
from tests.kernel.twins.primitives import first_surface
from tests.kernel.twins.triangles import ReferenceMesh
from tests.kit.effort import examples

some = settings(max_examples=examples(40), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


class Worlds:
    """Solids of all kinds, planes too, at random poses in two worlds."""

    def __init__(self, seed, count, away):
        self.rng = rng = np.random.default_rng(seed)
        self.kinds = rng.integers(0, PLANE + 1, count)
        self.sizes = rng.uniform(0.1, 2.0, (count, 3))
        self.sizes[(self.kinds == PLANE) & (rng.random(count) < 0.5)] = 0.0
        self.meshes = [soup(rng, int(rng.integers(1, 40))) if kind == MESH else None for kind in self.kinds]
        self.bodies = rng.integers(0, 5, count)
        self.positions = rng.normal(size=(2, count, 3)) * 4 + away
        self.turns = np.stack([rotations(rng, count).reshape(count, 9) for _ in range(2)])
        self.anchor = np.full(3, np.round(away))

    def targets(self, build):
        boxes = [mesh and (mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)) for mesh in self.meshes]
        rows = list(zip(self.kinds, self.sizes, boxes, strict=True))
        count = len(rows)
        centres = [np.zeros(3) if box is None else (box[0] + box[1]) / 2 for _, _, box in rows]
        halves = [half_sizes(kind, size) if box is None else (box[1] - box[0]) / 2 for kind, size, box in rows]
        faces = np.cumsum([0, *[0 if mesh is None else len(mesh.faces) for mesh in self.meshes]])
        return ModelTargets(
            build,
            self.kinds,
            np.arange(count),
            self.bodies,
            self.sizes,
            np.array(centres).reshape(count, 3),
            np.array(halves, float).reshape(count, 3),
            self.meshes,
            np.tile([1.0, 0.0, 0.0], (faces[-1], 1)),
            faces,
        )

    def poses(self):
        return GeomPoses(list(zip(self.positions, self.turns, strict=True)))

    def expected(self, world, points, ways, limit, excluded):
        """Each ray with each solid: distances in lengths of the directions, and solids."""
        most = np.abs(ways).max(axis=1)
        square = ways[:, 0] * ways[:, 0] + ways[:, 1] * ways[:, 1] + ways[:, 2] * ways[:, 2]
        good = (most > 0) & np.isfinite(most) & np.isfinite(points).all(axis=1)
        length = np.where(good, np.sqrt(square), 1.0)
        points, unit = np.where(good[:, None], points, 0.0), ways / length[:, None]
        nearest, solids = np.where(good, limit, -np.inf), np.full(len(ways), -1)
        for n, kind in enumerate(self.kinds):
            if self.bodies[n] == excluded:
                continue
            r, away = self.turns[world, n].reshape(3, 3), points - self.positions[world, n]
            o, d = (v[:, :1] * r[0] + v[:, 1:2] * r[1] + v[:, 2:] * r[2] for v in (away, unit))
            size = self.sizes[n]
            with np.errstate(all="ignore"):
                if kind == PLANE:
                    distance = -o[:, 2] / d[:, 2]
                    within = [(size[k] <= 0) | (np.abs(o[:, k] + distance * d[:, k]) <= size[k]) for k in range(2)]
                    met = (d[:, 2] < -1e-15) & (distance >= 0) & within[0] & within[1]
                    distance = np.where(met, distance, np.inf)
                elif kind == MESH:
                    distance = ReferenceMesh(self.meshes[n]).first(o, d, np.full(len(o), limit))[0]
                else:
                    columns = np.tile(size[:, None], len(o))
                    distance = first_surface(kind, o.T.copy(), d.T.copy(), columns)
            nearer = distance < nearest
            nearest[nearer], solids[nearer] = distance[nearer], n
        return np.where(solids < 0, -1.0, nearest / length), solids


@some
@given(
    seed=st.integers(0, 10**6),
    count=st.integers(0, 40),
    rays=st.sampled_from([1, 7, 8, 60, 300, 1500]),
    away=st.sampled_from([0.0, 1e3, 1e6]),
    limit=st.sampled_from([3.0, 9.0, np.inf]),
    own_points=st.booleans(),
    narrow=st.booleans(),
    excluded=st.sampled_from([-1, 2]),
)
def test_random_solids(build, seed, count, rays, away, limit, own_points, narrow, excluded):
    made = Worlds(seed, count, away)
    rng = made.rng
    ways = rng.normal(size=(rays, 3)) * (0.1 if narrow else 1.0) + ([1.0, 0.0, 0.0] if narrow else 0.0)
    ways[: rays // 8] = np.resize(np.concatenate([np.eye(3), -2 * np.eye(3)]), (rays // 8, 3))
    ways[rays - rays // 10 :] = [0.0, np.nan, 0.0]
    points = made.anchor + rng.normal(size=(2, rays, 3) if own_points else 3) * 3
    found = made.targets(build).cast(made.poses(), points, ways, limit, excluded, True)
    for world in range(2):
        starts = points[world] if own_points else np.tile(points, (rays, 1))
        distances, solids = made.expected(world, starts, ways, limit, excluded)
        np.testing.assert_array_equal(found[1][world], solids)
        np.testing.assert_array_equal(found[0][world], distances)
        met = solids >= 0
        with np.errstate(invalid="ignore"):
            assert ((found[2][world] * ways).sum(axis=1)[met] <= 0).all()
        assert np.abs(np.linalg.norm(found[2][world], axis=1) - met).max(initial=0.0) < 1e-9


def test_random_rays_do_hit(build):
    shares = []
    for seed in range(10):
        made, ways = Worlds(seed, 20, 0.0), np.random.default_rng(seed).normal(size=(200, 3))
        shares.append((made.targets(build).cast(made.poses(), np.zeros(3), ways, np.inf, -1, False)[1] >= 0).mean())
    assert 0.2 < np.mean(shares) < 0.999


@pytest.mark.parametrize("way", [(np.inf, 0.0, 0.0), (0.0, 0.0, 0.0), (np.nan, 1.0, 0.0)])
@pytest.mark.parametrize("count", [3, 40])
def test_random_solids_at_places_that_are_not_finite(build, way, count):
    made = Worlds(1, count, 0.0)
    ways = np.tile([[0.3, -0.2, 0.5]], (50, 1))
    ways[7] = way
    targets, poses = made.targets(build), made.poses()
    hits = targets.cast(poses, np.array([np.inf, 0.0, 0.0]), ways, np.inf, -1, True)
    assert (hits[1] == -1).all()
    assert not hits[2].any()
    assert (targets.cast(poses, np.zeros(3), ways, np.inf, -1, True)[1][:, 7] == -1).all()
    made.positions[:] = np.nan
    assert (targets.cast(poses, np.zeros(3), ways, np.inf, -1, True)[1] == -1).all()
    made.turns[:], made.positions[:] = np.inf, 1e300
    assert (targets.cast(poses, np.zeros(3), ways, np.inf, -1, True)[1] == -1).all()


def test_random_worlds_in_threads_are_those_of_one(build, monkeypatch):
    made, ways = Worlds(4, 60, 0.0), np.random.default_rng(4).normal(size=(9000, 3))
    results = []
    for workers in (1, 3):
        monkeypatch.setattr("morse.kernel.threads.count", lambda workers=workers: workers)
        results.append(made.targets(build).cast(made.poses(), np.zeros(3), ways, np.inf, -1, True))
    for one, other in zip(*results, strict=True):
        np.testing.assert_array_equal(one, other)
