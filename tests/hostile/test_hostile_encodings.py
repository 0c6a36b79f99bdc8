"""A script in any encoding that Python accepts is shown, saved and mended without a lost character."""

from pathlib import Path

import pytest

import morse
from morse.builder.editing.changes import Changes, Move, UnwritableError
from morse.system.source_text import source_text
from morse.viewer.script_file import ScriptFile

SCRIPT = """# -*- coding: {} -*-
# café
from morse.builder import *
robot = FakeRobot()
env = Environment("empty")
"""
MOVE = Move("robot", (1.0, 2.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1", "cp437"])
def test_a_saved_script_keeps_its_encoding(encoding: str, tmp_path: Path) -> None:
    path = tmp_path / "scene.py"
    declared = "utf-8" if encoding == "utf-8-sig" else encoding
    path.write_bytes(SCRIPT.format(declared).encode(encoding))
    file = ScriptFile(str(path))
    file.save(file.changed(Changes(moves=[MOVE])))
    saved = path.read_bytes()
    assert "# café\n" in saved.decode(encoding)
    assert source_text(saved) == saved.decode(encoding)
    assert b"robot.translate(1.0, 2.0" in saved


def test_a_character_that_the_encoding_has_not_is_not_written(tmp_path: Path) -> None:
    path = tmp_path / "scene.py"
    content = SCRIPT.format("latin-1").encode("latin-1")
    path.write_bytes(content)
    file = ScriptFile(str(path))
    with pytest.raises(UnwritableError, match="iso-8859-1"):
        file.save(file.changed(Changes()) + "# Ω\n")
    assert path.read_bytes() == content


def test_the_live_view_of_a_script_in_latin_1_opens(tmp_path: Path) -> None:
    path = tmp_path / "scene.py"
    path.write_bytes(SCRIPT.format("latin-1").encode("latin-1"))
    with morse.load(path, view="web", view_port=0) as simulation:
        simulation.step()


def test_a_script_that_is_no_text_any_more_is_not_written(tmp_path: Path) -> None:
    path = tmp_path / "scene.py"
    path.write_bytes(b"# caf\xe9\n")
    with pytest.raises(UnwritableError, match="cannot be read"):
        ScriptFile(str(path)).changed(Changes())
