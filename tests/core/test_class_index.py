"""The index of component classes agrees with their files."""

from pathlib import Path

import pytest

import morse
from morse.core.classes import definitions as index
from morse.core.classes.definitions import definitions

PACKAGE = Path(morse.__file__).parent
FILES = sorted(
    file for kind in ("sensors", "actuators", "robots", "modifiers") for file in (PACKAGE / kind).glob("*.py")
)


@pytest.fixture
def written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An index of all files."""
    path = tmp_path / "classes.index"
    index.write(FILES, path)
    return use(path, monkeypatch)


def use(path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(index, "FILE", path)
    index._index.cache_clear()
    monkeypatch.setattr(index, "_index", index._index.__wrapped__)
    return path


def test_the_index_gives_what_the_files_define(written: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    expected = {file: definitions(file.read_bytes(), str(file)) for file in FILES}
    monkeypatch.setattr(index, "definitions", lambda *_: pytest.fail("the index was not used"))
    assert {file: index.indexed(file) for file in FILES} == expected
    assert sum(len(found) for found in expected.values()) > 90


def test_a_changed_file_is_read_itself(written: Path, tmp_path: Path) -> None:
    changed = tmp_path / "changed.py"
    changed.write_bytes(FILES[-1].read_bytes() + b"\n\nclass Added:\n    _name = 'Added'\n")
    assert index.indexed(changed)[-1].attributes == {"_name": "Added"}


@pytest.mark.parametrize("content", [b"", b"\x00\xff", b"[]", b"{"], ids=repr)
def test_a_damaged_index_is_not_used(content: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "classes.index"
    path.write_bytes(content)
    use(path, monkeypatch)
    assert index.indexed(FILES[-1]) == definitions(FILES[-1].read_bytes(), "")
