"""Height fields of MJCF files: contacts, rays, triangles; of a terrain and of a robot."""

import struct
import zlib
from pathlib import Path

import mujoco
import numpy as np
import pytest

import morse
from morse.assets.mjcf import read_mjcf
from morse.scene import ShapeKind

ROWS, COLUMNS, HALF_X, HALF_Y, TOP = 17, 25, 6.0, 4.0, 1.5
#: an inclined plane, whose upper end is higher than half of the top, and a step at the end of the rows
HEIGHTS = np.linspace(0.0, 0.5, COLUMNS)[None, :].repeat(ROWS, axis=0)
HEIGHTS[-1, :] = 1.0
SCENE = """
from morse.builder import *
{lines}
robot = FakeRobot()
robot.translate(-2.0, 0.0, 5.0)
ray = Infrared()
ray.rotate(y={down})
ray.properties(laser_range=30.0)
robot.append(ray)
"""


def xml(asset: str, body: str = "") -> str:
    return (
        f'<mujoco model="hill"><asset><hfield name="land" size="{HALF_X} {HALF_Y} {TOP} 0.3" {asset}/></asset>'
        f'<worldbody><geom name="ground" type="hfield" hfield="land" pos="1 0 0.5"/>{body}</worldbody></mujoco>'
    )


#: the rows of the text begin at the largest Y
TEXT = f'nrow="{ROWS}" ncol="{COLUMNS}" elevation="{" ".join(f"{v:.6f}" for v in HEIGHTS[::-1].ravel())}"'


def looks_down(sim) -> float:
    """The range of the middle ray of the fan, m."""
    ranges = sim.robot.ray.get()["range_list"]
    return ranges[len(ranges) // 2]


def height(x: float) -> float:
    """Of the inclined plane in the world, m."""
    return 0.5 + TOP * 0.5 * (x - 1.0 + HALF_X) / (2.0 * HALF_X)


@pytest.fixture
def terrain(tmp_path: Path) -> Path:
    path = tmp_path / "hill.xml"
    path.write_text(xml(TEXT))
    return path


def test_the_triangles_are_those_of_the_engine(terrain: Path) -> None:
    (ground,) = [node for node in read_mjcf(terrain).nodes() if node.mesh is not None]
    assert ground.shapes[0].kind is ShapeKind.HEIGHT_FIELD
    assert ground.mesh.vertices.min(axis=0) == pytest.approx([-HALF_X, -HALF_Y, 0.0])
    assert ground.mesh.vertices.max(axis=0) == pytest.approx([HALF_X, HALF_Y, TOP])
    corners = ground.mesh.vertices[ground.mesh.triangles].astype(float)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (normals[:, 2] > 0.0).all(), "they look up"
    model = mujoco.MjModel.from_xml_string(terrain.read_text())
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    # at the centres of triangles beside the step, where the two diagonals of a cell differ
    for corner in corners[len(corners) // 2 - COLUMNS :: 7]:
        x, y, z = corner.mean(axis=0)
        hit = mujoco.mj_ray(model, data, [x + 1.0, y, 10.0], [0.0, 0.0, -1.0], None, 1, -1, np.zeros(1, np.int32))
        assert 10.0 - hit - 0.5 == pytest.approx(z, abs=1e-5)


def test_bodies_lie_on_a_terrain_and_rays_hit_it(terrain: Path) -> None:
    script = terrain.parent / "scene.py"
    script.write_text(
        SCENE.format(lines="", down=np.pi / 2)
        + f"rover = ATRV()\nrover.translate(2.0, 0.0, 2.0)\nplace = Pose()\nrover.append(place)\n"
        f"env = Environment({str(terrain)!r})\n"
    )
    with morse.load(script) as sim:
        sim.step(240)
        assert looks_down(sim) == pytest.approx(5.0 - height(-2.0), abs=1e-3)
        found = sim.rover["place"].get()
        # its origin is near the ground
        assert found["z"] == pytest.approx(height(found["x"]), abs=0.15)
        assert found["pitch"] == pytest.approx(-np.arctan(TOP * 0.5 / (2.0 * HALF_X)), abs=0.03)
        state = sim.save()
        sim.step(10)
        wanted = sim.state_hash()
        sim.restore(state)
        sim.step(10)
        assert sim.state_hash() == wanted


def test_a_fixed_robot_brings_its_ground(tmp_path: Path) -> None:
    file = tmp_path / "hill.xml"
    file.write_text(
        xml(TEXT, '<body name="post" pos="4 2 3"><joint name="turn" axis="0 0 1"/><geom size="0.1"/></body>')
    )
    script = tmp_path / "scene.py"
    script.write_text(
        SCENE.format(lines=f"hill = Robot({str(file)!r})", down=np.pi / 2) + "env = Environment('empty')\n"
    )
    with morse.load(script) as sim:
        sim.step(10)
        assert looks_down(sim) == pytest.approx(5.0 - height(-2.0), abs=1e-3)


def png(rows: int, columns: int, data: bytes) -> bytes:
    """A grey image of 8 bits."""

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    head = struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)
    lines = b"".join(b"\0" + data[row * columns : (row + 1) * columns] for row in range(rows))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b"")


def test_heights_of_files(tmp_path: Path) -> None:
    values = np.round(HEIGHTS * 255).astype(np.uint8)
    (tmp_path / "land.png").write_bytes(png(ROWS, COLUMNS, values[::-1].tobytes()))
    (tmp_path / "land.bin").write_bytes(struct.pack("<ii", ROWS, COLUMNS) + HEIGHTS.astype("<f4").tobytes())
    for name in ("land.png", "land.bin"):
        (tmp_path / "hill.xml").write_text(xml(f'file="{name}"'))
        (ground,) = [node for node in read_mjcf(tmp_path / "hill.xml").nodes() if node.mesh is not None]
        assert ground.shapes[0].heights == pytest.approx(TOP * HEIGHTS, abs=TOP / 250.0), name


@pytest.mark.parametrize(
    ("asset", "words"),
    [
        ('nrow="100000" ncol="100000"', "100000 x 100000 points"),
        ('file="bomb.png"', "points, more than"),
        ('file="text.png"', "neither a PNG image nor a binary file"),
        ('file="short.bin"', "neither a PNG image nor a binary file"),
        ('file="gone.png"', "gone.png"),
        ('file="../../../etc/passwd"', "passwd"),
    ],
)
def test_absurd_ones_are_left_out(tmp_path: Path, asset: str, words: str) -> None:
    (tmp_path / "bomb.png").write_bytes(b"\x89PNG\r\n\x1a\n" + struct.pack(">I4sII", 13, b"IHDR", 1 << 30, 1 << 30) * 2)
    (tmp_path / "text.png").write_text("height, height, height")
    (tmp_path / "short.bin").write_bytes(struct.pack("<ii", 1000, 1000) + b"\0" * 64)
    (tmp_path / "hill.xml").write_text(xml(asset, '<body name="a"><joint/><geom size="0.1"/></body>'))
    library = read_mjcf(tmp_path / "hill.xml")
    assert "the hfield 'land'" in " ".join(library.warnings)
    assert words in " ".join(library.warnings)
    assert not any(shape.kind is ShapeKind.HEIGHT_FIELD for node in library.nodes() for shape in node.shapes or ())
