"""The tests of the kernel, run with a library that checks every access and every operation."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from morse.kernel import build
from tests.kit.programs import python

pytestmark = pytest.mark.long

CHECKED = "MORSE_TEST_KERNEL"
OPTIONS = ["-Og", "-g1", "-shared", "-fPIC", "-fno-omit-frame-pointer", "-Wno-psabi"]
#: tests of Python only
_NOT_NATIVE = ("test_build.py", "test_loading.py", "test_release.py", "test_sanitizers.py")
WORDS = ["-n0", "-q", "-x", "-p", "no:cacheprovider", "--timeout", "3000"]
SANITIZERS = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]


# the short form has a test of each kernel with inputs of all kinds
@pytest.mark.parametrize("chosen", ["random or primitives or alike", pytest.param("test", marks=pytest.mark.slow)])
@pytest.mark.timeout(3100)
@pytest.mark.skipif(CHECKED in os.environ, reason="this is the inner run")
@pytest.mark.skipif(sys.platform != "linux", reason="the compiler of Linux is asked")
def test_no_access_out_of_bounds_and_nothing_undefined(tmp_path, chosen):
    compiler = shutil.which("gcc")
    if compiler is None:
        if os.environ.get("CI"):
            pytest.fail("gcc is needed for the sanitizers")
        pytest.skip("gcc is not installed")
    library = tmp_path / "checked.so"
    files = map(str, build.sources())
    subprocess.run([compiler, *build.EXACT, *OPTIONS, *SANITIZERS, "-o", str(library), *files, "-lm"], check=True)
    runtime = subprocess.run([compiler, "-print-file-name=libasan.so"], capture_output=True, text=True, check=True)
    environment = {
        **os.environ,
        CHECKED: str(library),
        "LD_PRELOAD": runtime.stdout.strip(),
        # Python and numpy keep memory until they end
        "ASAN_OPTIONS": "detect_leaks=0",
        "PYTHONMALLOC": "malloc",
    }
    here = [str(path) for path in Path(__file__).parent.glob("test_*.py") if path.name not in _NOT_NATIVE]
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *WORDS, "-k", chosen, *here],
        env=environment,
        capture_output=True,
        text=True,
        timeout=3000,
    )
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
    assert " passed" in done.stdout
    assert "skipped" not in done.stdout.splitlines()[-1]


@pytest.mark.skipif(sys.platform != "linux", reason="the compiler of Linux is asked")
def test_the_sanitizers_see_what_they_shall_see(tmp_path):
    """A test of the method: a library that reads beyond the end of an array ends the program."""
    compiler = shutil.which("gcc")
    if compiler is None:
        pytest.skip("gcc is not installed")
    source = tmp_path / "wrong.c"
    source.write_text("double last(const double *a, long n) { return a[n]; }\n")
    library = tmp_path / "wrong.so"
    subprocess.run([compiler, *OPTIONS, *SANITIZERS, "-o", str(library), str(source)], check=True)
    runtime = subprocess.run([compiler, "-print-file-name=libasan.so"], capture_output=True, text=True, check=True)
    program = (
        "import ctypes, sys; d = (ctypes.c_double * 1000)();"
        "m = ctypes.CDLL(sys.argv[1]); libc = ctypes.CDLL(None); libc.malloc.restype = ctypes.c_void_p;"
        "m.last.restype = ctypes.c_double; p = libc.malloc(ctypes.c_size_t(800)); m.last(ctypes.c_void_p(p), 100)"
    )
    done = python("-c", program, library, LD_PRELOAD=runtime.stdout.strip(), ASAN_OPTIONS="detect_leaks=0")
    assert "heap-buffer-overflow" in done.stderr
