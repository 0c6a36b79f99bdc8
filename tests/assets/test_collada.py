"""Meshes in COLLADA files: their unit, and files that are not what they say."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from morse.assets import load
from morse.assets.errors import AssetError
from morse.assets.meshfiles import read_meshes
from morse.mathutils import Vector

NEEDS_READER = pytest.mark.skipif(importlib.util.find_spec("collada") is None, reason="the extra is not installed")

#: a triangle of 2 x 3 units, in centimetres, twice as large in its scene
TRIANGLE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
 <asset><unit name="cm" meter="0.01"/><up_axis>Y_UP</up_axis></asset>
 <library_geometries><geometry id="g" name="g"><mesh>
  <source id="p"><float_array id="a" count="9">0 0 0 2 0 0 0 3 0</float_array><technique_common>
   <accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
   <param name="Z" type="float"/></accessor></technique_common></source>
  <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
  <triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
 </mesh></geometry></library_geometries>
 <library_visual_scenes><visual_scene id="s"><node id="n"><scale>2 2 2</scale>
  <instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
 <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
"""


@NEEDS_READER
def test_the_unit_of_the_file_is_applied_and_its_axes_are_kept(tmp_path: Path) -> None:
    file = tmp_path / "triangle.dae"
    file.write_text(TRIANGLE)
    corners = [
        node.world_matrix() @ Vector(vertex)
        for node in load(file).nodes()
        if node.mesh is not None
        for vertex in node.mesh.vertices.tolist()
    ]
    found = np.array([list(corner)[:3] for corner in corners])
    assert sorted(map(tuple, found.round(6))) == [(0.0, 0.0, 0.0), (0.0, 0.06, 0.0), (0.04, 0.0, 0.0)]


@NEEDS_READER
@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("not XML", "not XML"),
        ("<robot/>", "not COLLADA: it begins with <robot>"),
        (TRIANGLE.replace('meter="0.01"', 'meter="nan"'), "its unit is 'nan' m"),
        (TRIANGLE.replace("<?xml version=\"1.0\"?>", '<!DOCTYPE a [<!ENTITY b "c">]>'), "defines the entity 'b'"),
        ("<a>" * 300 + "</a>" * 300, "nested more than 200 deep"),
    ],
)  # fmt: skip
def test_damaged_files_are_refused_with_the_reason(tmp_path: Path, text: str, words: str) -> None:
    file = tmp_path / "bad.dae"
    file.write_text(text)
    with pytest.raises(AssetError, match=words):
        read_meshes(file)


def test_without_the_package_the_error_says_how_to_install_it(tmp_path: Path, monkeypatch) -> None:
    file = tmp_path / "triangle.dae"
    file.write_text(TRIANGLE)
    known = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name, *rest: None if name == "collada" else known(name))
    with pytest.raises(AssetError, match=r'pip install "pycollada>=0.8,<1"'):
        read_meshes(file)
