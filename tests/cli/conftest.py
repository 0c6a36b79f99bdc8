import io
import logging
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from morse.cli.app import execute


@dataclass(frozen=True)
class Answer:
    status: int
    out: str
    err: str


class Terminal:
    """Runs command lines as a user would, in its own directory and home."""

    def __init__(self, home: Path, directory: Path, capsys: pytest.CaptureFixture[str], patch: pytest.MonkeyPatch):
        self.home = home
        self.directory = directory
        self._capsys = capsys
        self._patch = patch

    def __call__(self, *words: str, stdin: bytes = b"") -> Answer:
        self._capsys.readouterr()
        self._patch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(stdin)))
        status = execute(words)
        out, err = self._capsys.readouterr()
        return Answer(status, out, err)

    @property
    def config(self) -> Path:
        return self.home / ".morse" / "config"


@pytest.fixture
def untouched_logging():
    """Undo `morse.core.reports.log.setup`: other tests capture the log in another way."""
    root = logging.getLogger("morse")
    before = root.level, root.propagate, list(root.handlers)
    yield
    root.level, root.propagate, root.handlers[:] = before


@pytest.fixture
def morse(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], untouched_logging
) -> Terminal:
    home, directory = tmp_path / "home", tmp_path / "work"
    home.mkdir()
    directory.mkdir()
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.setenv("USERPROFILE", str(home))
    for variable in ("MORSE_ROOT", "MORSE_RESOURCE_PATH", "MORSE_NODE", "MORSE_BLENDER"):
        # set first, so that the setting of a command is undone, too
        monkeypatch.setenv(variable, "")
        monkeypatch.delenv(variable)
    monkeypatch.chdir(directory)
    return Terminal(home, directory, capsys, monkeypatch)
