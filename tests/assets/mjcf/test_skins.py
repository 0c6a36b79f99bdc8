"""Skins of MJCF files are drawn in pieces that move with the bodies; damaged ones are left out."""

import math
import struct
import time
from pathlib import Path

import numpy as np
import pytest

import morse
from morse.assets.mjcf import read_mjcf

#: a strip from x = 0 to x = 2 at z = 1 over two links of 1 m; the vertices beside the joint follow both
VERTICES = [(x, y, 1.0) for x in (0.0, 0.95, 1.05, 2.0) for y in (-0.1, 0.1)]
TRIANGLES = [(k + a, k + b, k + c) for k in (0, 2, 4) for a, b, c in ((0, 2, 1), (1, 2, 3))]
BONES = [
    ("upper", (0.0, 0.0, 1.0), [0, 1, 2, 3, 4, 5], [1, 1, 0.6, 0.6, 0.4, 0.4]),
    ("lower", (1.0, 0.0, 1.0), [2, 3, 4, 5, 6, 7], [0.4, 0.4, 0.6, 0.6, 1, 1]),
]
INLINE = (
    f'<skin name="strip" rgba="1 0 0 1" vertex="{" ".join(str(c) for v in VERTICES for c in v)}" '
    f'face="{" ".join(str(c) for t in TRIANGLES for c in t)}">'
    + "".join(
        f'<bone body="{body}" bindpos="{x} {y} {z}" bindquat="1 0 0 0" vertid="{" ".join(map(str, numbers))}" '
        f'vertweight="{" ".join(map(str, weights))}"/>'
        for body, (x, y, z), numbers, weights in BONES
    )
    + "</skin>"
)
MODEL = """<mujoco model="arm"><worldbody><body name="upper" pos="0 0 1"><joint name="a" axis="0 1 0"/>
  <geom size="0.01" mass="1"/><body name="lower" pos="1 0 0"><joint name="b" axis="0 1 0"/>
  <geom size="0.01" mass="0.001"/></body></body></worldbody>%s</mujoco>"""


def skn(*, vertices: int = 8, bones: int = 2, number: int = 0, place: float = 0.0, cut: int = 0) -> bytes:
    """The content of a file of the strip, with other counts, a wrong number of a vertex, or without its end."""
    parts = [struct.pack("<4i", vertices, 0, len(TRIANGLES), bones)]
    points = np.array(VERTICES, "<f4")
    points[0, 0] += place
    triangles = np.array(TRIANGLES, "<i4")
    triangles[0, 0] += number
    parts += [points.tobytes(), triangles.tobytes()]
    for body, origin, numbers, weights in BONES:
        parts += [
            body.encode().ljust(40, b"\0"),
            struct.pack("<7f", *origin, 1, 0, 0, 0),
            struct.pack("<i", len(numbers)),
        ]
        parts += [np.array(numbers, "<i4").tobytes(), np.array(weights, "<f4").tobytes()]
    content = b"".join(parts)
    return content[: len(content) - cut]


def read(folder: Path, skin: str, content: bytes | None = None):
    if content is not None:
        (folder / "strip.skn").write_bytes(content)
    (folder / "arm.xml").write_text(MODEL % skin)
    return read_mjcf(folder / "arm.xml")


def pieces(library) -> dict[str, np.ndarray]:
    return {
        node.parent.name: node.mesh.vertices
        for node in library.nodes()
        if node.name.startswith("strip") and node.parent
    }


@pytest.mark.parametrize(
    ("skin", "content"),
    [
        (f"<deformable>{INLINE}</deformable>", None),
        ('<deformable><skin name="strip" file="strip.skn"/></deformable>', skn()),
        ('<asset><skin name="strip" file="strip.skn"/></asset>', skn()),
    ],
)
def test_pieces_move_with_the_bodies_that_they_follow_most(tmp_path: Path, skin: str, content: bytes | None) -> None:
    library = read(tmp_path, skin, content)
    found = pieces(library)
    # in the frames of the bodies: the triangles between both belong to both
    assert (found["upper"].min(axis=0)[0], found["upper"].max(axis=0)[0]) == pytest.approx((0.0, 1.05))
    assert found["lower"].min(axis=0).tolist() == pytest.approx([-0.05, -0.1, 0.0])
    assert found["lower"].max(axis=0).tolist() == pytest.approx([1.0, 0.1, 0.0])
    assert not any("left out" in warning for warning in library.warnings)


@pytest.mark.parametrize(("keyframe", "is_straight"), [("straight", True), ("bent", False)])
def test_a_camera_sees_the_skin_where_the_body_is(tmp_path: Path, keyframe: str, is_straight: bool) -> None:
    keys = '<keyframe><key name="straight" qpos="0 0"/><key name="bent" qpos="0 1.5708"/></keyframe>'
    read(tmp_path, f"<deformable>{INLINE}</deformable>{keys}")
    (tmp_path / "scene.py").write_text(
        f"from morse.builder import *\nrobot = Robot({str(tmp_path / 'arm.xml')!r}, keyframe={keyframe!r})\n"
        "env = Environment('empty')\nenv.set_gravity(0)\n"
    )
    with morse.load(tmp_path / "scene.py") as sim:
        sim.step(1)

        def is_red(x: float) -> bool:
            """Whether a camera that looks down sees the strip."""
            r, g, _ = sim.picture(9, 9, location=(x, 0.0, 4.0), rotation=(0.0, 0.0, 0.0), focal_length=200.0)[4, 4]
            return int(r) > 2 * int(g)

        assert is_red(0.5)
        assert is_red(1.7) == is_straight


@pytest.mark.parametrize(
    "content",
    [
        b"",
        skn(cut=3),
        skn(vertices=2**31 - 1),
        skn(vertices=-5),
        skn(bones=2**30),
        skn(number=1000),
        skn(place=math.nan),
        skn(place=1e30),
        skn()[:12] + b"\xff\xff\xff\x7f" + skn()[16:],
    ],
)
def test_a_damaged_file_is_left_out(tmp_path: Path, content: bytes) -> None:
    library = read(tmp_path, '<deformable><skin name="strip" file="strip.skn"/></deformable>', content)
    assert not pieces(library)
    assert any("the skin 'strip' is left out" in warning for warning in library.warnings)


@pytest.mark.parametrize(
    "skin",
    [
        INLINE.replace('body="lower"', 'body="nobody"'),
        INLINE.replace('vertid="0 1 2 3 4 5"', 'vertid="0 1 2 3 4"'),
        INLINE.replace('vertid="0 1 2 3 4 5"', 'vertid="0 1 2 3 4 -5"'),
        INLINE.replace('bindquat="1 0 0 0"', 'bindquat="1 0 0"'),
        INLINE.replace('face="0 2', 'face="0 x'),
        INLINE.replace('face="0 2 1', 'face="0 2'),
        '<skin name="strip" file="../../../../etc/passwd"/>',
        '<skin name="strip" file="missing.skn"/>',
        '<skin name="strip"/>',
    ],
)
def test_a_skin_with_mistakes_is_left_out(tmp_path: Path, skin: str) -> None:
    library = read(tmp_path, f"<deformable>{skin}</deformable>")
    assert not pieces(library)
    assert any("the skin 'strip' is left out" in warning for warning in library.warnings)


def test_many_bones_and_many_skins_take_no_time(tmp_path: Path) -> None:
    bones, triangles, vertices = 8000, 200_000, 12_000
    one = np.ones(1, "<f4").tobytes()
    bone = [b"upper".ljust(40, b"\0") + struct.pack("<7f", 0, 0, 1, 1, 0, 0, 0) + struct.pack("<i", 1)] * bones
    content = b"".join(
        [
            struct.pack("<4i", vertices, 0, triangles, bones),
            np.random.default_rng(1).random((vertices, 3)).astype("<f4").tobytes(),
            (np.arange(3 * triangles) % bones).astype("<i4").tobytes(),
            *(text + struct.pack("<i", number) + one for number, text in enumerate(bone)),
        ]
    )
    start = time.process_time()
    library = read(tmp_path, '<deformable><skin name="strip" file="strip.skn"/></deformable>', content)
    # 30 s when each bone went through all triangles, and each name had the suffixes of all before
    assert time.process_time() - start < 8.0
    names = [node.name for node in library.nodes() if node.name.startswith("strip")]
    assert len(names) == len(set(names)) == bones
    assert max(map(len, names)) < 100


def test_all_skins_of_a_model_have_one_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("morse.assets.mjcf.source.MOST_NUMBERS", 100)
    second = INLINE.replace('name="strip"', 'name="second"')
    library = read(tmp_path, f"<deformable>{INLINE}{second}</deformable>")
    assert pieces(library)
    assert any("the skin 'second' is left out: all skins together" in warning for warning in library.warnings)
