"""The loaded library, and the behaviour if it is missing."""

from __future__ import annotations

import logging
import os
import shutil
import subprocess
import sys

import pytest

from morse.kernel import loading, targets

HOST = targets.host()


@pytest.fixture(autouse=True)
def forget(monkeypatch):
    """Clear the cache of the loaded library."""
    loading.library.cache_clear()
    monkeypatch.delenv(loading.VARIABLE, raising=False)
    yield
    loading.library.cache_clear()


def test_it_can_be_switched_off(monkeypatch, caplog):
    monkeypatch.setenv(loading.VARIABLE, "off")
    assert loading.library() is None
    assert not caplog.records


def test_the_highest_build_that_the_processor_can_run_is_taken(build):
    assert HOST is not None
    lowest = loading.load(HOST, HOST.levels[0])
    level = max((known for known in HOST.levels if known <= lowest.morse_processor_level()), default=HOST.levels[0])
    found = loading.library()
    assert found is not None
    assert os.path.basename(found._name) == HOST.file_name(level)


@pytest.mark.skipif(HOST is None or HOST.machine != "x86_64", reason="one build only")
def test_a_build_may_be_named(build, monkeypatch):
    monkeypatch.setenv(loading.VARIABLE, "V2")
    found = loading.library()
    assert found is not None
    assert found._name.endswith("_v2.so")


def test_without_a_library_numpy_works_and_one_line_says_so(monkeypatch, tmp_path, caplog):
    monkeypatch.setattr(targets, "FOLDER", tmp_path)
    with caplog.at_level(logging.WARNING):
        assert loading.library() is None
        assert loading.library() is None
    (record,) = caplog.records
    assert "was not built" in record.message
    assert "numpy" in record.message


def test_a_file_that_is_no_library_is_not_used(build, monkeypatch, tmp_path, caplog):
    assert HOST is not None
    monkeypatch.setattr(targets, "FOLDER", tmp_path)
    for level in HOST.levels:
        (tmp_path / HOST.file_name(level)).write_bytes(b"no library")
    assert loading.library() is None
    assert len(caplog.records) == 1


def test_a_library_of_another_version_is_not_used(build, monkeypatch, tmp_path, caplog):
    assert HOST is not None
    for level in HOST.levels:
        shutil.copy(targets.FOLDER / HOST.file_name(level), tmp_path)
    monkeypatch.setattr(targets, "FOLDER", tmp_path)
    monkeypatch.setattr(loading, "INTERFACE", -1)
    assert loading.library() is None
    assert "another version" in caplog.records[0].message


def test_a_platform_without_a_library(monkeypatch, caplog):
    monkeypatch.setattr(targets.platform, "machine", lambda: "riscv64")
    assert loading.library() is None
    assert "no native kernel for this platform" in caplog.records[0].message


def test_a_word_that_is_none_of_the_choices_is_ignored_aloud(build, monkeypatch, caplog):
    monkeypatch.setenv(loading.VARIABLE, "v9")
    assert loading.library() is not None
    assert "'v9' is none of" in caplog.records[0].message


@pytest.mark.parametrize(
    ("system", "machine", "name"),
    [("win32", "AMD64", "windows-x86_64"), ("darwin", "arm64", "macos-aarch64"), ("linux", "x86_64", "linux")],
)
def test_platforms_are_known_by_what_python_calls_them(monkeypatch, system, machine, name):
    monkeypatch.setattr(sys, "platform", system)
    monkeypatch.setattr(targets.platform, "machine", lambda: machine)
    assert str(targets.host()).startswith(name)


def test_nothing_is_loaded_before_the_first_ray():
    program = (
        "import sys\n"
        "from morse.builder import *\n"
        "import morse.simulation.simulation\n"
        "loading = sys.modules.get('morse.kernel.loading')\n"
        "assert loading is None or not loading.library.cache_info().misses\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
