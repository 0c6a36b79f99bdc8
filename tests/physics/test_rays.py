"""Rays against worlds with known results."""

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from ray_formulas import first_hit, grazes
from worlds import box, node, rigid, robot, run, sphere, world

from morse.mathutils import Euler
from morse.scene import CollisionShape, Node, PhysicsType, ShapeKind
from tests.kit.effort import examples

pytestmark = pytest.mark.long

FREE_OR_FIXED = st.sampled_from([PhysicsType.STATIC, PhysicsType.RIGID_BODY])
lengths = st.floats(0.05, 2.0)
places = st.tuples(*[st.floats(-8.0, 8.0)] * 3)
angles = st.tuples(*[st.floats(-math.pi, math.pi)] * 3)


@st.composite
def shapes(draw):
    kind = draw(st.sampled_from([kind for kind in ShapeKind if kind not in (ShapeKind.CONVEX, ShapeKind.HEIGHT_FIELD)]))
    count = {ShapeKind.SPHERE: 1, ShapeKind.CYLINDER: 2, ShapeKind.CAPSULE: 2}.get(kind, 3)
    return CollisionShape(kind, tuple(draw(lengths) for _ in range(count)))


solids = st.lists(st.tuples(shapes(), places, angles, FREE_OR_FIXED), min_size=1, max_size=6)


def rotation_of(angles):
    (sx, sy, sz), (cx, cy, cz) = np.sin(angles), np.cos(angles)
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def directions(count, seed):
    rows = np.random.default_rng(seed).normal(size=(count, 3))
    return rows / np.linalg.norm(rows, axis=1)[:, None]


def eye(name="eye", *, at=(0, 0, 0), **settings):
    """A robot with sensors but without a shape."""
    return Node(name, location=list(at), **settings)


def look(w, ways, *, of="eye", reach=math.inf, origins=None):
    bundle = w.rays.bundle(w.game_object(of), ways, reach, origins)
    bundle.refresh()
    return bundle


def names(bundle):
    met = [bundle.object_of(i) for i in range(len(bundle))]
    return [None if obj is None else obj.name for obj in met]


# -- formulas ------------------------------------------------------------------------------


@settings(max_examples=examples(50), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(solids=solids, at=places, count=st.sampled_from([20, 200]), seed=st.integers(0, 1000))
def test_rays_at_primitives_match_closed_formulas(solids, at, count, seed):
    """Few or many rays, at fixed or moving bodies, from outside or inside."""
    nodes = [
        node(f"solid{i}", shape, at=place, turned=turn, kind=kind)
        for i, (shape, place, turn, kind) in enumerate(solids)
    ]
    body = robot("eye", box(0.3, 0.3, 0.3), at=at)
    w = world(*nodes, body, robots=[body], gravity=0.0)
    known = [(shape, np.array(place), rotation_of(turn)) for shape, place, turn, _ in solids]
    ways = directions(count, seed)
    seen = look(w, ways)
    for way, distance in zip(ways, seen.distances, strict=True):
        if not grazes(known, np.array(at), way):
            assert distance == pytest.approx(first_hit(known, np.array(at), way), abs=1e-5)


@settings(max_examples=examples(25), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(solids=solids, ats=st.lists(places, min_size=2, max_size=4), seed=st.integers(0, 1000))
def test_casting_together_changes_nothing(solids, ats, seed):
    nodes = [
        node(f"solid{i}", shape, at=place, turned=turn, kind=kind)
        for i, (shape, place, turn, kind) in enumerate(solids)
    ]
    bodies = [robot(f"eye{i}", box(0.3, 0.2, 0.4), at=at) for i, at in enumerate(ats)]
    w = world(*nodes, *bodies, robots=bodies, gravity=0.0)
    counts = [3, 90, 90, 1]
    bundles = [
        w.rays.bundle(w.game_object(f"eye{i}"), directions(count, seed + count), 9.0)
        for i, count in zip(range(len(ats)), counts, strict=False)
    ]
    w.rays.cast(bundles)
    together = [bundle.distances.tolist() for bundle in bundles]
    for bundle, distances in zip(bundles, together, strict=True):
        w.rays.cast([bundle])
        assert bundle.distances.tolist() == distances


def test_distances_are_exact_far_from_the_origin():
    """Coordinates as in a map projection, where single precision has a resolution of half a metre."""
    east, north = 512_345.25, 5_412_345.5
    spot = robot("eye", box(0.3, 0.3, 0.3), at=(east, north, 0.5))
    w = world(
        node("Wall", box(0.2, 8, 2), at=(east + 7.1, north, 1)),
        rigid("Ball", sphere(0.5), at=(east, north + 3, 0.5)),
        spot,
        robots=[spot],
    )
    ways = [[1, 0, 0], [0, 1, 0], [1, 0.1, 0.05], *directions(100, 3)]
    seen = look(w, ways)
    expected = [7.0, 2.5, 7.0 * math.hypot(1, 0.1, 0.05)]
    assert seen.distances[:3] == pytest.approx(expected, abs=1e-7)


def test_a_ray_reaches_as_far_as_it_is_told():
    w = world(node("Wall", box(0.2, 4, 4), at=(3.1, 0, 0)), eye())
    assert look(w, [[1, 0, 0]], reach=3.0).distances.tolist() == pytest.approx([3.0])
    assert look(w, [[1, 0, 0]], reach=2.999).distances.tolist() == [math.inf]
    missed = look(w, [[1, 0, 0], [-1, 0, 0]], reach=2.0)
    assert missed.ranges.tolist() == [2.0, 2.0]
    assert missed.points.tolist() == [[0, 0, 0], [0, 0, 0]]
    assert not any("-" in str(number) for number in missed.points.ravel().tolist())


def test_points_are_in_the_frame_of_the_sensor():
    turned = eye(at=(1, 2, 0), rotation_euler=[0, 0, math.pi / 2])
    w = world(node("Wall", box(4, 0.2, 4), at=(1, 5.1, 0)), turned)
    seen = look(w, [[2, 0, 0], [1, 0.25, 0]])
    assert seen.points[0] == pytest.approx([3, 0, 0])
    assert seen.points[1] == pytest.approx([3, 0.75, 0])
    assert seen.segments()[0] == pytest.approx([1, 2, 0, 1, 5, 0, 1])


def test_rays_may_start_anywhere():
    w = world(node("Wall", box(0.2, 4, 4), at=(3.1, 0, 0)), eye(at=(0, 0, 0), rotation_euler=[0, 0, math.pi / 2]))
    seen = look(w, [[0, -1, 0], [0, -1, 0]], origins=[[0.0, 0.5, 0.0], [5.0, 0.0, 0.0]], reach=9)
    assert seen.distances.tolist() == pytest.approx([3.5, math.inf])
    assert seen.points.tolist()[0] == pytest.approx([0, -3, 0])
    assert seen.points.tolist()[1] == [0, 0, 0]


def test_a_bundle_may_be_turned_to_other_directions():
    w = world(node("Wall", box(0.2, 4, 4), at=(3.1, 0, 0)), node("Side", box(4, 0.2, 4), at=(0, 2.1, 0)), eye())
    seen = look(w, [[1, 0, 0]])
    kept = len(w.rays._known)
    for turn in np.linspace(0, math.pi / 2, 50):
        seen.turn_to([[math.cos(turn), math.sin(turn), 0]])
    seen.refresh()
    assert seen.distances.tolist() == pytest.approx([2.0])
    # a sensor that rotates continuously does not fill the memory
    # -- hits ----------------------------------------------------------------------------------
    assert len(w.rays._known) <= kept + 1
    with pytest.raises(ValueError, match="cannot be 0"):
        seen.turn_to([[0, 0, 0]])


# -- what is seen --------------------------------------------------------------------------


def test_what_does_not_collide_is_not_seen():
    w = world(
        node("Cloud", box(0.2, 4, 4), at=(1, 0, 0), kind=PhysicsType.NO_COLLISION),
        node("Zone", box(0.2, 4, 4), at=(2, 0, 0), kind=PhysicsType.SENSOR),
        node("Wall", box(0.2, 4, 4), at=(3.1, 0, 0)),
        eye(),
    )
    seen = look(w, [[1, 0, 0], *directions(100, 1)])
    assert names(seen)[0] == "Wall"
    assert set(names(seen)) <= {"Wall", None}


def test_a_robot_is_no_obstacle_to_its_own_sensors_but_to_those_of_others():
    one, two = robot("one", at=(0, 0, 0)), robot("two", at=(3, 0, 0))
    for body in (one, two):
        arm = node(f"{body.name}_arm", box(0.1, 1.2, 0.1), at=(0.3, 0, 0), kind=PhysicsType.RIGID_BODY)
        body.attach(arm)
    one.attach(eye())
    w = world(one, two, robots=[one, two], gravity=0)
    for extra in (np.empty((0, 3)), directions(200, 2)):
        seen = look(w, [[1, 0, 0], [-1, 0, 0], *extra])
        assert names(seen)[:2] == ["two", None]
        assert seen.distances[0] == pytest.approx(2.75)
        assert not {"one", "one_arm"} & set(names(seen))


def test_a_robot_that_reaches_into_the_outline_of_another_is_seen():
    """The hand of one is in the bounding box of the other, between its post and its arm."""
    one, two = robot("one", box(0.2, 0.2, 0.2), at=(0, 0, 0)), robot("two", box(0.1, 0.1, 0.1), at=(0, 2, 0))
    one.attach(node("far_arm", box(0.2, 0.2, 0.2), at=(2, 0, 0), kind=PhysicsType.RIGID_BODY))
    two.attach(node("hand", sphere(0.1), at=(1, -2, 0), kind=PhysicsType.RIGID_BODY))
    one.attach(eye())
    w = world(one, two, robots=[one, two], gravity=0)
    for extra in (np.empty((0, 3)), directions(200, 2)):
        seen = look(w, [[1, 0, 0], *extra])
        assert names(seen)[0] == "hand"
        assert seen.distances[0] == pytest.approx(0.9)


@pytest.mark.parametrize("count", [1, 200])
def test_touching_and_nested_boxes_do_not_hide_each_other(count):
    """Coincident faces: stacked crates, a ball in its own bounding box, twins."""
    w = world(
        rigid("Low", box(1, 1, 1), at=(3, 0, 0.5)),
        rigid("High", box(1, 1, 1), at=(3, 0, 1.5)),
        rigid("Left", sphere(0.5), at=(3, 1, 0.5)),
        rigid("Twin", sphere(0.5), at=(3, 1, 0.5)),
        rigid("Tube", CollisionShape(ShapeKind.CYLINDER, (0.5, 0.5)), at=(3, -1, 0.5)),
        rigid("Inner", CollisionShape(ShapeKind.CYLINDER, (0.5, 0.3)), at=(3, -1, 0.5)),
        eye(at=(0, 0, 0.5)),
        gravity=0,
    )
    ways = [[3, 0, 0.1], [3, 0, 0.8], [3, 1, 0], [3, -1, 0], [3, -1, 0.45]]
    seen = look(w, [*ways, *directions(count, 5)])
    assert names(seen)[0] == "Low"
    assert names(seen)[1] == "High"
    assert seen.distances[0] == pytest.approx(2.5 / 3 * math.hypot(3, 0.1))
    assert seen.distances[2:4] == pytest.approx([math.sqrt(10) - 0.5] * 2)
    assert names(seen)[4] == "Tube"


def test_a_viewpoint_within_the_outline_of_another_robot():
    """The sensor is in the bounding box of a ball, not in the ball: the ball is behind and beside it, then a wall."""
    w = world(
        rigid("Ball", sphere(1.0), at=(0, 0, 0)),
        rigid("Wall", box(0.1, 9, 9), at=(1.2, 0, 0)),
        eye(at=(0.8, 0.8, 0.0)),
        gravity=0,
    )
    for count in (1, 300):
        seen = look(w, [[1, 0, 0], [-1, -1, 0], *directions(count, 7)])
        assert names(seen)[:2] == ["Wall", "Ball"]
        assert seen.distances[0] == pytest.approx(0.35)
        assert seen.distances[1] == pytest.approx(0.8 * math.sqrt(2) - 1.0)


# -- moving objects ------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 200])
def test_what_is_put_elsewhere_is_seen_there_at_once(count):
    door = node("Door", box(0.1, 2, 2), at=(2, 0, 0))
    frame = Node("Frame")
    frame.attach(node("Leaf", box(0.1, 2, 2), at=(-2, 0, 0)))
    w = world(door, frame, rigid("Crate", box(1, 1, 1), at=(0, 3, 0)), eye(), gravity=0)
    ways = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], *directions(count, 1)]
    bundle = look(w, ways)
    assert bundle.distances[:3] == pytest.approx([1.95, 1.95, 2.5])
    w.game_object("Door").worldPosition = [5, 0, 0]
    w.game_object("Leaf").worldPosition = [-4, 0, 0]
    w.game_object("Crate").worldPosition = [0, 6, 0]
    bundle.refresh()
    assert bundle.distances[:3] == pytest.approx([4.95, 3.95, 5.5])
    run(w, 0.1)
    bundle.refresh()
    assert bundle.distances[:3] == pytest.approx([4.95, 3.95, 5.5])
    w.game_object("Door").worldOrientation = Euler((0, 0, math.pi / 2)).to_matrix()
    bundle.refresh()
    assert bundle.distances[0] == pytest.approx(4.0)
    w.reset()
    bundle.refresh()
    assert bundle.distances[:3] == pytest.approx([1.95, 1.95, 2.5])


def test_a_body_at_rest_that_is_put_elsewhere_is_seen_there():
    """Sleeping bodies, which the engine no longer updates."""
    w = world(
        node("Ground", box(20, 20, 1), at=(0, 0, -0.5)),
        rigid("Crate", box(1, 1, 1), at=(3, 0, 0.5)),
        eye(at=(0, 0, 0.5)),
    )
    run(w, 2.0)
    w.game_object("Crate").worldPosition = [5, 0, 0.5]
    seen = look(w, [[1, 0, 0]])
    assert seen.distances[0] == pytest.approx(4.5, abs=1e-3)
    run(w, 0.5)
    seen.refresh()
    assert seen.distances[0] == pytest.approx(4.5, abs=1e-3)


def test_rays_follow_a_turning_robot():
    body = robot(at=(0, 0, 0.25))
    body.attach(eye(at=(0.1, 0, 0.1)))
    w = world(
        node("Ground", box(20, 20, 1), at=(0, 0, -0.5)),
        node("Wall", box(0.2, 9, 2), at=(4.1, 0, 1)),
        body,
        robots=[body],
    )
    obj, bundle = w.game_object("robot"), look(w, [[1, 0, 0]], reach=30)
    for _ in range(60):
        obj.drive((0, 0, 0), (0, 0, 0.5), ground=True)
        w.step()
        bundle.refresh()
        yaw = math.atan2(obj.worldOrientation[1][0], obj.worldOrientation[0][0])
        x = w.game_object("eye").worldPosition.x
        assert bundle.distances[0] == pytest.approx((4.0 - x) / math.cos(yaw), abs=1e-3)


# -- single rays ---------------------------------------------------------------------------


def test_a_single_ray_knows_object_point_and_normal():
    w = world(
        node("Ball", sphere(1.0), at=(3, 0, 0)),
        rigid("Rod", CollisionShape(ShapeKind.CYLINDER, (0.5, 2.0)), at=(0, 4, 0)),
        rigid("Egg", CollisionShape(ShapeKind.ELLIPSOID, (0.5, 1.0, 2.0)), at=(-3, 0, 0)),
        node("Ramp", box(4, 4, 0.2), at=(0, 0, -3), turned=(0, math.pi / 6, 0)),
        eye(),
        gravity=0,
    )
    obj = w.game_object("eye")
    hit, point, normal = obj.rayCast([5, 0, 0])
    assert hit.name == "Ball"
    assert tuple(point) == pytest.approx((2, 0, 0), abs=1e-6)
    assert tuple(normal) == pytest.approx((-1, 0, 0), abs=1e-6)
    hit, point, normal = obj.rayCast([0.3, 9, 0], [0.3, 0, 0])
    assert hit.name == "Rod"
    assert tuple(normal) == pytest.approx((0.6, -0.8, 0), abs=1e-6)
    hit, point, normal = obj.rayCast([-5, 0, 1], [0, 0, 1])
    # the gradient of (x/a)^2 + (z/c)^2 at z = 1, x = a sqrt(3)/2
    x, z = math.sqrt(3) / 2 / 0.5, 1.0 / 4.0
    assert tuple(normal) == pytest.approx((x / math.hypot(x, z), 0, z / math.hypot(x, z)), abs=1e-5)
    hit, point, normal = obj.rayCast([0, 0, -9])
    assert tuple(normal) == pytest.approx((math.sin(math.pi / 6), 0, math.cos(math.pi / 6)), abs=1e-5)
    assert point.z == pytest.approx(-3 + 0.1 / math.cos(math.pi / 6), abs=1e-6)


def test_a_ray_to_nowhere_meets_nothing():
    w = world(node("Ball", sphere(1.0), at=(3, 0, 0)), eye())
    obj = w.game_object("eye")
    assert obj.rayCast([0, 0, 0]) == (None, None, None)
    assert obj.rayCast([1.9, 0, 0]) == (None, None, None)
    assert obj.rayCast([1.9, 0, 0], None, 2.1)[0].name == "Ball"


def test_a_world_without_solids():
    w = world(eye())
    seen = look(w, [[1, 0, 0], *directions(100, 1)])
    assert set(seen.distances.tolist()) == {math.inf}
    assert seen.remissions.tolist() == [0.0] * 101


# -- what is refused -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("ways", "reach", "origins", "message"),
    [
        ([[1, 0]], 9, None, "shape"),
        ([[0, 0, 0]], 9, None, r"direction 0 is \[0, 0, 0\]"),
        ([[1, 0, math.nan]], 9, None, "finite"),
        ([[1, 0, 0]], 0, None, "greater than 0"),
        ([[1, 0, 0]], math.nan, None, "greater than 0"),
        ([[1, 0, 0]], -1, None, "greater than 0"),
        ([[1, 0, 0]], 9, [[0, 0, 0], [1, 0, 0]], "1 directions, but 2 origins"),
        ([[1, 0, 0]], 9, [[0, math.inf, 0]], "finite"),
    ],
)
def test_rays_that_make_no_sense_are_refused(ways, reach, origins, message):
    w = world(eye())
    with pytest.raises(ValueError, match=message):
        w.rays.bundle(w.game_object("eye"), ways, reach, origins)


def test_no_rays_at_all():
    w = world(node("Ball", sphere(1.0), at=(3, 0, 0)), eye())
    seen = look(w, [])
    assert seen.points.shape == (0, 3)


def test_a_viewpoint_that_is_no_place_sees_nothing():
    w = world(node("Ball", sphere(1.0), at=(3, 0, 0)), eye(), eye("lost"))
    bundles = [w.rays.bundle(w.game_object(name), [[1, 0, 0]], 9) for name in ("eye", "lost")]
    w.positions[w.game_object("lost").slot] = (math.nan, 0.0, 0.0)
    w.stamp += 1
    w.rays.cast(bundles)
    assert bundles[0].distances[0] == pytest.approx(2.0)
    assert bundles[1].distances[0] == math.inf
