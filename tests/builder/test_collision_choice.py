"""Scripts choose the collision shapes of meshes."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

import morse
from morse.scene import ShapeKind


@pytest.fixture
def star(tmp_path: Path) -> Path:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.3)
    ball.vertices *= (1.0 + 0.15 * np.sin(20 * ball.vertices).prod(axis=1))[:, None]
    ball.export(tmp_path / "star.obj")
    return tmp_path / "star.obj"


def _kinds(star: Path, argument: str, *, moves: bool = True, kind: str = "PassiveObject") -> list[ShapeKind]:
    script = f"from morse.builder import *\nthing = {kind}({str(star)!r}{argument})\n"
    script += "thing.translate(0, 0, 2)\n" + ("" if moves else "thing.static()\n")
    (star.parent / "scene.py").write_text(script + "env = Environment('empty', fastmode=True)\n")
    with morse.load(star.parent / "scene.py") as sim:
        nodes = sim.world.scene.find("thing").walk()
        return [shape.kind for node in nodes for shape in node.shapes or ()]


def test_a_mesh_that_moves_has_few_shapes(star: Path) -> None:
    assert 1 < len(_kinds(star, "")) <= 32
    assert len(_kinds(star, "", moves=False)) > 500


@pytest.mark.parametrize("kind", ["PassiveObject", "Robot"])
def test_shapes_are_chosen(star: Path, kind: str) -> None:
    assert _kinds(star, ", collision='hull'", kind=kind) == [ShapeKind.CONVEX]
    assert _kinds(star, ", collision='box'", kind=kind) == [ShapeKind.BOX]
    assert 1 < len(_kinds(star, ", collision='decompose'", kind=kind)) <= 32
    assert len(_kinds(star, ", collision='mesh'", kind=kind)) > 500


def test_a_wrong_word_is_refused(star: Path) -> None:
    with pytest.raises(Exception, match=r"PassiveObject\(collision\) takes one of .*did you mean 'hull'"):
        _kinds(star, ", collision='hul'")
