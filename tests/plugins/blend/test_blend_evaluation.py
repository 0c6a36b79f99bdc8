"""Modifiers, curves, constraints: evaluated by Blender if available, otherwise listed in the log."""

import ast
import importlib
import io
import subprocess
import sys
from array import array
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from blend_writer import BlendWriter
from blender_program import run_blender

from morse.plugins.blend import read_blend
from morse.scene import Node, NodeKind

pytestmark = pytest.mark.long

SQUARE = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)]
needs_scripts = pytest.mark.skipif(sys.platform == "win32", reason="programs are scripts here")


@pytest.fixture(scope="session")
def unevaluated_scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("unevaluated") / "scene.blend"
    run_blender(Path(__file__).with_name("make_unevaluated.py"), str(path))
    return path


@pytest.fixture(scope="session")
def evaluated(unevaluated_scene: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Node]:
    """The nodes of that scene, evaluated by Blender."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MORSE_CACHE", str(tmp_path_factory.mktemp("cache")))
        library = read_blend(unevaluated_scene)
    assert library.warnings == []
    return {node.name: node for node in library.nodes()}


def bounds(node: Node) -> tuple[list[float], list[float]]:
    assert node.mesh is not None
    return node.mesh.vertices.min(axis=0).tolist(), node.mesh.vertices.max(axis=0).tolist()


@pytest.mark.blender
def test_modifiers(evaluated: dict[str, Node]) -> None:
    assert bounds(evaluated["mirrored"]) == ([-1, 0, 0], [1, 1, 0])
    assert bounds(evaluated["switched off"]) == ([0, 0, 0], [1, 1, 0])
    # three cubes of 2 m side by side
    for name in ("row", "hidden row"):
        assert bounds(evaluated[name]) == ([-1, -1, -1], [5, 1, 1])
        assert evaluated[name].location == [0, 0, 4]
    assert evaluated["row"].mesh is evaluated["twin"].mesh
    assert evaluated["row"].mesh.materials[0].name == "cube"


@pytest.mark.blender
def test_subdivision_is_kept_within_limits(evaluated: dict[str, Node]) -> None:
    # 6 * 4**9 quads would be 3 million triangles
    assert 10_000 < len(evaluated["dense"].mesh.triangles) <= 200_000


@pytest.mark.blender
def test_curves_and_texts(evaluated: dict[str, Node]) -> None:
    low, high = bounds(evaluated["tube"])
    assert low == pytest.approx([-0.25, -0.25, 0], abs=1e-3)
    assert high == pytest.approx([0.25, 0.25, 3], abs=1e-3)
    assert evaluated["text"].kind is NodeKind.MESH
    assert evaluated["path"].kind is NodeKind.EMPTY
    assert evaluated["path"].mesh is None


@pytest.mark.blender
def test_shape_keys(evaluated: dict[str, Node]) -> None:
    assert bounds(evaluated["keyed"]) == ([0, 0, 1], [1, 1, 1])


@pytest.mark.blender
def test_constraints(evaluated: dict[str, Node]) -> None:
    for node in evaluated.values():
        world = [value for row in node.world_matrix() for value in row]
        assert world == pytest.approx(node.properties["world"], abs=1e-5), node.name
    assert evaluated["follower"].location == [7, 8, 9]


@pytest.mark.blender
def test_results_are_kept(unevaluated_scene: Path, own_cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = read_blend(unevaluated_scene)
    (kept,) = (own_cache / "blend").iterdir()

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("Blender was run again")

    monkeypatch.setattr(subprocess, "run", refuse)
    second = read_blend(unevaluated_scene)
    for one, other in zip(first.nodes(), second.nodes(), strict=True):
        assert (one.mesh is None) == (other.mesh is None)
        assert one.mesh is None or np.array_equal(one.mesh.vertices, other.mesh.vertices)
    monkeypatch.undo()
    monkeypatch.setenv("MORSE_CACHE", str(own_cache))
    kept.write_bytes(b"rubbish")
    assert read_blend(unevaluated_scene).warnings == []
    assert kept.stat().st_size > 1000


def mirrored(folder: Path) -> Path:
    """A file that needs Blender."""
    writer = BlendWriter(version=279, pointer_size=8)
    address = writer.address()
    mesh = writer.mesh("mesh", SQUARE, [(0, 1, 2, 3)])
    modifiers = writer.chain(address, "MirrorModifierData", [{"modifier": {"mode": 3}}])
    writer.object("half", mesh, 1, address, modifiers=modifiers)
    path = folder / "half.blend"
    path.write_bytes(writer.finish())
    return path


def program(folder: Path, body: str) -> str:
    """A program in place of Blender; `result` is the file that it writes."""
    path = folder / "pretended"
    path.write_text(f"#!{sys.executable}\nimport os, sys, time\nresult = sys.argv[-2]\n{body}\n")
    path.chmod(0o755)
    return str(path)


def test_without_blender_the_objects_are_named_once(tmp_path: Path) -> None:
    library = read_blend(mirrored(tmp_path), blender="no-such-program")
    (warning,) = library.warnings
    assert warning.startswith("object 'half': ")
    assert "MORSE_BLENDER" in warning
    assert len(library.nodes()[0].mesh.triangles) == 2


@needs_scripts
@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("os.kill(os.getpid(), 11)", "it crashed"),
        ("print('Error: Cannot read file'); sys.exit(3)", "Error: Cannot read file"),
        ("sys.exit(5)", "status 5"),
        ("sys.exit(0)", "status 0"),
        ("open(result, 'wb').write(b'rubbish')", "cannot be read"),
        ("time.sleep(60)", "longer than 0.5 s"),
    ],
)
def test_whatever_blender_does_the_file_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, body: str, reason: str
) -> None:
    monkeypatch.setattr("morse.plugins.blend.evaluation.TIME_LIMIT", 0.5 if "sleep" in body else 60.0)
    library = read_blend(mirrored(tmp_path), blender=program(tmp_path, body))
    (warning,) = library.warnings
    assert "'half'" in warning
    assert reason in warning
    assert len(library.nodes()[0].mesh.triangles) == 2


@needs_scripts
@pytest.mark.parametrize("given", [True, False])
def test_the_program_can_be_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, given: bool) -> None:
    named = program(tmp_path, "print('Error: it is me'); sys.exit(1)")
    monkeypatch.setenv("MORSE_BLENDER", "no-such-program" if given else named)
    library = read_blend(mirrored(tmp_path), blender=named if given else None)
    assert "it is me" in library.warnings[0]


@needs_scripts
def test_a_cache_that_cannot_be_written_costs_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("MORSE_CACHE", str(tmp_path / "file"))
    body = "import numpy; numpy.savez(result, **{'0_matrix': numpy.eye(4)})"
    (warning,) = read_blend(mirrored(tmp_path), blender=program(tmp_path, body)).warnings
    assert "object 'half': Blender evaluated no surface" in warning, "a result without the object is not passed over"


# --- the script inside Blender, whose Python may have no numpy -----------------------------------


@pytest.fixture
def export(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The script, with an empty module in place of Blender's."""
    monkeypatch.setitem(sys.modules, "bpy", ModuleType("bpy"))
    return importlib.reload(importlib.import_module("morse.plugins.blend.blend_export"))


def test_the_script_needs_nothing_but_blender(export: ModuleType) -> None:
    tree = ast.parse(Path(str(export.__file__)).read_text(encoding="utf-8"))
    imported = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    imported |= {str(node.module) for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert {name.partition(".")[0] for name in imported} - set(sys.stdlib_module_names) == {"bpy"}


@pytest.mark.parametrize(
    ("kind", "numbers", "width"),
    [
        ("d", [0.5, -1e300, 3.0, 4.0], 2),
        ("f", [1.5] * 300, 3),
        ("i", [7, -1, 1 << 30], 1),
        ("b", [1, 0, 1], 1),
        ("f", [], 3),
    ],
)
def test_arrays_are_those_of_numpy(export: ModuleType, kind: str, numbers: list[float], width: int) -> None:
    found = np.load(io.BytesIO(export.encoded(array(kind, numbers), width)), allow_pickle=False)
    assert found.ndim == (1 if width == 1 else 2)
    assert found.shape[0] == len(numbers) // width
    assert found.ravel().tolist() == numbers
    assert found.dtype == {"b": np.dtype(bool)}.get(kind, np.dtype(kind))
