"""The loaded library, and the behaviour if it is missing."""

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


def test_the_highest_build_that_the_processor_can_run_is_taken(build):
    assert HOST is not None
    lowest = loading.load(HOST, HOST.levels[0])
    level = max((known for known in HOST.levels if known <= lowest.morse_processor_level()), default=HOST.levels[0])
    found = loading.library()
    assert os.path.basename(found._name) == HOST.file_name(level)


@pytest.mark.skipif(HOST is None or HOST.machine != "x86_64", reason="one build only")
def test_a_build_may_be_named(build, monkeypatch):
    monkeypatch.setenv(loading.VARIABLE, "V2")
    found = loading.library()
    assert found._name.endswith("_v2.so")


def test_a_missing_library_is_an_error_that_names_the_command(monkeypatch, tmp_path):
    monkeypatch.setattr(targets, "FOLDER", tmp_path)
    with pytest.raises(loading.KernelError, match=r"was not built; run python -m morse\.kernel\.build"):
        loading.library()


def test_a_run_without_a_library_says_so_in_one_line(tmp_path):
    (tmp_path / "scene.py").write_text("from morse.builder import *\nrobot = ATRV()\nEnvironment('empty')\n")
    program = (
        "import sys, pathlib\n"
        "from morse.kernel import targets\n"
        f"targets.FOLDER = pathlib.Path({str(tmp_path)!r})\n"
        "from morse.cli import main\n"
        "main()\n"
    )
    command = [sys.executable, "-c", program, "run", "--headless", "--duration", "0.1", "scene.py"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 1
    assert "was not built; run python -m morse.kernel.build" in done.stderr + done.stdout
    assert "Traceback" not in done.stderr + done.stdout


def test_a_file_that_is_no_library_is_not_used(build, monkeypatch, tmp_path):
    assert HOST is not None
    monkeypatch.setattr(targets, "FOLDER", tmp_path)
    for level in HOST.levels:
        (tmp_path / HOST.file_name(level)).write_bytes(b"no library")
    with pytest.raises(loading.KernelError):
        loading.library()


def test_a_library_of_another_version_is_not_used(build, monkeypatch, tmp_path):
    assert HOST is not None
    for level in HOST.levels:
        shutil.copy(targets.FOLDER / HOST.file_name(level), tmp_path)
    monkeypatch.setattr(targets, "FOLDER", tmp_path)
    monkeypatch.setattr(loading, "INTERFACE", -1)
    with pytest.raises(loading.KernelError, match="another version"):
        loading.library()


def test_a_platform_without_a_library(monkeypatch):
    monkeypatch.setattr(targets.platform, "machine", lambda: "riscv64")
    with pytest.raises(loading.KernelError, match="no native kernel for this platform"):
        loading.library()


def test_a_word_that_is_none_of_the_choices_is_ignored_aloud(build, monkeypatch, caplog):
    monkeypatch.setenv(loading.VARIABLE, "v9")
    loading.library()
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
