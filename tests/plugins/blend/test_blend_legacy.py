"""Files of Blender 2.5 to 2.79: faces, game engine settings, groups, materials of the internal renderer."""

import itertools
import struct
import zlib
from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pytest
from blend_writer import BlendWriter

from morse.plugins.blend import read_blend
from morse.scene import Bounds, Library, Mist, Node, NodeKind, PhysicsType

SQUARE = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0)]
#: two slopes of 45 degrees
ROOF = [(1, 0, 1), (1, 2, 1), (0, 2, 0), (0, 0, 0), (2, 0, 0), (2, 2, 0)]
LAYOUTS = list(itertools.product((4, 8), "<>"))


def png() -> bytes:
    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">2I5B", 1, 1, 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(b"\0\xff\0\0"))
        + chunk(b"IEND", b"")
    )


def read(path: Path, writer: BlendWriter) -> Library:
    file = path / "model.blend"
    file.write_bytes(writer.finish())
    return read_blend(file, blender="no-such-program")


def single(path: Path, writer: BlendWriter, **values: object) -> Node:
    writer.object("thing", **values)
    return next(iter(read(path, writer).nodes()))


@pytest.mark.parametrize(("pointer_size", "endian"), LAYOUTS)
def test_every_layout_of_memory_is_read(tmp_path: Path, pointer_size: int, endian: str) -> None:
    writer = BlendWriter(pointer_size=pointer_size, endian=endian)
    red = writer.datablock("MA", "Material", "red", r=0.5, g=0.25, b=0.125, alpha=0.5, spec=0.75)
    mesh = writer.mesh("mesh", [*SQUARE, (1, 0.5, 3)], [(0, 1, 2, 3), (1, 2, 4)], materials=(red,))
    parent = writer.object("parent", loc=[1, 2, 3], rot=[0, 0, pi / 2], size=[2, 2, 2])
    child = writer.address()
    writer.object(
        "child", mesh, 1, child, parent=parent, loc=[1, 0, 0], gameflag=1 << 16 | 1 << 11, gameflag2=0, boundtype=1,
        collision_boundtype=1,
        prop=writer.game_properties(child, Object=True, count=-3, share=0.5, Label="grün"),
        id={"properties": writer.property_group(child, height=1.75, rank=7, note="hé")},
    )  # fmt: skip
    writer.scene(parent, child)
    library = read(tmp_path, writer)
    assert library.warnings == []
    (root,) = library.roots
    (node,) = root.children
    assert node.name == "child"
    assert node.world_matrix().translation == pytest.approx((1, 4, 3))
    assert node.properties == {
        "Object": True,
        "count": -3,
        "share": 0.5,
        "Label": "grün",
        "height": 1.75,
        "rank": 7,
        "note": "hé",
    }
    assert (node.body.type, node.body.bounds) == (PhysicsType.STATIC, Bounds.SPHERE)
    assert node.mesh.vertices[node.mesh.triangles].shape == (3, 3, 3)
    assert node.mesh.materials[0].color == (0.5, 0.25, 0.125, 1.0)
    assert node.mesh.materials[0].specular == 0.75
    assert library.world["gravity"] == pytest.approx(9.8)


def test_faces_are_triangles_and_quads(tmp_path: Path) -> None:
    writer = BlendWriter()
    mesh = writer.mesh("mesh", [*SQUARE, (9, 9, 9)], [(1, 2, 3, 0), (0, 1, 2, 0)])
    # the fourth vertex of the first face is 0: it is the triangle 1, 2, 3
    node = single(tmp_path, writer, data=mesh, type=1)
    corners = node.mesh.vertices[node.mesh.triangles].tolist()
    assert corners == [[[2, 0, 0], [2, 1, 0], [0, 1, 0]], [[0, 0, 0], [2, 0, 0], [2, 1, 0]]]
    # a vertex without a face is left out
    assert len(node.mesh.vertices) == 4


def test_smooth_faces_share_normals_and_flat_ones_do_not(tmp_path: Path) -> None:
    for smooth, expected in ((1, (0, 0, 1)), (0, (-(0.5**0.5), 0, 0.5**0.5))):
        writer = BlendWriter()
        mesh = writer.mesh("roof", ROOF, [(3, 0, 1, 2), (0, 4, 5, 1)], shading=[(0, smooth), (0, smooth)])
        node = single(tmp_path, writer, data=mesh, type=1)
        if not smooth:
            assert node.mesh.normals is None
            continue
        top = node.mesh.vertices[node.mesh.triangles][..., 2] == 1
        assert node.mesh.normals[top] == pytest.approx(np.broadcast_to(expected, (int(top.sum()), 3)), abs=1e-6)


@pytest.mark.parametrize(("limit", "shared"), [(80, False), (100, True)])
def test_auto_smooth_parts_what_bends_more(tmp_path: Path, limit: int, shared: bool) -> None:
    writer = BlendWriter()
    mesh = writer.mesh(
        "roof", ROOF, [(3, 0, 1, 2), (0, 4, 5, 1)], shading=[(0, 1), (0, 1)], flag=1 << 5, smoothresh=limit
    )
    node = single(tmp_path, writer, data=mesh, type=1)
    top = node.mesh.vertices[node.mesh.triangles][..., 2] == 1
    steepness = node.mesh.normals[top][:, 2]
    assert steepness == pytest.approx(np.full(len(steepness), 1.0 if shared else 0.5**0.5), abs=1e-6)


@pytest.mark.parametrize(
    ("flag", "expected"),
    [
        (0, PhysicsType.NO_COLLISION),
        (1 << 18, PhysicsType.OCCLUDER),
        (1 << 16, PhysicsType.STATIC),
        (1 << 16 | 1, PhysicsType.DYNAMIC),
        (1 << 16 | 1 | 1 << 10, PhysicsType.RIGID_BODY),
        (1 << 16 | 1 | 1 << 17, PhysicsType.SOFT_BODY),
        (1 << 16 | 1 << 19, PhysicsType.SENSOR),
        (1 << 16 | 1 << 20, PhysicsType.NAVMESH),
        (1 << 16 | 1 << 22, PhysicsType.CHARACTER),
    ],
)
def test_game_flags_name_the_physics_type(tmp_path: Path, flag: int, expected: PhysicsType) -> None:
    assert single(tmp_path, BlendWriter(), gameflag=flag).body.type is expected


def test_game_settings(tmp_path: Path) -> None:
    flag = 1 << 16 | 1 | 1 << 10 | 1 << 11 | 1 << 1 | 1 << 2 | 1 << 9
    body = single(
        tmp_path, BlendWriter(), gameflag=flag, gameflag2=1 << 3 | 1 << 7, boundtype=5, collision_boundtype=2,
        mass=20.0, inertia=0.5, damping=0.25, rdamping=0.75,
    ).body  # fmt: skip
    assert (body.type, body.bounds, body.compound) == (PhysicsType.RIGID_BODY, Bounds.CYLINDER, True)
    assert (body.mass, body.radius, body.linear_damping, body.angular_damping) == (20, 0.5, 0.25, 0.75)
    assert (body.ghost, body.actor) == (True, True)
    assert (body.lock_location, body.lock_rotation) == ((False, True, False), (False, False, True))


def test_bounds_count_only_when_switched_on(tmp_path: Path) -> None:
    assert single(tmp_path, BlendWriter(), gameflag=1 << 16, collision_boundtype=1).body.bounds is None


def test_custom_properties_win_over_game_properties_and_settings(tmp_path: Path) -> None:
    writer = BlendWriter()
    address = writer.address()
    node = single(
        tmp_path, writer, address=address, gameflag=1 << 16,
        prop=writer.game_properties(address, Label="game", mass=7.0),
        id={"properties": writer.property_group(address, Label="custom", physics_type="SENSOR", mass=3.0)},
    )  # fmt: skip
    # a game property of that name is not a setting
    assert node.properties == {"Label": "custom", "mass": 7.0}
    assert (node.body.type, node.body.mass) == (PhysicsType.SENSOR, 3.0)


def test_groups_and_their_instances(tmp_path: Path) -> None:
    writer = BlendWriter()
    mesh = writer.mesh("mesh", SQUARE, [(1, 2, 3)])
    crate = writer.object("crate", mesh, 1, loc=[0, 0, 1], gameflag=1 << 16 | 1 | 1 << 10, mass=2.0)
    group = writer.address()
    writer.datablock(
        "GR", "Group", "crates", group, gobject=writer.chain(group, "GroupObject", [{"ob": crate}]), dupli_ofs=[0, 0, 1]
    )
    shower = writer.object("shower", transflag=1 << 8, dup_group=group, loc=[5, 0, 0])
    writer.scene(shower)
    library = read(tmp_path, writer)
    assert library.collections == {"crates": ["crate"]}
    assert library.outside_scene == {"crate"}
    copy = next(node for node in library.roots if node.source_name == "crate" and node.name != "crate")
    # a dynamic body has no parent
    assert copy.location == pytest.approx([5, 0, 0])
    assert copy.body.mass == 2.0
    assert copy.mesh is not None


def test_a_group_that_shows_itself_ends(tmp_path: Path) -> None:
    writer = BlendWriter()
    group, shower, other = writer.address(), writer.address(), writer.address()
    writer.object("shower", address=shower, transflag=1 << 8, dup_group=group)
    writer.object("other", address=other)
    members = writer.chain(group, "GroupObject", [{"ob": shower}, {"ob": other}])
    writer.datablock("GR", "Group", "mirrors", group, gobject=members)
    library = read(tmp_path, writer)
    assert "contains an instance of itself" in library.warnings[0]
    assert len(library.nodes()) == 4


def test_groups_of_groups_are_bounded(tmp_path: Path) -> None:
    writer = BlendWriter()
    previous = 0
    for level in range(14):
        group = writer.address()
        shown = {"transflag": 1 << 8, "dup_group": previous} if previous else {}
        members = [writer.object(f"{level}-{number}", **shown) for number in range(4)]
        writer.datablock(
            "GR", "Group", str(level), group, gobject=writer.chain(group, "GroupObject", [{"ob": m} for m in members])
        )
        previous = group
    # 4 to the power of 14 copies
    library = read(tmp_path, writer)
    assert any("the remaining objects are ignored" in warning for warning in library.warnings)
    assert len(library.nodes()) < 300_000


def material(writer: BlendWriter, image_name: str, data: bytes | None, **values: object) -> int:
    image, packed = writer.address(), 0
    if data is not None:
        content = writer.data(image, None, data)
        packed = writer.data(image, "PackedFile", {"size": len(data), "data": content})
    writer.datablock("IM", "Image", "image", image, name=image_name, packedfile=packed, source=1)
    texture = writer.datablock("TE", "Tex", "texture", type=8, ima=image)
    address = writer.address()
    slot = writer.data(address, "MTex", {"mapto": 1, "tex": texture})
    return writer.datablock(
        "MA", "Material", "paint", address, r=0.5, g=0.5, b=0.5, alpha=1.0, mtex=[0, slot], **values
    )


def painted(path: Path, image_name: str, data: bytes | None) -> tuple[Library, object]:
    writer = BlendWriter()
    mesh = writer.mesh("mesh", SQUARE, [(1, 2, 3)], materials=(material(writer, image_name, data),))
    writer.object("thing", mesh, 1)
    library = read(path, writer)
    return library, next(iter(library.nodes())).mesh.materials[0]


def test_packed_textures_are_known_by_their_first_bytes(tmp_path: Path) -> None:
    for data, mime in ((png(), "image/png"), (b"\xff\xd8\xff\xe0rest", "image/jpeg")):
        library, paint = painted(tmp_path, "//wrong.tga", data)
        assert (paint.image.data, paint.image.mime) == (data, mime)
        assert paint.color == (1, 1, 1, 1)
        assert library.images["image"] is paint.image
        assert library.warnings == []


def targa() -> bytes:
    """One red pixel, bottom row first, 24 bits."""
    return struct.pack("<BBB5xHHHHBB", 0, 0, 2, 0, 0, 1, 1, 24, 0) + b"\0\0\xff"


@pytest.mark.parametrize("packed", [True, False])
def test_targa_textures_become_png(tmp_path: Path, packed: bool) -> None:
    (tmp_path / "wood.TGA").write_bytes(targa())
    library, paint = painted(tmp_path, "//wood.TGA", targa() if packed else None)
    assert paint.image.mime == "image/png"
    assert paint.image.data.startswith(b"\x89PNG\r\n\x1a\n")
    assert library.warnings == []


def test_a_damaged_targa_texture_is_named(tmp_path: Path) -> None:
    library, paint = painted(tmp_path, "//wood.tga", targa()[:-1])
    assert paint.image is None
    assert library.warnings == ["the image 'image' is left out: it is cut off"]


def test_tiff_textures_are_named_in_one_message(tmp_path: Path) -> None:
    library, paint = painted(tmp_path, "//wood.tif", b"II*\0 and so on")
    assert paint.image is None
    assert library.warnings == ["TIFF images are not read (save them as PNG): 'image'"]


@pytest.mark.parametrize("stored", ["//textures/wood.png", "//textures\\wood.png", "//../model/textures/wood.png"])
def test_textures_beside_the_file(tmp_path: Path, stored: str) -> None:
    folder = tmp_path / "model"
    (folder / "textures").mkdir(parents=True)
    (folder / "textures" / "wood.png").write_bytes(png())
    library, paint = painted(folder, stored, None)
    assert paint.image.data == png()
    assert library.warnings == []


@pytest.mark.parametrize(
    ("stored", "data", "sentence"),
    [
        ("//missing.png", None, "cannot be read"),
        ("//folder", None, "is not a file"),
        ("//secret.txt", None, "neither PNG, JPEG nor TGA"),
        ("\\\\server\\share\\wood.png", None, "cannot be resolved"),
        ("//nul\udcff.png", None, "cannot be"),
        ("", None, "cannot be resolved"),
        ("wood.tga", b"\0\0\2 no picture", "neither PNG, JPEG nor TGA"),
    ],
)
def test_textures_that_cannot_be_shown_are_named(
    tmp_path: Path, stored: str, data: bytes | None, sentence: str
) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "secret.txt").write_text("not for the viewer")
    name = stored.encode("utf-8", "surrogateescape")
    library, paint = painted(tmp_path, name, data)
    assert paint.image is None
    (warning,) = library.warnings
    assert "image" in warning
    assert sentence in warning
    assert "not for the viewer" not in warning


@pytest.fixture
def private(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An image outside the folder of the model, and a link to it inside."""
    monkeypatch.delenv("MORSE_RESOURCE_PATH", raising=False)
    monkeypatch.delenv("MORSE_IMAGE_PATH", raising=False)
    monkeypatch.delenv("MORSE_ROOT", raising=False)
    picture = tmp_path / "private" / "photo.png"
    for folder in (picture.parent, tmp_path / "model"):
        folder.mkdir()
    picture.write_bytes(png())
    (tmp_path / "model" / "link.png").symlink_to(picture)
    return picture


def stored_paths(picture: Path) -> list[str]:
    return [str(picture), "//../private/photo.png", "..\\private\\photo.png", "//link.png"]


@pytest.mark.parametrize("number", range(4))
def test_a_model_reads_no_image_outside_of_its_folder(private: Path, number: int) -> None:
    stored = stored_paths(private)[number]
    library, paint = painted(private.parents[1] / "model", stored, None)
    assert paint.image is None
    (warning,) = library.warnings
    assert "is outside of the folder of the model" in warning
    assert "MORSE_IMAGE_PATH" in warning


def test_whether_a_file_outside_exists_is_not_told(private: Path) -> None:
    said = [
        painted(private.parents[1] / "model", f"//../private/{name}.png", None)[0].warnings
        for name in ("photo", "none")
    ]
    assert said[0][0].replace("photo", "none") == said[1][0]


@pytest.mark.parametrize("variable", ["MORSE_IMAGE_PATH", "MORSE_RESOURCE_PATH"])
@pytest.mark.parametrize("number", range(4))
def test_the_user_can_allow_more_folders(
    private: Path, number: int, variable: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(variable, f"/nowhere:{private.parent}")
    library, paint = painted(private.parents[1] / "model", stored_paths(private)[number], None)
    assert paint.image is not None
    assert library.warnings == []


def test_polygons_can_show_images_of_their_own(tmp_path: Path) -> None:
    writer = BlendWriter()
    image = writer.address()
    packed = writer.data(image, "PackedFile", {"size": len(png()), "data": writer.data(image, None, png())})
    writer.datablock("IM", "Image", "poster", image, packedfile=packed, source=1)
    plain = writer.datablock("MA", "Material", "plain", r=0.5, g=0.5, b=0.5, alpha=1.0)
    asking = writer.datablock("MA", "Material", "asking", r=0.5, g=0.5, b=0.5, alpha=1.0, mode=1 << 11)
    address = writer.address()
    rows = [{"uv": [0.0, 0, 1, 0, 1, 1, 0, 0], "tpage": page} for page in (image, image, 0)]
    layer = {"type": 5, "data": writer.data(address, "MTFace", *rows)}
    fdata = {"layers": writer.data(address, "CustomDataLayer", layer), "totlayer": 1}
    slots = writer.pointers(address, [plain, asking])
    points = writer.data(address, "MVert", *({"co": vertex} for vertex in SQUARE))
    faces = writer.data(address, "MFace", *({"v1": 1, "v2": 2, "v3": 3, "mat_nr": slot} for slot in (0, 1, 1)))
    writer.datablock(
        "ME", "Mesh", "mesh", address, totvert=4, totface=3, totcol=2, mvert=points, mface=faces, mat=slots, fdata=fdata
    )
    mesh = single(tmp_path, writer, data=address, type=1).mesh
    shown = [mesh.materials[index] for index in mesh.material_index]
    assert [entry.name for entry in shown] == ["plain", "asking", "asking"]
    assert [entry.image is not None for entry in shown] == [False, True, False]
    assert mesh.uvs[0].tolist() == [[0, 0], [1, 0], [1, 1]]


def test_old_materials(tmp_path: Path) -> None:
    writer = BlendWriter()
    glass = writer.datablock(
        "MA", "Material", "glass", r=0.5, g=0.25, b=1.0, alpha=0.25, emit=0.5, mode=1 << 16 | 1 << 2, game={"flag": 16}
    )
    opaque = writer.datablock("MA", "Material", "opaque", alpha=0.25, r=0.5, g=0.5, b=0.5)
    mesh = writer.mesh("mesh", SQUARE, [(1, 2, 3)], materials=(glass, opaque, 0))
    first, second, third = single(tmp_path, writer, data=mesh, type=1).mesh.materials
    assert first.color == (0.5, 0.25, 1, 0.25)
    assert first.emission == (0.25, 0.125, 0.5)
    assert (first.shadeless, first.double_sided) == (True, False)
    assert second.color[3] == 1
    assert third is None


def test_old_lamps_cameras_and_worlds(tmp_path: Path) -> None:
    writer = BlendWriter()
    lamp = writer.datablock(
        "LA", "Lamp", "lamp", type=2, energy=1.5, dist=20.0, r=1.0, g=1.0, b=1.0, spotsize=90.0, mode=1 << 13
    )
    camera = writer.datablock("CA", "Camera", "camera", lens=35.0, clipsta=0.25, clipend=50.0)
    world = writer.datablock(
        "WO", "World", "world", horr=0.25, horg=0.5, horb=0.75, mode=1, misi=0.5, miststa=2.0, mistdist=8.0, mistype=1
    )
    spot, eye = writer.object("spot", lamp, 10), writer.object("eye", camera, 11)
    writer.scene(spot, eye, world=world)
    library = read(tmp_path, writer)
    nodes = {node.name: node for node in library.nodes()}
    light = nodes["spot"].light
    assert (light.type, light.energy, light.distance, light.casts_shadow) == ("SPOT", 1.5, 20, True)
    assert light.spot_size == pytest.approx(pi / 2)
    assert (nodes["eye"].camera.focal_length, nodes["eye"].camera.clip_end) == (35, 50)
    assert library.world["horizon_color"] == (0.25, 0.5, 0.75)
    assert library.world["mist"] == Mist(True, 0.5, 2.0, 8.0, "LINEAR")


def test_before_scales_multiplied_delta_sizes_were_added(tmp_path: Path) -> None:
    node = single(tmp_path, BlendWriter(version=256), size=[1, 2, 3], dsize=[0.5, 0, -1])
    assert node.scale == [1.5, 2, 2]


def test_rotation_modes(tmp_path: Path) -> None:
    turn = [cos(pi / 4), 0, 0, sin(pi / 4)]
    by_quaternion = single(tmp_path, BlendWriter(), rotmode=0, quat=turn)
    by_axis = single(tmp_path, BlendWriter(), rotmode=-1, rotAxis=[0, 0, 2], rotAngle=pi / 2, drotAxis=[0, 1, 0])
    for node in (by_quaternion, by_axis):
        assert node.rotation_euler == pytest.approx([0, 0, pi / 2], abs=1e-6)


def test_hidden_from_renders_is_invisible(tmp_path: Path) -> None:
    assert not single(tmp_path, BlendWriter(), restrictflag=1 << 2).visible
    assert single(tmp_path, BlendWriter(), restrictflag=1 << 0).visible


def test_nodes_come_in_the_order_of_the_scene(tmp_path: Path) -> None:
    writer = BlendWriter()
    first, second, third = (writer.object(name) for name in "abc")
    writer.scene(third, first)
    library = read(tmp_path, writer)
    assert [node.name for node in library.roots] == ["c", "a", "b"]
    assert library.outside_scene == {"b"}
    assert second


def test_kinds_of_objects(tmp_path: Path) -> None:
    assert single(tmp_path, BlendWriter(), type=25).kind is NodeKind.ARMATURE
    assert single(tmp_path, BlendWriter(), type=12).kind is NodeKind.EMPTY


def test_edge_split_is_shading(tmp_path: Path) -> None:
    writer = BlendWriter()
    mesh = writer.mesh("roof", ROOF, [(3, 0, 1, 2), (0, 4, 5, 1)], shading=[(0, 1), (0, 1)])
    address = writer.address()
    split = [{"modifier": {"mode": 1}, "split_angle": pi / 6, "flags": 2}]
    writer.object("thing", mesh, 1, address, modifiers=writer.chain(address, "EdgeSplitModifierData", split))
    library = read(tmp_path, writer)
    assert library.warnings == []
    normals = next(iter(library.nodes())).mesh.normals
    assert np.abs(normals[..., 2]) == pytest.approx(np.full((4, 3), 0.5**0.5), abs=1e-6)


@pytest.mark.parametrize(("pointer_size", "endian"), LAYOUTS)
def test_polygons_of_any_size(tmp_path: Path, pointer_size: int, endian: str) -> None:
    writer = BlendWriter(pointer_size=pointer_size, endian=endian, version=270)
    image, address = writer.address(), writer.address()
    packed = writer.data(image, "PackedFile", {"size": len(png()), "data": writer.data(image, None, png())})
    writer.datablock("IM", "Image", "poster", image, packedfile=packed, source=1)
    ell = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (1, 1, 0), (1, 2, 0), (0, 2, 0)]
    corners = [0, 1, 2, 3, 4, 5, 2, 1, 0]
    uvs = [{"uv": [x / 2, y / 2]} for x, y, _ in (ell[k] for k in corners)]
    layers = [{"type": 16, "data": writer.data(address, "MLoopUV", *uvs), "active_rnd": 0}]
    textures = [{"type": 15, "data": writer.data(address, "MTexPoly", {"tpage": 0}, {"tpage": image})}]
    writer.datablock(
        "ME", "Mesh", "mesh", address, totvert=6, totpoly=2, totloop=9,
        mvert=writer.data(address, "MVert", *({"co": vertex} for vertex in ell)),
        mloop=writer.data(address, "MLoop", *({"v": corner} for corner in corners)),
        mpoly=writer.data(address, "MPoly", {"totloop": 6}, {"loopstart": 6, "totloop": 3}),
        ldata={"layers": writer.data(address, "CustomDataLayer", *layers), "totlayer": 1},
        pdata={"layers": writer.data(address, "CustomDataLayer", *textures), "totlayer": 1},
    )  # fmt: skip
    mesh = single(tmp_path, writer, data=address, type=1).mesh
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    areas = np.cross(b - a, c - a)[:, 2] / 2
    assert areas[:4].min() > 0
    assert areas[:4].sum() == pytest.approx(3)
    # the second polygon has the opposite orientation
    assert areas[4:].tolist() == [-1]
    assert mesh.uvs * 2 == pytest.approx(mesh.vertices[mesh.triangles][..., :2])
    shown = [mesh.materials[index] for index in mesh.material_index]
    assert [entry is not None and entry.image is not None for entry in shown] == [False] * 4 + [True]


def test_marked_game_properties_are_remembered(tmp_path: Path) -> None:
    writer = BlendWriter()
    address = writer.address()
    items = [{"name": name, "type": 1, "flag": flag, "data": 3} for name, flag in (("a", 0), ("b", 1), ("c", 1))]
    writer.scene(writer.object("thing", address=address, prop=writer.chain(address, "bProperty", items)))
    (node,) = read(tmp_path, writer).roots
    assert node.properties == {"a": 3, "b": 3, "c": 3}
    assert node.debug == ("b", "c")
