"""Detection of saved files."""

import os
from pathlib import Path

import pytest

from morse.simulation.watching.classes import to_renew
from morse.simulation.watching.edits import SavedFiles


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "model.blend"
    path.write_text("old")
    return path


def test_a_file_that_is_saved_is_named_once(file: Path) -> None:
    files = SavedFiles()
    assert files.look([str(file)]) == []
    file.write_text("newer")
    looks = [files.look([str(file)]) for _ in range(4)]
    assert looks == [[], [str(file)], [], []]


def test_a_file_that_is_being_written_is_left_alone(file: Path) -> None:
    files = SavedFiles()
    files.look([str(file)])
    for length in range(10, 15):
        file.write_text("x" * length)
        assert files.look([str(file)]) == []
    assert files.look([str(file)]) == [str(file)]


def test_a_file_that_is_away_for_a_while_is_named_when_it_is_back(file: Path) -> None:
    files = SavedFiles()
    files.look([str(file)])
    file.unlink()
    assert files.look([str(file)]) == files.look([str(file)]) == []
    file.write_text("another")
    assert files.look([str(file)]) == []
    assert files.look([str(file)]) == [str(file)]


def test_a_file_of_the_same_size_and_time_that_takes_the_place_is_another(file: Path) -> None:
    files = SavedFiles()
    files.look([str(file)])
    before = file.stat()
    other = file.with_name("other")
    other.write_text("new")
    os.utime(other, ns=(before.st_atime_ns, before.st_mtime_ns))
    os.replace(other, file)
    assert files.look([str(file)]) == []
    assert files.look([str(file)]) == [str(file)]


def test_a_file_that_never_was_is_no_error(tmp_path: Path) -> None:
    files = SavedFiles()
    assert files.look([str(tmp_path / "nothing")]) == []


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        (["proj.sensors.ears"], {"proj.sensors.ears"}),
        (["proj.maths"], {"proj.maths", "proj.tools", "proj.sensors.ears"}),
        (["proj.tools"], {"proj.tools", "proj.sensors.ears"}),
        (["proj.builder"], set()),
    ],
)
def test_what_imports_a_module_is_imported_anew_with_it(tmp_path: Path, changed: list[str], expected: set[str]) -> None:
    texts = {
        "proj": "",
        "proj.maths": "",
        "proj.tools": "def late():\n    from . import maths\n",
        "proj.sensors": "",
        "proj.sensors.ears": "from ..tools import late\n",
        "proj.builder": "import proj.sensors.ears\n",
    }
    packages = {"proj", "proj.sensors"}
    sources = {}
    for name, text in texts.items():
        path = tmp_path / name.replace(".", "/") / "__init__.py" if name in packages else tmp_path / f"{name}.py"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        sources[name] = str(path)
    assert to_renew(changed, ["proj.sensors.ears"], sources) == expected
