"""Materials and textures of MJCF files are drawn."""

import io
import re

import numpy as np
import pytest
from PIL import Image

from morse.assets import load
from morse.mathutils import Vector

MODEL = """<mujoco model="m"><compiler {compiler}/><asset>{assets}</asset><worldbody><body name="b"><freejoint/>
<geom name="g" {geom} material="paint"/></body></worldbody></mujoco>"""


def node_of(library, name="g"):
    return next(node for node in library.nodes() if node.name == name)


def pixels(image):
    with Image.open(io.BytesIO(image.data)) as picture:
        return np.asarray(picture.convert("RGB"))


@pytest.fixture
def write(tmp_path):
    def write(assets, geom='type="box" size="1 2 0.5"', compiler=""):
        file = tmp_path / "m.xml"
        file.write_text(MODEL.format(assets=assets, geom=geom, compiler=compiler))
        return file

    (tmp_path / "pictures").mkdir()
    Image.new("RGB", (4, 4), (200, 10, 20)).save(tmp_path / "pictures" / "red.png")
    return write


@pytest.mark.parametrize(
    ("assets", "compiler"),
    [
        (
            '<texture name="t" type="2d" file="red.png"/><material name="paint" texture="t" specular="0.25"/>',
            'texturedir="pictures"',
        ),
        (
            '<texture type="cube" file="pictures/red.png"/><material name="paint" specular="0.25">'
            '<layer role="rgb" texture="red"/></material>',
            "",
        ),
    ],
)
def test_pictures_of_files_are_shown(write, assets, compiler) -> None:
    (material,) = node_of(load(write(assets, compiler=compiler))).materials
    assert material.specular == 0.25
    assert pixels(material.image)[2, 2].tolist() == [200, 10, 20]


def test_patterns_are_repeated(write) -> None:
    checker = '<texture name="t" type="2d" builtin="checker" width="8" height="8" rgb1="1 0 0" rgb2="0 0 1"/>'
    node = node_of(load(write(f'{checker}<material name="paint" texture="t" texrepeat="3 4"/>')))
    picture = pixels(node.materials[0].image)
    middle = len(picture) // 2
    assert picture[middle // 2, middle // 2].tolist() == [255, 0, 0]
    assert picture[middle // 2, middle + middle // 2].tolist() == [0, 0, 255]
    assert node.mesh.uvs.reshape(-1, 2).max(axis=0).tolist() == [3.0, 4.0]
    # in metres: the box has sides of 2, 4 and 1 m
    uniform = f'{checker}<material name="paint" texture="t" texrepeat="3 3" texuniform="true"/>'
    node = node_of(load(write(uniform)))
    assert node.mesh.uvs.reshape(-1, 2).max(axis=0) == pytest.approx([12.0, 12.0])


def test_texture_coordinates_of_meshes_are_those_of_the_file(write, tmp_path) -> None:
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    lines = [f"v {x} {y} {z}\nvt {x} {y}\n" for x, y, z in corners]
    faces = [(1, 3, 2), (1, 2, 4), (1, 4, 3), (2, 3, 4)]
    lines += ["f " + " ".join(f"{n}/{n}" for n in face) + "\n" for face in faces]
    (tmp_path / "corner.obj").write_text("".join(lines))
    assets = '<mesh file="corner.obj"/><texture name="t" type="2d" file="pictures/red.png"/>'
    node = node_of(load(write(assets + '<material name="paint" texture="t"/>', 'type="mesh" mesh="corner"')))
    matrix = node.local_matrix()
    places = node.mesh.vertices[node.mesh.triangles].reshape(-1, 3)
    for corner, uv in zip(places, node.mesh.uvs.reshape(-1, 2), strict=True):
        place = matrix @ Vector(corner.tolist())
        assert uv.tolist() == pytest.approx([place.x, place.y], abs=1e-5)


@pytest.mark.parametrize(
    ("file", "words"), [("/etc/passwd", "outside|not exist"), ("gone.png", "not exist"), ("m.xml", "not a picture")]
)
def test_a_picture_that_cannot_be_read_is_left_out(write, file, words) -> None:
    library = load(
        write(f'<texture name="t" type="2d" file="{file}"/><material name="paint" texture="t" rgba="1 0 0 1"/>')
    )
    (warning,) = library.warnings
    assert re.fullmatch(f"the texture '{file}' is left out: .*({words}).*", warning)
    (material,) = node_of(library).materials
    assert (material.image, material.color) == (None, (1.0, 0.0, 0.0, 1.0))


TWICE = """<mujoco><asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset><worldbody><body name="arm">
<joint name="j"/><geom name="hull" type="box" size=".5 .5 .5" group="0"/>
<geom name="skin" type="mesh" mesh="m" contype="0" conaffinity="0" group="1"/></body>{more}</worldbody></mujoco>"""


def test_collision_shapes_beside_visual_meshes_are_hidden(tmp_path) -> None:
    file = tmp_path / "m.xml"
    file.write_text(TWICE.format(more=""))
    library = load(file)
    assert (node_of(library, "hull").visible, node_of(library, "skin").visible) == (False, True)
    # the only shape of a body is shown
    file.write_text(TWICE.format(more='<body name="box"><joint/><geom name="lid" size="1" group="0"/></body>'))
    library = load(file)
    assert node_of(library, "hull").visible
    assert node_of(library, "lid").visible
