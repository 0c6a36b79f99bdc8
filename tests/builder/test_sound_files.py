"""Files of sounds are found as models are."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from morse.assets import search
from morse.builder.errors import ScriptError

SCRIPT = """
from morse.builder import *
robot = FakeRobot("robot")
voice = Sound("voice")
voice.open("{name}")
robot.append(voice)
env = Environment("empty")
"""


def file_of(scene: Any) -> str:
    (voice,) = (part for part in scene.components if part.name == "robot.voice")
    return str(voice.node.properties["file"])


def test_a_sound_stands_beside_the_script(load: Callable[..., Any], tmp_path: Path) -> None:
    (tmp_path / "beep.wav").write_bytes(b"RIFF")
    assert file_of(load(SCRIPT.format(name="beep.wav"))) == str((tmp_path / "beep.wav").resolve())


def test_a_sound_is_in_the_data_of_the_project(
    load: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = tmp_path / "elsewhere"
    (data / "sim").mkdir(parents=True)
    (data / "sim" / "beep.wav").write_bytes(b"RIFF")
    monkeypatch.setenv("MORSE_RESOURCE_PATH", str(data))
    assert file_of(load(SCRIPT.format(name="sim/beep.wav"))) == str((data / "sim" / "beep.wav").resolve())


def test_a_missing_sound_names_the_nearest_file_and_the_folders(load: Callable[..., Any], tmp_path: Path) -> None:
    (tmp_path / "beep.wav").write_bytes(b"RIFF")
    with pytest.raises(ScriptError, match=r"did you mean 'beep\.wav'") as caught:
        load(SCRIPT.format(name="beeb.wav"))
    assert str(tmp_path) in str(caught.value)
    assert caught.value.where is not None
    assert caught.value.where.line == 5


def test_a_name_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match="not the name of a file"):
        search.find_file(" ")
