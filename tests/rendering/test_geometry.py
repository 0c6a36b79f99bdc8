"""Positions and depths of objects in images: against formulas, and against rays."""

import itertools
import math
import tracemalloc

import numpy as np
import pytest
from studio import FAR, Studio, Tripod, ball, body, box, floor, triangles

from morse.assets import solids
from morse.kernel.drawing.arrays import CLOSED, MIXED
from morse.kernel.rays import MESH, Fan, Poses, SolidArrays, TriangleMesh
from morse.rendering import DistortedLens, Lens
from morse.rendering.meshes import closed_parts, clusters_of
from morse.scene import Material, PhysicsType
from tests.kernel.twins.rays import ReferenceRays

LENS = Lens(400, 300, 380.0, 350.0, 190.0, 160.0, 0.1, FAR)


@pytest.mark.parametrize("position", [(4, -3, 2), (-3, -4, 1.5), (0.5, 6, 3), (3, 1, -2)])
def test_the_corners_of_a_box_are_where_the_pinhole_formula_has_them(position):
    half = (0.5, 0.8, 0.3)
    made = Studio(box("Box", (0, 0, 0), half))
    tripod = Tripod(position, (0.1, 0, 0))
    picture = made.look(tripod, LENS)
    corners = np.array(list(itertools.product(*((-h, h) for h in half))))
    pixels, _ = tripod.project(corners, LENS)
    rows, columns = np.nonzero(picture.ids >= 0)
    # the centre of a pixel is at 0.5; a corner can be up to one pixel outside the last covered pixel
    for axis, found in ((0, columns), (1, rows)):
        assert found.min() == pytest.approx(pixels[:, axis].min() - 0.5, abs=1.0)
        assert found.max() == pytest.approx(pixels[:, axis].max() - 0.5, abs=1.0)
    # a pixel is covered if its centre is in the hull of the corners
    inside = _in_hull(pixels, np.column_stack([columns, rows]) + 0.5)
    assert inside.all()
    outside = np.argwhere(picture.ids < 0)[:, ::-1] + 0.5
    assert not _in_hull(pixels, outside, slack=1e-3).any()


def _in_hull(corners, points, slack=-1e-3):
    """Whether points are in the convex hull of corners, with a margin in pixels."""
    inside = np.ones(len(points), bool)
    for a, b in itertools.permutations(corners, 2):
        normal = np.array([a[1] - b[1], b[0] - a[0]])
        if np.linalg.norm(normal) < 1e-9 or ((corners - a) @ normal < -1e-6).any():
            continue
        inside &= (points - a) @ (normal / np.linalg.norm(normal)) >= slack
    return inside


def test_the_depth_of_a_plane_in_closed_form():
    made = Studio(floor(0.0, half=200.0))
    tripod = Tripod((0, 0, 2.0), (5, 1, 0.5))
    picture = made.look(tripod, LENS)
    rays = LENS.rays() @ tripod.axes.T.astype(np.float64)
    expected = np.where(rays[..., 2] < 0, -2.0 / rays[..., 2], np.inf)
    seen = expected < FAR * 0.999
    assert seen.mean() > 0.3
    np.testing.assert_allclose(picture.depth[seen], expected[seen], rtol=1e-5)
    assert (picture.depth[expected > FAR * 1.001] == 0).all()
    assert (picture.ids[picture.depth == 0] == -1).all()


def test_the_depth_of_a_sphere_in_closed_form():
    made = Studio(ball("Ball", (0, 0, 0), 1.0, kind=PhysicsType.NO_COLLISION))
    picture = made.look(Tripod((4, 0, 0), (0, 0, 0)), LENS)
    ray = LENS.rays().astype(np.float64)
    a, b, c = (ray**2).sum(axis=2), ray[..., 2] * 4.0, 15.0
    square = b**2 - a * c
    depth = (b - np.sqrt(np.maximum(square, 0))) / a
    # triangles are within the sphere, by at most their sagitta
    inner = square > 0.3
    assert inner.sum() > 1000
    assert np.abs(picture.depth - depth)[inner].max() < 4e-3
    # the silhouette: an ellipse with semi-axes f / sqrt(4^2 - 1)
    columns = np.nonzero((picture.ids >= 0).any(axis=0))[0]
    assert columns[-1] - columns[0] + 1 == pytest.approx(2 * LENS.fx / np.sqrt(15.0), abs=2)


def test_depth_and_ids_are_those_of_rays_pixel_by_pixel():
    rng = np.random.default_rng(4)
    nodes, meshes, places, turns = [], [], [], []
    for number in range(12):
        mesh = [solids.cube(), solids.cone(), solids.torus(), solids.cylinder()][number % 4]
        location, rotation = rng.uniform(-3, 3, 3), rng.uniform(-3, 3, 3)
        node = box(f"Thing{number}", location, (1, 1, 1), rotation=rotation, kind=PhysicsType.NO_COLLISION)
        node.mesh = mesh
        nodes.append(node)
        matrix = np.array([list(row) for row in node.world_matrix()])
        meshes.append(TriangleMesh(mesh.vertices.astype(np.float64), mesh.triangles))
        places.append(matrix[:3, 3])
        turns.append(matrix[:3, :3])
    made = Studio(*nodes)
    tripod = Tripod((9, -4, 5), (0, 0, 0))
    lens = Lens(120, 90, 90.0, 90.0, 60.0, 45.0, 0.1, FAR)
    picture = made.look(tripod, lens)
    count = len(nodes)
    caster = ReferenceRays(
        SolidArrays(
            np.full(count, MESH, np.int32), np.ones((count, 3)), np.zeros(count, np.int64),
            np.array(places), np.array(turns), np.zeros((count, 3)), np.full((count, 3), 3.0), meshes,
        )
    )  # fmt: skip
    poses = Poses(np.zeros((1, 3)), np.eye(3)[None], np.zeros(3))
    caster.gather(np.arange(count), moving=False)
    caster.gather(np.arange(0), moving=True)
    caster.place(poses, moving=False)
    caster.place(poses, moving=True)
    directions = lens.rays().reshape(-1, 3).astype(np.float64)
    lengths = np.linalg.norm(directions, axis=1)
    fan = Fan(
        np.zeros(1, np.int64), tripod.position[None], tripod.axes[None], directions / lengths[:, None], None, False,
        1e3, np.full(1, -5, np.int64),
    )  # fmt: skip
    hits = caster.cast(fan, poses, np.zeros(count, np.int64))
    found, depth = hits.solids[0], hits.distances[0] / lengths
    ids = picture.ids.ravel()
    assert (ids >= 0).mean() > 0.15
    agree = ids == found
    # a pixel whose centre is on an edge may show either side
    assert agree.mean() > 0.9995
    both = agree & (ids >= 0)
    np.testing.assert_allclose(picture.depth.ravel()[both], depth[both], rtol=2e-5)


def test_what_is_nearer_than_near_or_farther_than_far_is_not_seen():
    made = Studio(box("Wall", (3, 0, 0), (0.1, 5, 5)), box("Door", (1, 0, 0), (0.1, 0.1, 0.1)))
    tripod = Tripod((0, 0, 0), (1, 0, 0))
    whole = made.look(tripod, Lens.of_focal_length(64, 64, 32, 0.1, 10))
    assert whole.nodes[whole.ids[32, 32]].name == "Door"
    beyond = made.look(tripod, Lens.of_focal_length(64, 64, 32, 1.5, 10))
    assert beyond.nodes[beyond.ids[32, 32]].name == "Wall"
    nothing = made.look(tripod, Lens.of_focal_length(64, 64, 32, 0.1, 2.5))
    assert (nothing.ids[0] == -1).all()


def test_a_wall_that_reaches_behind_the_camera_fills_what_it_should():
    made = Studio(floor(0.0, half=500.0))
    picture = made.look(Tripod((0, 0, 1), (1, 0, 1)), Lens(64, 64, 32, 32, 32, 32, 0.01, 900))
    assert (picture.ids[33:] == 0).all()
    assert (picture.ids[:32] == -1).all()


@pytest.mark.parametrize("angle", [30.0, 90.0, 150.0])
def test_a_lens_sees_so_much(angle):
    lens = Lens.of_angle(200, 100, np.radians(angle))
    edge = (0 - lens.cx) / lens.fx
    assert 2 * np.degrees(np.arctan(-edge)) == pytest.approx(angle)
    assert lens.fx == lens.fy


def test_the_focal_length_is_that_of_a_sensor_32_mm_wide():
    assert Lens.of_focal_length(256, 128, 35.0).matrix == [[280.0, 0, 127.5], [0, 280.0, 63.5], [0, 0, 1]]


# -- normals of surfaces, compared with the normals of a plane and of a sphere ---------------------

EYE, TARGET = (-4.0, 1.0, 2.5), (0.0, 0.0, 0.4)
PINHOLE = Lens.of_focal_length(120, 90, 32.0, 0.1, FAR)


def normals_of(studio, tripod, lens=PINHOLE):
    return studio.look(tripod, lens, color=False, normals=True)


def test_normals_of_a_plane_point_up():
    tripod = Tripod(EYE, TARGET)
    picture = normals_of(Studio(floor(half=3.0)), tripod)
    above = picture.ids >= 0
    assert 0.3 < above.mean() < 0.9
    np.testing.assert_allclose(picture.normals[above] @ tripod.axes.T, np.full((above.sum(), 3), (0, 0, 1)), atol=1e-6)
    assert (picture.normals[~above] == 0).all()


@pytest.mark.parametrize(
    "lens",
    [
        PINHOLE,
        DistortedLens(120, 90, 120.0, 120.0, 60, 45, 0.1, FAR, "plumb_bob", (-0.2, 0.05, 0.001, 0, 0)),
        DistortedLens.of_fisheye_angle(120, 90, math.radians(190), (0.01, 0, 0, 0), 0.1, FAR),
    ],
    ids=["pinhole", "plumb_bob", "equidistant"],
)
def test_normals_of_a_sphere_are_radial(lens):
    centre, tripod = np.array([0.0, 0.0, 0.4]), Tripod(EYE, TARGET)
    studio = Studio(ball("Ball", centre, 1.5))
    picture = normals_of(studio, tripod, lens)
    found = picture.ids == studio.number(picture, "Ball")
    assert found.sum() > 200
    points = (lens.rays() * picture.depth[..., None])[found] @ tripod.axes.T + EYE
    wanted = (points - centre) / np.linalg.norm(points - centre, axis=1)[:, None]
    cosine = ((picture.normals[found] @ tripod.axes.T) * wanted).sum(axis=1)
    # the facets of the sphere are up to 2 degrees wide; distorted images take the nearest pixel
    assert np.degrees(np.arccos(np.clip(cosine, -1, 1))).mean() < 2.5
    np.testing.assert_allclose(np.linalg.norm(picture.normals[found], axis=1), 1.0, atol=1e-5)


def test_both_sides_of_a_surface_face_the_camera():
    sheet = triangles([(0, -1, -1), (0, 1, -1), (0, 1, 1), (0, -1, 1)], [(0, 1, 2), (0, 2, 3)])
    for side in (-3.0, 3.0):
        tripod = Tripod((side, 0.0, 0.0), (0, 0, 0))
        picture = normals_of(Studio(body("Sheet", sheet)), tripod)
        np.testing.assert_allclose(picture.normals[45, 60], (0, 0, -1), atol=1e-6)


def test_stretched_and_mirrored_boxes_keep_their_normals():
    tripod = Tripod((-4, 0, 0), (0, 0, 0))
    picture = normals_of(Studio(box("Box", (0, 0, 0), (-0.3, 1.0, 2.0))), tripod)
    np.testing.assert_allclose(picture.normals[45, 60], (0, 0, -1), atol=1e-6)


def test_pictures_have_normals_only_on_request():
    assert Studio(floor()).look(Tripod(EYE, TARGET), PINHOLE).normals is None


# -- meshes that are processed in parts ------------------------------------------------------------

SIDE = 100


@pytest.fixture(scope="module")
def hills():
    """20,000 triangles, some of them without corners that exist."""
    x, y = np.meshgrid(np.linspace(-1, 1, SIDE + 1), np.linspace(-1, 1, SIDE + 1))
    points = np.column_stack([x.ravel(), y.ravel(), np.sin(5 * x * y).ravel()])
    first = (np.arange(SIDE)[:, None] * (SIDE + 1) + np.arange(SIDE)).ravel()
    faces = np.concatenate([first[:, None] + (0, 1, SIDE + 2), first[:, None] + (0, SIDE + 2, SIDE + 1)])
    faces[[5, 700], 1] = -1, len(points)
    uvs = np.random.default_rng(1).normal(size=(len(faces), 3, 2)).astype(np.float32)
    return triangles(points, faces, uvs, index=np.arange(len(faces)) % 3)


def peak(mesh, at_once):
    """Bytes that are allocated at most while the mesh is processed."""
    tracemalloc.start()
    try:
        clusters_of(mesh, 3, at_once)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_clusters_do_not_depend_on_the_size_of_the_parts(hills):
    whole = clusters_of(hills, 3, 1 << 17)
    assert len(whole.triangles) == 2 * SIDE * SIDE - 2
    for at_once in (256, 1024, 4096):
        for one, other in zip(whole, clusters_of(hills, 3, at_once), strict=True):
            np.testing.assert_array_equal(one, other)


def test_temporary_memory_is_bounded_by_the_size_of_the_parts(hills):
    count = 2 * SIDE * SIDE
    # results and order, twice while they are joined; a whole mesh takes several hundred bytes per triangle more
    assert peak(hills, 1024) < 200 * count + 1024 * 1000
    assert peak(hills, 1 << 17) > 400 * count


# -- closed parts of meshes, whose back faces are left out -----------------------------------------

POINTS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float32)
FACES = np.array(
    [
        (0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
        (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3),
    ]
)  # fmt: skip
NO_SLOTS = np.zeros(len(FACES), int)


def parts(points, faces, slots=None):
    return closed_parts(points, faces, np.zeros(len(faces), int) if slots is None else slots)


def test_a_cube():
    found = parts(POINTS, FACES)
    assert (found.part == 0).all()
    np.testing.assert_allclose(found.spheres, [[0, 0, 0, np.sqrt(3)]])


def test_corners_of_flat_faces_are_welded():
    """Every triangle has its own vertices, as with normals of its own."""
    found = parts(POINTS[FACES].reshape(-1, 3), np.arange(36).reshape(12, 3))
    assert (found.part == 0).all()


def test_a_ball_far_from_the_origin():
    ball = solids.ico_sphere(3)
    points = np.asarray(ball.vertices, np.float32).reshape(-1, 3) * np.float32(0.1) + np.float32(20)
    assert (parts(points, np.asarray(ball.triangles).reshape(-1, 3)).part == 0).all()


def dented():
    points = np.concatenate([POINTS, [(0, 0, 0.5)]]).astype(np.float32)
    roof = [(1, 5, 8), (5, 7, 8), (7, 3, 8), (3, 1, 8)]
    return points, np.concatenate([FACES[:10], roof])


@pytest.mark.parametrize(
    ("points", "faces", "slots"),
    [
        (POINTS, FACES[1:], NO_SLOTS[1:]),
        (POINTS, FACES[:, ::-1], NO_SLOTS),
        (POINTS, np.concatenate([FACES[:1, ::-1], FACES[1:]]), NO_SLOTS),
        (POINTS, np.concatenate([FACES, FACES[:1]]), np.zeros(13, int)),
        (POINTS[:0], FACES[:0], NO_SLOTS[:0]),
    ],
    ids=["open", "inside out", "one face inside out", "a face twice", "nothing"],
)
def test_parts_that_are_not_closed(points, faces, slots):
    found = parts(points, faces, slots)
    assert (found.part == -1).all()
    assert len(found.spheres) == 0


def test_a_dented_cube():
    points, faces = dented()
    assert (parts(points, faces).kind == CLOSED).all()


def test_a_cube_of_two_materials():
    assert (parts(POINTS, FACES, np.arange(12) // 6).kind == MIXED).all()


def test_parts_are_told_apart():
    points, dent = dented()
    both = np.concatenate([POINTS, points + np.float32(0.5), POINTS * 2 + np.float32(7)])
    found = parts(both, np.concatenate([FACES, dent[1:] + 8, FACES + 8 + len(points)]))
    assert found.part.tolist() == [0] * 12 + [-1] * 13 + [1] * 12
    np.testing.assert_allclose(found.spheres, [[0, 0, 0, np.sqrt(3)], [7, 7, 7, 2 * np.sqrt(3)]], rtol=1e-6)


@pytest.mark.parametrize(("place", "seen"), [(0.0, 1.0), (0.85, 1.0), (5.0, 0.0)], ids=["in", "by the wall", "away"])
def test_walls_are_visible_from_inside(place, seen):
    """A camera in a closed room, at its wall, and one that looks away from it."""
    studio = Studio(body("Room", triangles(POINTS, FACES)))
    picture = studio.look(Tripod((place, 0, 0), (place + 1, 0, 0.1)), Lens.of_focal_length(40, 30, 32.0, 0.1, 50.0))
    assert (picture.ids >= 0).mean() == seen
    if seen:
        # the wall is at 1 m, and the axis of the camera is inclined
        assert picture.depth.max() < 1.2 * (1 - place)


@pytest.mark.parametrize(("opacity", "seen"), [(1.0, 0.0), (0.5, 0.5)], ids=["opaque", "translucent"])
def test_inner_walls_are_visible_through_a_translucent_wall(opacity, seen):
    """The wall in front of the camera has a material of its own, and half of its pixels let the camera see inside."""
    # the triangles of the face at X = -1
    front = np.isin(np.arange(12), (0, 1)).astype(np.int32)
    node = body("Box", triangles(POINTS, FACES, index=front))
    node.materials = [
        Material("Sides", double_sided=True),
        Material("Front", color=(1, 1, 1, opacity), double_sided=True),
    ]
    picture = Studio(node).look(Tripod((-5, 0, 0), (0, 0, 0)), Lens.of_focal_length(40, 40, 64.0, 0.1, 50.0))
    assert (picture.ids >= 0).mean() > 0.2
    # the wall at X = 1 is at a distance of 6 m
    assert (picture.depth[15:25, 15:25] > 5).mean() == seen
