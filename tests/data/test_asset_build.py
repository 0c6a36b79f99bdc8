"""The model files are built by the scripts in tools/assets, with identical bytes every time."""

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import morse
from morse.plugins.blend import read_blend
from tests.kit.programs import python

pytestmark = pytest.mark.long

BUILD = Path(__file__).parents[2] / "tools" / "assets" / "build.py"
DATA = Path(morse.__file__).parent / "data"
needs_blender = [
    pytest.mark.blender,
    pytest.mark.skipif(not (os.environ.get("MORSE_BLENDER") or shutil.which("blender")), reason="no Blender here"),
]


def build(*arguments: str) -> subprocess.CompletedProcess[str]:
    return python(BUILD, *arguments)


@pytest.fixture(scope="module")
def twice(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Two folders with the same models, built one after the other: one with pictures and instances, one without."""
    folders = (tmp_path_factory.mktemp("first"), tmp_path_factory.mktemp("second"))
    for folder in folders:
        done = build("robots/atrv", "environments/outdoors", "--out", str(folder))
        assert done.returncode == 0, done.stderr
    return folders


class TestWithBlender:
    pytestmark = needs_blender

    @pytest.mark.parametrize("name", ["robots/atrv", "environments/outdoors"])
    def test_same_scripts_give_same_bytes(self, twice: tuple[Path, Path], name: str) -> None:
        first, second = ((folder / f"{name}.blend").read_bytes() for folder in twice)
        assert first == second

    @pytest.mark.parametrize("name", ["robots/atrv", "environments/outdoors"])
    def test_files_in_the_package_are_what_the_scripts_make(self, twice: tuple[Path, Path], name: str) -> None:
        made, kept = (read_blend(folder / f"{name}.blend") for folder in (twice[0], DATA))
        assert [node.name for node in made.nodes()] == [node.name for node in kept.nodes()]
        for new, old in zip(made.nodes(), kept.nodes(), strict=True):
            assert new.properties == old.properties
            assert new.body == old.body
            np.testing.assert_allclose(new.location, old.location, atol=1e-5)
            if old.mesh is not None:
                assert new.mesh is not None
                np.testing.assert_array_equal(new.mesh.triangles, old.mesh.triangles)
                np.testing.assert_allclose(new.mesh.vertices, old.mesh.vertices, atol=1e-5)
        assert sorted(made.images) == sorted(kept.images)

    def test_what_stands_in_the_way_of_a_file_is_kept(self, tmp_path: Path) -> None:
        blocked = tmp_path / "robots"
        blocked.write_text("a file where a folder should be")
        done = build("robots/atrv", "--out", str(tmp_path))
        assert done.returncode != 0
        assert blocked.read_text() == "a file where a folder should be"


def test_unknown_model_is_refused_with_the_names_of_the_known_ones(tmp_path: Path) -> None:
    done = build("robots/mosry", "--out", str(tmp_path))
    assert done.returncode == 2
    assert "no such model: robots/mosry" in done.stderr
    assert "robots/morsy" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_every_model_file_has_a_script() -> None:
    scripts = {path.relative_to(BUILD.parent).with_suffix("").as_posix() for path in BUILD.parent.rglob("*.py")}
    files = {path.relative_to(DATA).with_suffix("").as_posix() for path in DATA.rglob("*.blend")}
    assert files <= scripts
