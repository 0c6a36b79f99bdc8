"""Clients cannot make the simulation read any file of the disk."""

from pathlib import Path

import pytest

import morse
from morse.builder import PassiveObject
from morse.core.exceptions import MorseRPCInvokationError
from morse.services.foreign_models import check_model
from morse.services.population_services import PopulationServices
from pymorse import MorseServiceFailed


@pytest.fixture
def folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("here", "project", "listed", "elsewhere"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "m.obj").write_text("v 0 0 0\n")
    (tmp_path / "project" / "link.obj").symlink_to(tmp_path / "elsewhere" / "m.obj")
    monkeypatch.chdir(tmp_path / "here")
    return tmp_path


@pytest.mark.parametrize("kind", ["ATRV", "props/crates", "m.obj", "robots/atrv.blend"])
def test_names_are_looked_up_in_the_usual_folders(kind: str) -> None:
    check_model(kind, [])


def test_full_paths_lead_into_the_folders_of_the_user(folders: Path) -> None:
    for name in ("here", "project", "listed"):
        check_model(str(folders / name / "m.obj"), [str(folders / "project"), folders / "listed"])


@pytest.mark.parametrize(
    "kind",
    ["{0}/elsewhere/m.obj", "{0}/project/link.obj", "{0}/project/../elsewhere/m.obj", "../elsewhere/m.obj", "~/m.obj",
     "//server/share/m.obj", "\\\\server\\share\\m.obj", "C:\\m.obj", "file:///m.obj", "http://localhost/m.obj",
     "/dev/stdin.obj", "/m\0.obj"],
)  # fmt: skip
def test_other_files_are_not_read(folders: Path, kind: str) -> None:
    class Simulation:
        def spawn(self, *_: object) -> None:
            raise AssertionError("it must not be read")

        def delete(self, name: str) -> None:
            raise AssertionError

    services = PopulationServices(Simulation(), lambda: [str(folders / "project")])
    with pytest.raises(MorseRPCInvokationError, match="add its folder to MORSE_RESOURCE_PATH"):
        services.spawn("x", kind.format(folders))


def test_a_running_simulation_knows_the_folders_of_the_user(folders: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    triangle = "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n"
    for name in ("listed", "elsewhere"):
        (folders / name / "m.obj").write_text(triangle)
    (folders / "scene.py").write_text("from morse.builder import *\nenv = Environment('empty')\n")
    monkeypatch.setenv("MORSE_RESOURCE_PATH", str(folders / "listed"))
    with morse.load(folders / "scene.py") as sim:
        assert sim.rpc("simulation", "spawn", "one", str(folders / "listed" / "m.obj")) == "one"
        with pytest.raises(MorseServiceFailed, match="MORSE_RESOURCE_PATH"):
            sim.rpc("simulation", "spawn", "two", str(folders / "elsewhere" / "m.obj"))


def test_only_the_script_searches_the_folders_around_it(folders: Path) -> None:
    triangle = "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n"
    (folders / "near.obj").write_text(triangle)
    (folders / "scene.py").write_text(
        "from morse.builder import *\nthing = PassiveObject('near.obj')\nenv = Environment('empty')\n"
    )
    with morse.load(folders / "scene.py") as sim:
        for name in ("near.obj", str(folders / "near.obj")):
            with pytest.raises(MorseServiceFailed):
                sim.rpc("simulation", "spawn", "two", name)
        sim.spawn("two", lambda: PassiveObject("near.obj"))
