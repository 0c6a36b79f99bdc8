"""The loaded library, and the behaviour if it is missing."""

import os
import shutil
import subprocess
import sys

import pytest

from morse.kernel import layout, loading, targets

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
    # a member of a structure is added
    sources = tmp_path / "c"
    shutil.copytree(layout.SOURCES, sources)
    changed = sources / "solids.h"
    changed.write_text(changed.read_text().replace("typedef struct {", "typedef struct {\n    int64_t spare;", 1))
    monkeypatch.setattr(loading, "layout", lambda: layout.layout(sources))
    with pytest.raises(loading.KernelError, match=r"other structures; run python -m morse\.kernel\.build"):
        loading.library()


def test_changed_sources_are_compiled_before_the_library_is_loaded(build, monkeypatch, caplog):
    from morse.kernel import build as compiler

    compiled = []
    monkeypatch.setattr(loading, "is_stale", lambda target: True)
    monkeypatch.setattr(compiler, "build", compiled.append)
    with caplog.at_level("INFO"):
        loading.library()
    assert compiled == [HOST]
    assert "compiled again, because its C files have changed" in caplog.text


def test_errors_of_the_compiler_are_errors_of_the_kernel(build, monkeypatch):
    from morse.kernel import build as compiler

    def fail(target):
        raise RuntimeError(f"The kernel could not be compiled for {target}: solids.h:9: unknown type")

    monkeypatch.setattr(loading, "is_stale", lambda target: True)
    monkeypatch.setattr(compiler, "build", fail)
    with pytest.raises(loading.KernelError, match=r"solids\.h:9: unknown type"):
        loading.library()


def test_without_a_compiler_changed_sources_are_named(build, monkeypatch, caplog):
    monkeypatch.setattr(loading, "is_stale", lambda target: True)
    monkeypatch.setattr(loading.importlib.util, "find_spec", lambda name: None)
    loading.library()
    assert "run python -m morse.kernel.build, which needs the package ziglang" in caplog.text


def test_a_library_without_a_layout_is_not_used(build, monkeypatch):
    class Earlier:
        def __init__(self, path: str) -> None:
            del path

    monkeypatch.setattr(loading.ctypes, "CDLL", Earlier)
    with pytest.raises(loading.KernelError, match="other structures"):
        loading.library()


HEADER = """#define MOST 8
#define SLACK 1.5f
enum { ONE, TWO };
typedef struct {
    int32_t count;  // of rows
    double rows[MOST];
} Rows;
MORSE_EXPORT void morse_run(const Rows *rows,
                            int64_t count);
void morse_run(const Rows *rows, int64_t count) { return; }
"""


@pytest.mark.parametrize(
    ("old", "new", "differs"),
    [
        ("int32_t count", "int64_t count", True),
        ("MOST 8", "MOST 9", True),
        ("ONE, TWO", "TWO, ONE", True),
        ("const Rows *rows,\n", "Rows *rows,\n", True),
        ("morse_run", "morse_walk", True),
        ("// of rows", "// number of rows", False),
        ("SLACK 1.5f", "SLACK 2.5f", False),
        ("return;", "(void)rows;", False),
        ("rows,\n                            int64_t", "rows, int64_t", False),
    ],
)
def test_the_layout_is_that_of_structures_and_functions(old, new, differs):
    assert old in HEADER
    assert (layout.digest([HEADER.replace(old, new)]) != layout.digest([HEADER])) is differs


@pytest.mark.parametrize(
    "text", ["typedef struct {", "typedef struct {\n" * 20_000, "MORSE_EXPORT " * 20_000, "#define A " * 20_000]
)
def test_the_layout_of_damaged_sources_takes_little_time(text):
    assert layout.digest([text]) >= 0


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
