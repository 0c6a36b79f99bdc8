"""Invalid meshes, images and numbers."""

import math

import numpy as np
import pytest
from studio import Studio, Tripod, body, box, floor, triangles

from morse.rendering import Lens
from morse.scene import Image, Material, PhysicsType

LENS = Lens.of_focal_length(64, 64, 32.0, 0.1, 50)
ABOVE = Tripod((0, 0, 8), (0, 0, 0), up=(0, 1, 0))
SQUARE = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"width": 0}, "width"),
        ({"width": 10**6}, "width"),
        ({"height": -3}, "height"),
        ({"width": 8000, "height": 8000}, "at most"),
        ({"fx": 0.0}, "focal"),
        ({"fy": math.nan}, "focal"),
        ({"cx": math.inf}, "cx"),
        ({"near": 0.0}, "near"),
        ({"near": math.nan}, "near"),
        ({"far": 0.01}, "far"),
        ({"far": math.inf}, "far"),
    ],
)
def test_lenses_that_make_no_picture(changed, said):
    fine = {"width": 4, "height": 4, "fx": 4.0, "fy": 4.0, "cx": 2.0, "cy": 2.0}
    with pytest.raises(ValueError, match=said):
        Lens(**{**fine, **changed})


@pytest.mark.parametrize("angle", [0.0, -1.0, math.pi, 4.0, math.nan])
def test_angles_of_view_that_there_are_not(angle):
    with pytest.raises(ValueError, match="field of view"):
        Lens.of_angle(4, 4, angle)


def looked_at(mesh, **more):
    node = body("Odd", mesh, kind=PhysicsType.NO_COLLISION, **more)
    return Studio(floor(-2.0), node).look(ABOVE, LENS)


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf, 3e38])
def test_corners_that_are_no_places(number):
    points = [*SQUARE, (number, 0, 0), (0, number, 1)]
    picture = looked_at(triangles(points, [[0, 1, 2], [0, 2, 3], [0, 1, 4], [1, 4, 5]]))
    assert picture.nodes[picture.ids[32, 32]].name == "Odd"
    assert picture.nodes[picture.ids[2, 2]].name == "Floor"


def test_corners_that_the_mesh_does_not_have():
    picture = looked_at(triangles(SQUARE, [[0, 1, 2], [0, 2, 3], [0, 1, 99], [-7, 1, 2]]))
    assert picture.nodes[picture.ids[32, 32]].name == "Odd"


def test_triangles_without_area():
    picture = looked_at(triangles(SQUARE, [[0, 0, 0], [0, 1, 1], [0, 1, 2], [0, 2, 3]]))
    assert picture.nodes[picture.ids[32, 32]].name == "Odd"


@pytest.mark.parametrize("fill", [math.nan, math.inf, 1e30, 0.0])
def test_normals_and_texture_coordinates_that_mean_nothing(fill):
    odd = np.full((2, 3, 3), fill, np.float32)
    mesh = triangles(SQUARE, [[0, 1, 2], [0, 2, 3]], uvs=odd[..., :2].copy(), normals=odd)
    picture = looked_at(mesh, material=Material("", image=Image("no picture", b"nonsense", "image/png")))
    assert picture.nodes[picture.ids[32, 32]].name == "Odd"


def test_slots_that_there_are_not():
    mesh = triangles(SQUARE, [[0, 1, 2], [0, 2, 3]], index=[-5, 3])
    assert looked_at(mesh).ids[32, 32] >= 0


@pytest.mark.parametrize("data", [b"", b"\x89PNG\r\n\x1a\n" + b"\0" * 40, b"\xff\xd8\xff\xe0 half a JPEG"])
def test_a_picture_that_cannot_be_read_is_said_once_and_replaced(data, caplog):
    image = Image("wall.png", data, "image/png")
    material = Material("", image=image, shadeless=True)
    uvs = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], np.float32)
    mesh = triangles(SQUARE, [[0, 1, 2], [0, 2, 3]], uvs=uvs)
    made = Studio(body("A", mesh, material=material), body("B", mesh, (4, 0, 0), material=material))
    colors = {tuple(c) for c in made.look(ABOVE, LENS).rgb[28:36, 28:36].reshape(-1, 3).tolist()}
    made.look(ABOVE, LENS)
    assert len(colors) > 1
    assert sum("wall.png" in record.message for record in caplog.records) == 1


def test_a_texture_on_a_mesh_without_coordinates():
    material = Material("", image=Image("no picture", b"", "image/png"))
    assert looked_at(triangles(SQUARE, [[0, 1, 2], [0, 2, 3]]), material=material).ids[32, 32] >= 0


def test_materials_of_impossible_numbers():
    odd = Material("", color=(math.nan, 5.0, -3.0, 1.0), emission=(math.inf, 0, 0), metallic=math.nan, roughness=-1.0)
    assert looked_at(triangles(SQUARE, [[0, 1, 2], [0, 2, 3]]), material=odd).ids[32, 32] >= 0


def test_a_camera_that_is_nowhere():
    made = Studio(floor())
    tripod = Tripod((0, 0, 8), (0, 0, 0), up=(0, 1, 0))
    tripod.position[:] = math.nan
    picture = made.look(tripod, LENS)
    assert (picture.ids == -1).all()


def test_an_empty_world():
    picture = Studio().look(ABOVE, LENS)
    assert (picture.ids == -1).all()
    assert picture.rgb.shape == (64, 64, 3)


def test_many_triangles_in_one_place():
    count = 60_000
    points = np.tile(np.array(SQUARE, np.float32), (count, 1)) * np.repeat(np.linspace(0.01, 1, count), 4)[:, None]
    faces = np.arange(count)[:, None] * 4 + np.array([[0, 1, 2]])
    picture = looked_at(triangles(points, faces))
    assert picture.nodes[picture.ids[35, 35]].name == "Odd"


def test_things_far_from_everything_cast_no_endless_shadow_map():
    made = Studio(floor(), box("Far", (9e5, 0, 0), (1, 1, 1), kind=PhysicsType.NO_COLLISION))
    assert made.look(ABOVE, LENS).ids[32, 32] >= 0


def test_what_is_drawn_needs_little_memory_for_each_triangle():
    """A hundred thousand triangles: the memory for ten million is extrapolated."""
    side = 224
    x, y = np.meshgrid(np.linspace(-1, 1, side + 1), np.linspace(-1, 1, side + 1))
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    first = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    faces = np.concatenate(
        [
            np.column_stack([first, first + 1, first + side + 2]),
            np.column_stack([first, first + side + 2, first + side + 1]),
        ]
    )
    studio = Studio(body("Fine", triangles(points, faces), kind=PhysicsType.NO_COLLISION))
    picture = studio.look(ABOVE, LENS, color=False)
    assert picture.nodes[picture.ids[32, 32]].name == "Fine"
    drawing = studio.renderer.contents.scenery.drawing
    count = len(drawing.triangles)
    assert count == 2 * side * side
    # neighbours share corners: less than one corner of 32 bytes per triangle, and 16 bytes for the triangle
    kept = sum(array.nbytes for array in drawing if array is not None)
    assert kept / count < 56
