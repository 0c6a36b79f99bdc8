from pathlib import Path

import pytest
from blender_program import run_blender

FILES = Path(__file__).with_name("files")
SCRIPT = Path(__file__).with_name("make_scene.py")
VERSIONS = ["4.2", "4.5", "5.0", "5.2"]


@pytest.fixture(scope="session")
def blender_scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The scene of `make_scene.py`, saved by the Blender of this machine."""
    path = tmp_path_factory.mktemp("blender") / "scene.blend"
    run_blender(SCRIPT, str(path))
    return path


@pytest.fixture(params=[*VERSIONS, pytest.param("installed", marks=pytest.mark.blender)])
def scene_path(request: pytest.FixtureRequest) -> Path:
    """That scene, from several versions of Blender."""
    if request.param == "installed":
        return request.getfixturevalue("blender_scene")
    return FILES / f"scene-{request.param}.blend"


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """No cache of an earlier run, and no Blender in the environment."""
    monkeypatch.setenv("MORSE_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv("MORSE_BLENDER", raising=False)
    return tmp_path / "cache"
