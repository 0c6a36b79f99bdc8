"""Few shapes for meshes that move."""

import sys
import types

import mujoco
import numpy as np
import pytest
import trimesh

from morse.assets.shapes import ConvexPart, Primitive, coacd_parts, few_parts


def _bumpy(subdivisions: int = 3) -> trimesh.Trimesh:
    """A star of round bumps, of 1,280 triangles or more."""
    ball = trimesh.creation.icosphere(subdivisions=subdivisions)
    x, y, z = ball.vertices.T
    ball.vertices *= (1.0 + 0.15 * np.sin(7 * x) * np.cos(5 * y) * np.sin(6 * z + 1))[:, None]
    return ball


def _torus() -> trimesh.Trimesh:
    return trimesh.creation.torus(1.0, 0.25, major_sections=48, minor_sections=24)


def _limbs() -> trimesh.Trimesh:
    arms = [
        trimesh.creation.capsule(2.0, 0.2, transform=trimesh.transformations.random_rotation_matrix(rand))
        for rand in ([0.1, 0.5, 0.9], [0.7, 0.2, 0.4], [0.3, 0.8, 0.1])
    ]
    return trimesh.util.concatenate([_bumpy(), *arms])


def _distance_outside(parts: list[ConvexPart | Primitive], points: np.ndarray) -> np.ndarray:
    """The distance (P,) of points to the nearest part, 0 inside, by the engine."""
    spec = mujoco.MjSpec()
    for index, part in enumerate(parts):
        assert isinstance(part, ConvexPart)
        spec.add_mesh(name=f"part{index}", uservert=part.points.astype(np.float32).ravel())
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=f"part{index}")
    probe = spec.worldbody.add_body(mocap=True)
    probe.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[1e-4, 0, 0])
    model = spec.compile()
    data = mujoco.MjData(model)
    distances = []
    for point in points:
        data.mocap_pos[0] = point
        mujoco.mj_kinematics(model, data)
        each = [mujoco.mj_geomDistance(model, data, geom, len(parts), 10.0, None) for geom in range(len(parts))]
        distances.append(max(min(each), 0.0))
    return np.array(distances)


def _volume(parts: list[ConvexPart | Primitive]) -> float:
    return sum(_hull_volume(part.points) for part in parts if isinstance(part, ConvexPart))


def _hull_volume(points: np.ndarray) -> float:
    spec = mujoco.MjSpec()
    spec.add_mesh(
        name="hull", uservert=points.astype(np.float32).ravel(), inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX
    )
    spec.worldbody.add_body().add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="hull", density=1.0)
    return float(spec.compile().body_mass.sum())


@pytest.mark.parametrize(("mesh", "excess"), [(_bumpy(), 0.07), (_bumpy(4), 0.07), (_torus(), 0.35)])
def test_a_detailed_mesh_gets_few_parts_of_nearly_its_volume(mesh: trimesh.Trimesh, excess: float) -> None:
    parts = few_parts(mesh.vertices, mesh.faces, 32)
    assert 1 < len(parts) <= 32
    assert 0.97 * mesh.volume < _volume(parts) < (1.0 + excess) * mesh.volume
    # the parts cover the surface, up to the rounding of hulls of many vertices
    assert _distance_outside(parts, mesh.vertices[::7]).max() < 0.01 * mesh.scale


def test_the_hole_of_a_ring_stays_open() -> None:
    parts = few_parts(_torus().vertices, _torus().faces, 32)
    assert _distance_outside(parts, np.zeros((1, 3)))[0] > 0.3


def test_simple_pieces_of_a_detailed_mesh_stay_exact() -> None:
    boxes = [trimesh.creation.box((0.2, 0.2, 0.2)) for _ in range(3)]
    for number, box in enumerate(boxes):
        box.apply_translation((2.0 + number, 0.0, 0.0))
    mesh = trimesh.util.concatenate([_bumpy(), *boxes])
    parts = few_parts(mesh.vertices, mesh.faces, 32)
    assert len(parts) <= 32
    assert [part.size for part in parts if isinstance(part, Primitive)] == [pytest.approx((0.1, 0.1, 0.1))] * 3


@pytest.mark.parametrize("count", [33, 200])
def test_many_pieces_share_the_budget(count: int) -> None:
    place = np.random.default_rng(1).uniform(-3, 3, (count, 3))
    mesh = trimesh.util.concatenate([trimesh.creation.icosphere(subdivisions=1, radius=0.3) for _ in range(count)])
    mesh.vertices += np.repeat(place, len(mesh.vertices) // count, axis=0)
    assert 1 < len(few_parts(mesh.vertices, mesh.faces, 32)) <= 32


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e4])
def test_flat_and_open_meshes_of_any_size_have_parts(size: float) -> None:
    sheet = trimesh.creation.icosphere(subdivisions=3)
    faces = sheet.faces[sheet.triangles_center[:, 2] > 0.0]
    for points in (sheet.vertices * size, sheet.vertices * [size, size, 1e-9 * size]):
        assert 1 <= len(few_parts(points, faces, 32)) <= 32


def test_coacd_decomposes_if_it_is_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = _torus()
    calls: list[dict[str, object]] = []

    def run(one: object, **options: object) -> list[tuple[np.ndarray, np.ndarray]]:
        calls.append(options)
        cube = trimesh.creation.box((1, 1, 1))
        return [(cube.vertices, cube.faces)]

    package = types.SimpleNamespace(Mesh=lambda *arrays: arrays, run_coacd=run, set_log_level=lambda level: None)
    monkeypatch.setitem(sys.modules, "coacd", package)
    (part,) = coacd_parts.coacd_parts(mesh.vertices, mesh.faces, 32)
    assert np.ptp(part.points, axis=0).tolist() == [1, 1, 1]
    assert calls[0]["max_convex_hull"] == 32
