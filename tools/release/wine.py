"""Tries the kernel for Windows: calls that the tests make on this machine are recorded and repeated under Wine.

``python -m tools wine [WHEEL]``: without a wheel, the kernel is compiled. It needs Linux on x86-64 and Wine
(``apt-get install wine64``), and is skipped without them. Each call has to leave the same bits behind.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
import tempfile
import zipfile
from pathlib import Path

from morse.kernel import build, targets
from tools.release import contents, steps
from tools.release.wheels import ROOT

_CALLS = Path(__file__).parent / "calls"
_WINDOWS, _LINUX = targets.Target("windows", "x86_64"), targets.Target("linux-gnu", "x86_64")
#: where Debian has the program of its package ``wine64``
_PLACES = os.pathsep.join([os.environ.get("PATH", ""), "/usr/lib/wine"])


def main(wheel: Path | None) -> int:
    """Compile, record, repeat; the result is the status of the process."""
    wine = next(filter(None, (shutil.which(name, path=_PLACES) for name in ("wine64", "wine"))), None)
    if wine is None or targets.host() != _LINUX:
        print("skipped: needs Linux on x86-64 and Wine (apt-get install wine64)", file=sys.stderr)
        return 0
    # Wine saves its settings some time after its last program has ended
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as temporary:
        place = Path(temporary)
        recorder, repeater, calls = place / "record.so", place / "repeat.exe", place / "calls"
        (place / "functions.h").write_text(functions(), encoding="utf-8")
        zig = [sys.executable, "-m", "ziglang", "cc", "-O1", "-fno-stack-protector", "-fno-sanitize=undefined"]
        own = [*zig, "-target", _LINUX.zig, "-shared", "-fPIC", "-I", str(place), "-o", str(recorder)]
        (real, *_), libraries = build.build(_LINUX), _libraries(wheel, place)
        recording = {
            **os.environ,
            "MORSE_TEST_KERNEL": str(recorder),
            "MORSE_RECORDED_KERNEL": str(real),
            "MORSE_RECORDED_CALLS": str(calls),
            "OPENBLAS_NUM_THREADS": "1",
            "MORSE_THREADS": "1",
        }
        files = [*sorted(ROOT.glob("tests/kernel/test_ke*.py")), ROOT / "tests/kernel/test_primitives.py"]
        tests = [sys.executable, "-m", "pytest", "-q", "-n0", "-p", "no:cacheprovider", *map(str, files)]
        windows = {**os.environ, "WINEPREFIX": str(place / "wine"), "WINEDEBUG": "-all"}
        for title, command, settings in (
            ("recorder", [*own, str(_CALLS / "record.c")], None),
            ("repeater", [*zig, "-target", _WINDOWS.zig, "-o", str(repeater), str(_CALLS / "repeat.c")], None),
            ("record", [*tests, "-k", "not threads"], recording),
            *((path.stem, [wine, str(repeater), str(calls), str(path)], windows) for path in libraries),
        ):
            output = steps.run(title, command, ROOT, settings)
            if output is None:
                return 1
            print("      ", output.strip().rpartition("\n")[2])
    return 0


def _libraries(wheel: Path | None, place: Path) -> list[Path]:
    """The libraries for Windows, from a wheel or from the sources."""
    if wheel is None:
        return build.build(_WINDOWS, place)
    with zipfile.ZipFile(wheel) as archive:
        names = [contents.LIBRARIES + _WINDOWS.file_name(level) for level in _WINDOWS.levels]
        return [Path(archive.extract(name, place)) for name in names]


def functions() -> str:
    """The functions of the kernel, for the recorder: name, and whether there is a result."""
    text = "".join(path.read_text(encoding="utf-8") for path in sorted(build.SOURCES.iterdir()))
    exported = re.findall(r"^MORSE_EXPORT (\w+) (\w+)\(", text, re.MULTILINE)
    return "".join(f"FUNCTION({name}, {int(kind != 'void')})\n" for kind, name in exported)
