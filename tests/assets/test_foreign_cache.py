"""What others have put into the directory of a cache is not read, and does not block."""

import os
from pathlib import Path

import pytest

from morse.assets.cache import Cache

pytestmark = pytest.mark.skipif(not hasattr(os, "geteuid"), reason="the system has no owners of this kind")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("MORSE_CACHE", str(tmp_path))
    return tmp_path / "kind"


@pytest.fixture
def cache(folder: Path) -> Cache:
    made = Cache("kind", most=10)
    made.put("key", b"data")
    assert made.get("key") == b"data"
    return made


def give_away(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a path belong to another user."""
    if os.geteuid() == 0:
        os.chown(path, 12345, -1)
    else:
        other = os.geteuid() + 1
        monkeypatch.setattr(os, "geteuid", lambda: other)


def test_a_file_of_another_user(cache: Cache, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    give_away(folder / "key", monkeypatch)
    assert cache.get("key") is None


def test_a_directory_of_another_user(cache: Cache, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    give_away(folder, monkeypatch)
    assert cache.get("key") is None
    cache.put("other", b"data")
    assert not (folder / "other").exists()


def test_links_pipes_and_devices(cache: Cache, folder: Path) -> None:
    (folder / "link").symlink_to(folder / "key")
    (folder / "endless").symlink_to("/dev/zero")
    os.mkfifo(folder / "pipe")
    (folder / "folder").mkdir()
    assert [cache.get(name) for name in ("link", "endless", "pipe", "folder")] == [None] * 4


def test_a_file_that_is_too_large(cache: Cache) -> None:
    assert cache.get("key", largest=3) is None
