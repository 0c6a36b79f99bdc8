"""Driven robots: the C functions and their twins in Python are bit-identical."""

import math

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.kernel.driving import (
    ChassisArrays,
    GliderArrays,
    NativeChassis,
    NativeGliders,
    NativePlanes,
    Placed,
    PlaneArrays,
    StanceArrays,
    turn_by,
)
from morse.kernel.memory import address
from tests.kernel.twins import driving


def rotations(chance, count):
    q = chance.normal(size=(count, 4))
    w, x, y, z = (q / np.linalg.norm(q, axis=1, keepdims=True)).T
    rows = [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z)]
    rows += [1 - 2 * (x * x + z * z), 2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x)]
    return np.ascontiguousarray(np.stack([*rows, 1 - 2 * (x * x + y * y)], axis=1))


def gliders(seed, strange=False):
    chance = np.random.default_rng(seed)
    n, k = int(chance.integers(0, 9)), 12
    commands = chance.uniform(-2, 2, size=(3, n)) * (chance.random((3, n)) < 0.7)
    if strange and n:
        commands[:, 0] = chance.choice([math.nan, math.inf, 1e308, -1e5], 3)
    return GliderArrays(
        slots=chance.permutation(k)[:n].astype(np.int64),
        forward=commands[0].copy(), aside=commands[1].copy(), rate=commands[2].copy(),
        shifts=chance.integers(0, 2, n).astype(np.uint8), ground=chance.integers(0, 2, n).astype(np.uint8),
        dofs=6 * np.arange(k), speeds=np.where(chance.random(k) < 0.2, -1.0, chance.uniform(0, 4, k)),
        margins=chance.uniform(0, 0.5, k), extents=chance.uniform(0, 1, k),
        plain=(chance.random(k) < 0.9).astype(np.uint8), free=(chance.random(k) < 0.9).astype(np.uint8),
        sliding=chance.integers(0, 2, k).astype(np.uint8),
        trees=chance.integers(-1, 6, k).astype(np.int32), asleep=chance.integers(-2, 3, 6).astype(np.int32),
        velocities=chance.normal(size=6 * k), period=1 / 60, done=np.zeros(n, dtype=np.uint8),
        cosines=np.zeros(n), sines=np.zeros(n), others=np.zeros(n, dtype=np.int64),
        settled=np.zeros(n, dtype=np.int64), stances=stances(chance, k),
    ), rotations(chance, k)  # fmt: skip


def stances(chance, k):
    return StanceArrays(
        able=(chance.random(k) < 0.9).astype(np.uint8), ticks=chance.integers(6, 8, k),
        heights=np.zeros(k), ups=rotations(chance, k)[:, 6:].copy(), until=chance.integers(6, 10, k),
    )  # fmt: skip


def stances_of(arrays):
    kept = arrays.stances
    return [part.tobytes() for part in (kept.ticks, kept.heights, kept.ups)]


@pytest.mark.parametrize("strange", [False, True])
def test_gliders_are_driven_alike(build, strange):
    for seed in range(200):
        (mine, turned), (theirs, _) = gliders(seed, strange), gliders(seed, strange)
        native, twin = NativeGliders(build, mine), driving.Gliders(theirs)
        left = native.begin(turned)
        assert left == twin.begin(turned)
        assert mine.others[:left].tolist() == theirs.others[:left].tolist()
        assert mine.velocities.tobytes() == theirs.velocities.tobytes()
        native.end()
        twin.end()
        assert mine.velocities.tobytes() == theirs.velocities.tobytes()


@pytest.mark.parametrize("strange", [False, True])
def test_robots_that_push_are_driven_alike(build, strange):
    driven = settled = 0
    for seed in range(200):
        (mine, turned), (theirs, _) = gliders(seed, strange), gliders(seed, strange)
        native, twin = NativeGliders(build, mine), driving.Gliders(theirs)
        # some stand as in the last tick, at a height that the stance has
        places = np.where(np.arange(12) % 2, 0.0, 1e-8)[:, None] * np.ones(3)
        mine.stances.ups[::3] = theirs.stances.ups[::3] = turned[::3, 6:]
        for tick in (8, 9):
            left = native.begin(turned)
            twin.begin(turned)
            results = native.push(places, turned, left, tick)
            assert results == twin.push(places, turned, left, tick)
            assert mine.others[: results[0]].tolist() == theirs.others[: results[0]].tolist()
            assert mine.settled[: results[1]].tolist() == theirs.settled[: results[1]].tolist()
            assert np.array_equal(mine.velocities, theirs.velocities, equal_nan=True)
            assert mine.done.tobytes() == theirs.done.tobytes()
            assert stances_of(mine) == stances_of(theirs)
            driven, settled = driven + left - results[0], settled + results[1]
            native.end()
            twin.end()
            assert np.array_equal(mine.velocities, theirs.velocities, equal_nan=True)
    assert driven > 100
    assert settled > 10


def test_a_glider_ends_where_the_arc_ends(build):
    arrays, _ = gliders(0)
    one = np.zeros(1)
    for work in (lambda a: NativeGliders(build, a), driving.Gliders):
        arrays.slots, arrays.forward, arrays.aside = np.zeros(1, dtype=np.int64), one + 0.5, one.copy()
        arrays.rate, arrays.shifts = one + 3.0, np.zeros(1, dtype=np.uint8)
        arrays.done, arrays.cosines, arrays.sines = np.zeros(1, dtype=np.uint8), one.copy(), one.copy()
        arrays.others = np.zeros(1, dtype=np.int64)
        arrays.speeds[0], arrays.margins[0], arrays.plain[0] = 9.0, 9.0, 1
        driven = work(arrays)
        assert driven.begin(np.tile(np.eye(3).ravel(), (12, 1))) == 0
        # radius v / w: an arc of w T from the origin
        turned, radius = 3.0 / 60, 0.5 / 3.0
        moved = arrays.velocities[:2] / 60
        assert moved == pytest.approx([radius * math.sin(turned), radius * (1 - math.cos(turned))], rel=1e-13)
        driven.end()
        assert arrays.velocities[:2] == pytest.approx([0.5 * math.cos(turned), 0.5 * math.sin(turned)], rel=1e-3)


def chassis(seed, strange=False):
    chance = np.random.default_rng(seed)
    n, k, g = int(chance.integers(1, 6)), 8, 40
    wheels = chance.integers(1, 5, n)
    w = int(wheels.sum())
    speeds = chance.normal(size=w) * (chance.random() < 0.8)
    if strange:
        speeds[0] = chance.choice([math.nan, math.inf, -1e300])
    return ChassisArrays(
        first=np.concatenate([[0], np.cumsum(wheels)]).astype(np.int64), geoms=chance.permutation(g)[:w],
        motors=np.arange(w), radii=chance.uniform(0.05, 0.3, w), levers=chance.normal(size=w),
        slots=chance.permutation(k)[:n], dofs=6 * np.arange(n), axles=chance.normal(size=n),
        frictions=chance.uniform(0.1, 1, n), turnings=chance.uniform(1, 9, n),
        driven=(chance.random(n) < 0.2).astype(np.uint8),
        touching=chance.integers(-1, g, (16, 2)).astype(np.int32), touched=np.ones(g, dtype=np.uint8),
        controls=speeds, velocities=chance.normal(size=6 * n) * chance.choice([1.0, 1e-3]),
        dimensions=np.full(g, 4, dtype=np.int32), period=1 / 60, creep=0.02,
    ), rotations(chance, k)  # fmt: skip


@pytest.mark.parametrize("strange", [False, True])
def test_robots_on_wheels_are_moved_alike(build, strange):
    for seed in range(200):
        (mine, turned), (theirs, _) = chassis(seed, strange), chassis(seed, strange)
        for pairs in (0, seed % 17):
            with np.errstate(all="ignore"):
                NativeChassis(build, mine).pull(turned, pairs, 9.81)
                driving.Chassis(theirs).pull(turned, pairs, 9.81)
            same = np.array_equal(mine.velocities, theirs.velocities, equal_nan=True)
            assert same
            assert mine.dimensions.tobytes() == theirs.dimensions.tobytes()


def planes(seed, strange=False):
    chance = np.random.default_rng(seed)
    n, k, g, b, p = int(chance.integers(1, 6)), 8, 40, 12, int(chance.integers(1, 4))
    shapes = chance.integers(1, 5, n)
    s = int(shapes.sum())
    geoms = chance.permutation(g)
    boxes, angles = geoms[s : s + p], chance.uniform(0, 7, p)
    c, d = np.cos(angles), np.sin(angles)
    box_places, box_turns = chance.normal(size=(g, 3)), chance.normal(size=(g, 9))
    places = np.hstack([box_places[boxes], box_turns[boxes]])
    places[chance.random(p) < 0.2, chance.integers(0, 12)] += 1e-9
    box_bits, plane_bits = 1 << np.arange(1, p + 1, dtype=np.int32), 1 << np.arange(27, 27 + p, dtype=np.int32)
    types = np.where(chance.random(g) < 0.9, (1 << 27) - 1, 0).astype(np.int32)
    types[boxes] = np.where(chance.random(p) < 0.9, box_bits, 0)
    velocities, positions = chance.normal(size=6 * n), chance.uniform(-4, 4, (k, 3)) * (1, 1, 0.02)
    if strange:
        velocities[chance.integers(0, 6 * n)] = chance.choice([math.nan, math.inf, -1e300])
        positions[chance.integers(0, k), chance.integers(0, 3)] = chance.choice([math.nan, -math.inf, 1e300])
    return PlaneArrays(
        first=np.concatenate([[0], np.cumsum(shapes)]).astype(np.int64), geoms=geoms[:s],
        carriers=np.where(chance.random(s) < 0.5, -1, chance.integers(0, b, s)), slots=chance.permutation(k)[:n],
        dofs=6 * np.arange(n), boxes=boxes, places=places,
        tops=np.column_stack([chance.normal(size=(p, 3)) * (0.1, 1, 1), c, d, -d, c, chance.uniform(2, 6, (p, 2))]),
        box_bits=box_bits, plane_bits=plane_bits, velocities=velocities, body_places=chance.normal(size=(b, 3)) * 0.2,
        box_places=box_places, box_turns=box_turns, shape_places=chance.normal(size=(g, 3)) * 0.2,
        radii=chance.uniform(0, 0.3, g), types=types, affinities=types.copy(), period=1 / 60, edge=0.01, deep=0.05,
        all_bits=(1 << 27) - 1,
    ), positions  # fmt: skip


@pytest.mark.parametrize("strange", [False, True])
def test_planes_below_robots_are_selected_alike(build, strange):
    selected = 0
    for seed in range(200):
        (mine, positions), (theirs, _) = planes(seed, strange), planes(seed, strange)
        with np.errstate(all="ignore"):
            NativePlanes(build, mine).select(positions)
            driving.Planes(theirs).select(positions)
        assert mine.types.tobytes() == theirs.types.tobytes()
        assert mine.affinities.tobytes() == theirs.affinities.tobytes()
        selected += int((mine.types >= 1 << 27).any())
    assert 50 < selected < 190


@given(st.floats(-1e5, 1e5))
def test_sine_and_cosine(angle):
    cosine, sine = turn_by(angle)
    assert cosine == pytest.approx(math.cos(angle), abs=3e-16)
    assert sine == pytest.approx(math.sin(angle), abs=3e-16)


def free_bodies(count):
    bodies = "".join("<body><freejoint/><geom size='0.1'/></body>" for _ in range(count))
    return mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")


@given(st.integers(0, 2**32), st.floats(1e-4, 0.1))
def test_robots_move_as_bodies_of_the_engine(seed, period):
    """Positions and orientations are those of the engine's own integration and kinematics, up to rounding."""
    chance = np.random.default_rng(seed)
    model = free_bodies(5)
    data = mujoco.MjData(model)
    data.qpos[:] = chance.normal(size=35)
    mujoco.mj_normalizeQuat(model, data.qpos)
    data.qvel[:] = chance.normal(size=30) * (chance.random(30) < 0.7)
    data.qvel[6:12] = 0.0
    start, expected = data.qpos.copy(), data.qpos.copy()
    mujoco.mj_integratePos(model, expected, data.qvel, period)
    chosen = np.sort(chance.permutation(5)[:3])
    placed = Placed(7 * chosen, 6 * chosen, chosen, data.qpos)
    placed.move(address(start), address(data.qvel), period)
    positions, rotations = np.full((5, 3), np.nan), np.full((5, 9), np.nan)
    placed.write_poses(address(positions), address(rotations))
    left = np.setdiff1d(np.arange(5), chosen)
    assert np.array_equal(data.qpos.reshape(5, 7)[left], start.reshape(5, 7)[left])
    assert np.isnan(positions[left]).all()
    assert np.isnan(rotations[left]).all()
    assert np.allclose(data.qpos.reshape(5, 7)[chosen], expected.reshape(5, 7)[chosen], rtol=0.0, atol=1e-14)
    mujoco.mj_kinematics(model, data)
    assert np.array_equal(positions[chosen], data.xpos[1 + chosen])
    assert np.allclose(rotations[chosen], data.xmat[1 + chosen], rtol=0.0, atol=1e-14)


def test_a_velocity_that_is_not_finite_is_that_of_its_robot_alone():
    qpos = np.tile([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], 3)
    start, velocities = qpos.copy(), np.zeros(18)
    velocities[[0, 5]], velocities[11] = (math.nan, math.inf), 1.0
    chosen = np.arange(3)
    Placed(7 * chosen, 6 * chosen, chosen, qpos).move(address(start), address(velocities), 1 / 60)
    assert not np.isfinite(qpos[:7]).all()
    assert qpos[7:14].tolist() == pytest.approx([0, 0, 0, math.cos(1 / 120), 0, 0, math.sin(1 / 120)], abs=1e-16)
    assert qpos[14:].tolist() == start[14:].tolist()
