"""Model files with too many triangles are refused before they fill the memory."""

import struct
import tracemalloc
from pathlib import Path

import pytest
import trimesh

from morse.assets import triangle_limit
from morse.assets.errors import AssetError
from morse.assets.loader import load
from morse.assets.search import MORSE_COMPONENTS


def test_an_stl_file_of_ten_million_triangles_is_not_read(tmp_path):
    path = tmp_path / "city.stl"
    with path.open("wb") as file:
        file.write(bytes(80) + struct.pack("<I", 10_000_000))
        # without content: the file takes no space on the disk
        file.truncate(84 + 50 * 10_000_000)
    tracemalloc.start()
    try:
        with pytest.raises(AssetError) as refusal:
            load(path)
        assert tracemalloc.get_traced_memory()[1] < 1 << 20
    finally:
        tracemalloc.stop()
    assert "city.stl: it has 10,000,000 triangles" in str(refusal.value)
    assert "the limit of a file is 5,000,000" in str(refusal.value)


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".stl", ".glb"])
def test_all_meshes_of_a_file_count(tmp_path, monkeypatch, suffix):
    path = tmp_path / f"two{suffix}"
    spheres = [trimesh.creation.icosphere(2) for _ in range(2)]
    spheres[1].apply_translation((3, 0, 0))
    whole = trimesh.Scene(spheres) if suffix in (".obj", ".glb") else trimesh.util.concatenate(spheres)
    whole.export(path)
    # each sphere has 20 * 4 ** 2 triangles
    monkeypatch.setattr(triangle_limit, "MOST_TRIANGLES", 639)
    with pytest.raises(AssetError, match="640 triangles, and the limit of a file is 639"):
        load(path)
    monkeypatch.setattr(triangle_limit, "MOST_TRIANGLES", 640)
    assert load(path).roots


def test_a_mesh_that_is_used_twice_counts_once(tmp_path, monkeypatch):
    path = tmp_path / "same.glb"
    scene, ball = trimesh.Scene(), trimesh.creation.icosphere(2)
    scene.add_geometry(ball, geom_name="ball")
    scene.graph.update(frame_to="other", geometry="ball", matrix=trimesh.transformations.translation_matrix((3, 0, 0)))
    scene.export(path)
    monkeypatch.setattr(triangle_limit, "MOST_TRIANGLES", 320)
    shown = [node for root in load(path).roots for node in root.walk() if node.mesh is not None]
    assert len(shown) == 2


def test_blend_files_count_as_well(tmp_path, monkeypatch):
    path = tmp_path / "tree.blend"
    path.write_bytes(Path(MORSE_COMPONENTS, "props", "simplest_tree.blend").read_bytes())
    monkeypatch.setattr(triangle_limit, "MOST_TRIANGLES", 11)
    with pytest.raises(AssetError, match=r"tree\.blend: it has [\d,]+ triangles, and the limit"):
        load(path)
