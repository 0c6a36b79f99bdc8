"""Rays at models of MuJoCo, against `mujoco.mj_multiRay`."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import mujoco
import numpy as np
import pytest

import morse

_MODEL = """<mujoco><asset><mesh name="m" vertex="-.3 -.2 -.1 .3 -.2 -.1 .1 .2 -.1 0 0 .4"/>
<hfield name="h" nrow="5" ncol="6" size=".6 .5 .3 .1"
 elevation="0 1 0 0 1 0 1 0 1 1 0 0 0 1 0 1 0 1 1 1 0 0 1 1 0 0 1 1 0 1"/></asset><worldbody>
<geom type="plane" size="0 0 1" pos="0 0 -.5"/><geom type="plane" size=".5 .5 1" pos="2 2 .3" euler="20 10 0"/>
<geom type="sphere" size=".3" pos="1 0 0"/><geom type="box" size=".2 .3 .1" pos="0 1 .2" euler="10 40 70"/>
<geom type="capsule" size=".1 .3" pos="-1 0 .2" euler="80 0 30"/>
<geom type="cylinder" size=".2 .3" pos="0 -1 .1" euler="30 50 0"/>
<geom type="ellipsoid" size=".1 .3 .2" pos="1 1 .1" euler="0 40 20"/>
<geom type="mesh" mesh="m" pos="-1 1 0" euler="0 20 0"/><geom type="hfield" hfield="h" pos="-1 -1 -.2"/>
<geom type="sphere" size=".3" pos="1 -1 0" rgba="1 0 0 0"/>
<body pos="0 0 1"><freejoint/><geom type="sphere" size=".2" group="3"/></body></worldbody></mujoco>"""


def _state() -> tuple[Any, Any]:
    model = mujoco.MjModel.from_xml_string(_MODEL)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def _reference(model: Any, data: Any, point: Any, ways: Any, group: Any = None) -> tuple[Any, Any]:
    geoms, distances = np.zeros(len(ways), np.int32), np.zeros(len(ways))
    mujoco.mj_multiRay(model, data, point, ways.ravel(), group, 1, -1, geoms, distances, None, len(ways), 1e10)
    return geoms, distances


@pytest.mark.parametrize("point", [(0.0, 0.0, 0.3), (0.3, -0.4, 2.0), (-1.2, 0.5, 0.9)])
def test_hits_are_those_of_mujoco(point: tuple[float, ...]) -> None:
    model, data = _state()
    ways = np.random.default_rng(3).normal(size=(3000, 3))
    hits = morse.Rays(model).cast(data, point, ways)
    geoms, distances = _reference(model, data, np.array(point), ways)
    same = hits.geoms == geoms
    # at edges, rounding decides
    assert same.mean() > 0.998
    assert set(np.unique(geoms)) >= {0, 2, 3, 4, 5, 6}
    # those of height fields are in single precision
    field = same & (geoms == 8)
    assert hits.distances[field] == pytest.approx(distances[field], abs=1e-6)
    others = same & ~field
    assert hits.distances[others] == pytest.approx(distances[others], rel=1e-9, abs=1e-9)
    hit = hits.geoms >= 0
    assert (hits.normals[hit] ** 2).sum(axis=1) == pytest.approx(np.ones(hit.sum()))
    assert ((hits.normals * ways).sum(axis=1)[hit] < 0).all()
    assert not hits.normals[~hit].any()
    sphere = hits.geoms == 2
    centre = (np.array(point) + hits.distances[sphere, None] * ways[sphere] - [1, 0, 0]) / 0.3
    assert hits.normals[sphere] == pytest.approx(centre, abs=1e-9)


def test_many_states_in_one_call() -> None:
    model, _ = _state()
    states = []
    for height in (1.0, 1.5, 3.0):
        data = mujoco.MjData(model)
        data.qpos[2] = height
        mujoco.mj_forward(model, data)
        states.append(data)
    hits = morse.Rays(model).cast(states, (0, 0, 5), [[0, 0, -1.0], [0, 0, -2.0]])
    assert hits.distances == pytest.approx(np.array([[3.8, 1.9], [3.3, 1.65], [1.8, 0.9]]))
    assert hits.normals[:, 0].tolist() == [[0, 0, 1]] * 3


def test_groups_and_limits() -> None:
    model, data = _state()
    down = [[0, 0, -1.0]]
    assert morse.Rays(model, [True, True, True, False, True, True]).cast(data, (0, 0, 5), down).geoms[0] == 0
    assert morse.Rays(model).cast(data, (0, 0, 5), down, limit=2.0).geoms[0] == -1
    for limit in (4.0, 10**400):
        assert morse.Rays(model).cast(data, (0, 0, 5), down, limit=limit).distances[0] == pytest.approx(3.8)


def test_wrong_rays_are_told_or_hit_nothing() -> None:
    model, data = _state()
    rays = morse.Rays(model)
    hits = rays.cast(data, (0, 0, 5), [[0, 0, 0], [np.nan, 0, 1], [0, 0, np.inf], [0, 0, -1]])
    assert hits.geoms[:3].tolist() == [-1, -1, -1]
    assert hits.distances[:3].tolist() == [-1, -1, -1]
    assert rays.cast(data, (0, 0, 5), np.zeros((0, 3))).distances.shape == (0,)
    with pytest.raises(ValueError, match="Directions have the shape"):
        rays.cast(data, (0, 0, 5), [0, 0, -1])
    with pytest.raises(ValueError, match="Points have the shape"):
        rays.cast(data, np.zeros((4, 3)), np.ones((5, 3)))
    with pytest.raises(ValueError, match="greater than 0"):
        rays.cast(data, (0, 0, 5), [[0, 0, -1]], limit=np.nan)
    with pytest.raises(ValueError, match="6 groups"):
        morse.Rays(model, [True])
    empty = mujoco.MjModel.from_xml_string("<mujoco/>")
    assert morse.Rays(empty).cast(mujoco.MjData(empty), (0, 0, 0), [[0, 0, 1]]).geoms.tolist() == [-1]


def _plate(height: float) -> tuple[Any, Any]:
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><body><joint type="slide" axis="0 0 1"/><geom type="box" size="5 5 .1"/></body>'
        "</worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    data.qpos[0] = height
    mujoco.mj_forward(model, data)
    return model, data


def test_threads_cast_at_their_own_states() -> None:
    model, _ = _plate(0.0)
    rays, ways = morse.Rays(model), np.tile([[0.0, 0.0, -1.0]], (2000, 1))

    def wrong(height: float) -> int:
        data = _plate(height)[1]
        far = [rays.cast(data, (0.0, 0.0, 20.0), ways).distances for _ in range(40)]
        return sum(not np.allclose(row, 19.9 - height) for row in far)

    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(wrong, (0.0, 3.0, 7.0, 11.0))) == [0, 0, 0, 0]


@pytest.mark.parametrize("length", [1e-250, 1e-160, 1.0, 1e160, 1e300])
def test_directions_have_any_length(length: float) -> None:
    model, data = _plate(0.0)
    hits = morse.Rays(model).cast(data, (0.0, 0.0, 20.0), [[0.0, 0.0, -length], [3e-3 * length, 0.0, -length]])
    np.testing.assert_allclose(hits.distances, 19.9 / length)


def test_states_of_other_models_are_refused() -> None:
    (model, data), (plate, other) = _state(), _plate(0.0)
    for known, strange in ((model, other), (plate, data)):
        with pytest.raises(ValueError, match=r"The state is one of another model: .*ngeom"):
            morse.Rays(known).cast(strange, (0.0, 0.0, 3.0), [[0.0, 0.0, -1.0]])
    with pytest.raises(TypeError, match=r"Expected a state, mujoco\.MjData, got NoneType"):
        morse.Rays(model).cast(None, (0.0, 0.0, 3.0), [[0.0, 0.0, -1.0]])  # type: ignore[arg-type]
    # models of the same sizes may differ in all else
    assert morse.Rays(plate).cast(_plate(2.0)[1], (0.0, 0.0, 3.0), [[0.0, 0.0, -1.0]]).distances[0] == pytest.approx(
        0.9
    )


def test_no_states_have_no_hits() -> None:
    model, _ = _state()
    assert morse.Rays(model).cast([], (0.0, 0.0, 3.0), [[0.0, 0.0, -1.0]]).normals.shape == (0, 1, 3)


def _many(solids: int, seed: int = 5) -> tuple[Any, Any]:
    """A world of solids of all kinds, half of which move."""
    rng = np.random.default_rng(seed)
    parts = []
    for n in range(solids):
        kind = ("sphere", "box", "capsule", "cylinder", "ellipsoid")[n % 5]
        place = " ".join(f"{value:.4f}" for value in rng.uniform(-4, 4, 3))
        turn = " ".join(f"{value:.2f}" for value in rng.uniform(-180, 180, 3))
        geom = f'<geom type="{kind}" size="{" ".join(f"{value:.3f}" for value in rng.uniform(0.05, 0.5, 3))}"'
        if n % 2:
            parts.append(f'<body pos="{place}" euler="{turn}"><freejoint/>{geom}/></body>')
        else:
            parts.append(f'{geom} pos="{place}" euler="{turn}"/>')
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><worldbody><geom type="plane" size="0 3 1" pos="0 0 -3"/>{"".join(parts)}</worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


@pytest.mark.parametrize("solids", [1, 8, 9, 64, 65, 300])
@pytest.mark.parametrize("away", [0.0, 5.0, 1e4])
def test_any_number_of_solids_is_hit_as_in_mujoco(solids: int, away: float) -> None:
    model, data = _many(solids)
    ways = np.random.default_rng(7).normal(size=(2000, 3))
    point = np.array([away, 0.1, 0.2])
    if away:
        # towards the solids
        ways = np.random.default_rng(7).uniform(-4, 4, (2000, 3)) - point
    hits = morse.Rays(model).cast(data, point, ways)
    geoms, distances = _reference(model, data, point, ways)
    same = hits.geoms == geoms
    assert same.mean() > 0.998
    assert hits.distances[same] == pytest.approx(distances[same], rel=1e-7, abs=1e-9)


def test_solids_that_stand_are_where_they_are_put() -> None:
    """What stands is prepared once, and again where its place has changed."""
    model, data = _many(100)
    rays, down = morse.Rays(model), np.array([[0.0, 0.0, -1.0]])
    place = data.geom_xpos[1] + [0.0, 0.0, 20.0]
    assert rays.cast(data, place, down).geoms[0] >= 0
    for shift in (30.0, -30.0, 55.0):
        model.geom_pos[1, 0] += shift
        mujoco.mj_forward(model, data)
        place = data.geom_xpos[1] + [0.0, 0.0, 20.0]
        assert rays.cast(data, place, down).geoms[0] == 1


@pytest.mark.parametrize("solids", [9, 100])
def test_bodies_and_what_is_fixed_may_be_left_out(solids: int) -> None:
    model, data = _many(solids)
    ways = np.random.default_rng(2).normal(size=(2000, 3))
    geoms, distances = np.zeros(len(ways), np.int32), np.zeros(len(ways))
    for fixed, body in ((True, 1), (False, -1), (False, 2), (True, 0)):
        point = data.xpos[max(body, 1)] + [0.01, 0.0, 0.0]
        mujoco.mj_multiRay(model, data, point, ways.ravel(), None, fixed, body, geoms, distances, None, len(ways), 1e10)
        hits = morse.Rays(model, flg_static=fixed).cast(data, point, ways, bodyexclude=body)
        assert (hits.geoms == geoms).mean() > 0.998
    with pytest.raises(ValueError, match=r"The body 99\d* is out of range \[-1, "):
        morse.Rays(model).cast(data, (0, 0, 0), ways, bodyexclude=999)


def test_points_of_each_ray_and_each_world() -> None:
    model, data = _many(20)
    other = _many(20, seed=5)[1]
    other.qpos[2] += 1.0
    mujoco.mj_forward(model, other)
    rng = np.random.default_rng(3)
    points, ways = rng.uniform(-5, 5, (2, 3000, 3)), rng.normal(size=(2, 3000, 3))
    rays = morse.Rays(model)
    both = rays.cast([data, other], points, ways)
    for n, state in enumerate((data, other)):
        alone = rays.cast(state, points[n], ways[n])
        for row in range(0, 3000, 500):
            one = rays.cast(state, points[n, row], ways[n, row : row + 1])
            assert one.distances[0] == alone.distances[row]
        for part, whole in zip(alone, both, strict=True):
            np.testing.assert_array_equal(part, whole[n])
    # a state that is not finite hides what it moves, and points that are not finite hit nothing
    other.geom_xpos[2] = np.nan
    points[0, 0] = np.nan
    hits = rays.cast([data, other], points, ways)
    assert hits.geoms[0, 0] == -1
    np.testing.assert_array_equal(hits.geoms[0, 1:], both.geoms[0, 1:])
    assert not (hits.geoms[1] == 2).any()


@pytest.mark.parametrize("solids", [1, 8, 40])
@pytest.mark.parametrize("inside", [False, True])
def test_normals_are_those_of_mujoco(solids: int, inside: bool) -> None:
    model, data = _many(solids)
    # not a multiple of the eight rays of a packet
    ways = np.random.default_rng(4).normal(size=(1501, 3))
    point = np.array(data.geom_xpos[1]) if inside else np.array([0.3, 0.2, 5.0])
    geoms, distances, normals = np.zeros(len(ways), np.int32), np.zeros(len(ways)), np.zeros((len(ways), 3))
    mujoco.mj_multiRay(
        model, data, point, ways.ravel(), None, 1, -1, geoms, distances, normals.ravel(), len(ways), 1e10
    )
    hits, without = morse.Rays(model).cast(data, point, ways), morse.Rays(model).cast(data, point, ways, normals=False)
    np.testing.assert_array_equal(hits.distances, without.distances)
    np.testing.assert_array_equal(hits.geoms, without.geoms)
    same = (hits.geoms == geoms) & (geoms >= 0)
    assert same.sum() > 50
    # ours are against the ray, also inside of a solid
    cosines = np.abs((hits.normals * normals).sum(axis=1))[same]
    assert (cosines > 1 - 1e-9).mean() > 0.998
    assert not hits.normals[hits.geoms < 0].any()
