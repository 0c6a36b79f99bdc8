"""Readers of model files that installed packages bring."""

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from morse.assets import loader
from morse.assets.errors import AssetError
from morse.scene import BodySettings, Bone, Library, Mesh, Node, NodeKind

READER = (
    "from morse.scene import Library, Node\ndef read(path):\n    return Library(str(path), roots=[Node('crate')])\n"
)


def loaded(site: Path, name: str, reader: str, points: str = "crate = my_lab:read") -> subprocess.CompletedProcess[str]:
    """Load the model of that name with an installed reader of ``.crate`` files."""
    for path, text in {
        "my_lab.py": reader,
        "my_lab-1.0.dist-info/METADATA": "Metadata-Version: 2.1\nName: my_lab\nVersion: 1.0\n",
        "my_lab-1.0.dist-info/entry_points.txt": f"[morse.formats]\n{points}\n",
        "yard.crate": "",
    }.items():
        (site / path).parent.mkdir(exist_ok=True)
        (site / path).write_text(text, encoding="utf-8")
    program = (
        f"import sys; sys.path.append({str(site)!r})\n"
        f"from morse.assets import find, load\nprint([node.name for node in load(find({name!r})).roots])"
    )
    environment = {**os.environ, "MORSE_RESOURCE_PATH": str(site)}
    return subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True, timeout=60, check=False
    )


@pytest.mark.parametrize("name", ["yard.crate", "yard"])
def test_a_file_of_the_package_is_read(tmp_path: Path, name: str) -> None:
    done = loaded(tmp_path, name, READER)
    assert done.stdout.strip() == "['crate']", done.stderr


def test_a_broken_reader_is_named(tmp_path: Path) -> None:
    done = loaded(tmp_path, "yard.crate", "1 / 0\n")
    assert "the reader of an installed package (my_lab:read) cannot be loaded: ZeroDivisionError" in done.stderr


def test_no_package_takes_scene_scripts_or_files_that_have_a_reader(tmp_path: Path) -> None:
    reader = f"{READER}from morse.assets import formats; from pathlib import Path\n" + (
        "def report(path):\n    print(formats.is_model(Path('scene.py')))\n    return read(path)\n"
    )
    points = "crate = my_lab:report\nPY = my_lab:read\nstl = my_lab:read"
    done = loaded(tmp_path, "yard.crate", reader, points)
    assert done.stdout.split("\n")[0] == "False", done.stderr
    assert "files .py are MORSE's" in done.stderr
    assert "files .stl are MORSE's" in done.stderr


@pytest.mark.parametrize("name", [".crate", "yard.crate"])
def test_a_name_that_is_no_suffix_is_left_out_with_the_right_one(tmp_path: Path, name: str) -> None:
    done = loaded(tmp_path, "yard.crate", READER, f"{name} = my_lab:read")
    assert f"the reader my_lab:read of a package is left out: '{name}' is not a suffix of files" in done.stderr
    assert "such as 'crate'" in done.stderr


def test_what_is_no_reader_is_named(tmp_path: Path) -> None:
    done = loaded(tmp_path, "yard.crate", "read = 3\n")
    assert "the reader of an installed package (my_lab:read) cannot be loaded: TypeError: it is 3" in done.stderr


_CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)


def _shown(vertices: object = _CORNERS, triangles: object = ((0, 1, 2),), material: object = (0,)) -> Library:
    arrays = [
        np.array(indices, np.int32) if isinstance(indices, tuple) else indices for indices in (triangles, material)
    ]
    return Library("", roots=[Node("crate", NodeKind.MESH, mesh=Mesh("crate", vertices, *arrays))])


def _jointed(**changes: Any) -> Library:
    settings: dict[str, Any] = {"position": (0.0, 0.0, 0.0), "rotation": (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)}
    bone = Bone("hinge", changes.pop("parent", -1), **{**settings, **changes}, length=0.0)
    return Library("", roots=[Node("crate", NodeKind.ARMATURE, bones=(bone,))])


def _below_itself() -> Library:
    crate, lid = Node("crate"), Node("lid")
    crate.attach(lid)
    lid.children.append(crate)
    return Library("", roots=[crate])


def _deep() -> Library:
    library = Library("", roots=[Node("crate")])
    for _ in range(2000):
        library.nodes()[-1].attach(Node("crate"))
    return library


def _heavy(mass: float) -> Library:
    return Library("", roots=[Node("crate", body=BodySettings(mass=mass))])


WRONG = {
    "nothing": (lambda: None, "has returned None, expected a morse.scene.Library"),
    "a list": (lambda: [Node("crate")], "expected a morse.scene.Library"),
    "no node": (lambda: Library("", roots=["crate"]), "has returned 'crate' as a node"),
    "triangle": (lambda: _shown(triangles=((0, 1, 3),)), "the node 'crate': the indices 0 to 3, expected 0 to 2"),
    "negative": (lambda: _shown(triangles=((0, 1, -1),)), "the node 'crate': the indices -1 to 1, expected 0 to 2"),
    "material": (lambda: _shown(material=(10**8,)), "the indices 100000000 to 100000000, expected 0 to 1999"),
    "materials": (lambda: _shown(material=(0, 0)), "int32 (2,) as material_index, expected an array of integers (1,)"),
    "flat": (lambda: _shown(_CORNERS[:, :2]), "float32 (3, 2) as vertices, expected an array of numbers (3, 3)"),
    "lists": (lambda: _shown(_CORNERS.tolist()), "as vertices, expected an array of numbers (3, 3)"),
    "not finite": (lambda: _shown(_CORNERS * np.float32("nan")), "not finite is among the vertices"),
    "below itself": (_below_itself, "the node 'crate' is twice in the tree"),
    "deep": (_deep, "its nodes are more than 300 deep"),
    "place": (lambda: Library("", roots=[Node("crate", location=[0.0, 1.0])]), "location=[0.0, 1.0], expected three"),
    "mass": (lambda: _heavy(-1.0), "the node 'crate': its mass is -1.0"),
    "parent": (lambda: _jointed(parent=0), "the bone 'hinge' has the parent 0"),
    "leader": (lambda: _jointed(leader=7), "the bone 'hinge' has the leader 7"),
    "limits": (lambda: _jointed(low=1.0, high=-1.0), "the bone 'hinge' has the limits 1.0 and -1.0"),
    "frame": (lambda: _jointed(rotation=(1.0,)), "the frame of the bone 'hinge'"),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_nodes_of_a_reader_are_refused_by_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, case: str
) -> None:
    make, message = WRONG[case]
    (tmp_path / "yard.crate").touch()
    monkeypatch.setattr(loader, "reader_of", lambda path: lambda path: make())
    with pytest.raises(AssetError, match=rf"yard\.crate: .*{re.escape(message)}"):
        loader.load(tmp_path / "yard.crate")


def test_the_right_nodes_of_a_reader_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "yard.crate").touch()
    for library in (_shown(), _jointed(), _heavy(0.0)):
        monkeypatch.setattr(loader, "reader_of", lambda path, library=library: lambda path: library)
        monkeypatch.setattr(loader, "_cache", {})
        assert loader.load(tmp_path / "yard.crate") is library
