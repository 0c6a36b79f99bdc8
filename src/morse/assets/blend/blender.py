"""Runs Blender in a separate process to evaluate what this reader cannot evaluate; results are cached."""

from __future__ import annotations

import hashlib
import io
import json
import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from morse.assets.blend.errors import Damage

Arrays = dict[str, NDArray[np.generic]]

#: timeout for Blender, s
TIME_LIMIT = 120.0
_SCRIPT = Path(__file__).with_name("blend_export.py")
#: maximum number of cached results
_MAX_CACHED = 64
_MAX_RESULT = 1 << 30


def find_blender(given: str | None = None) -> str | None:
    """The program to run: the given one, that of MORSE_BLENDER, or `blender` on the PATH; None if there is none."""
    wanted = given or os.environ.get("MORSE_BLENDER") or "blender"
    return shutil.which(wanted)


def evaluate(path: Path, names: list[str], blender: str) -> Arrays:
    """Return the arrays of `blend_export.py` for the meshes and poses of some objects of a file.

    Raises:
        Damage: Blender failed; with the reason.
    """
    kept = _cache_folder() / f"{_key(path, names, blender)}.npz"
    try:
        if kept.is_file():
            return _load(kept.read_bytes())
    except (OSError, Damage):
        # a cached result that cannot be read is computed again
        pass
    with tempfile.TemporaryDirectory(prefix="morse-blend-") as folder:
        result = Path(folder, "result.npz")
        _run(path, names, blender, result)
        data = result.read_bytes()
    arrays = _load(data)
    _keep(kept, data)
    return arrays


def _run(path: Path, names: list[str], blender: str, result: Path) -> None:
    wanted = result.with_name("names.json")
    wanted.write_text(json.dumps(names), encoding="utf-8")
    command = [
        blender, "-b", "--factory-startup", "-noaudio", "--disable-autoexec", "--python-exit-code", "3",
        "--python", str(_SCRIPT), "--", str(path.absolute()), str(result), str(wanted),
    ]  # fmt: skip
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    log = result.with_name("log.txt")
    try:
        with log.open("wb") as output:
            status = subprocess.run(
                command,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                env=environment,
                timeout=TIME_LIMIT,
                check=False,
            ).returncode
    except subprocess.TimeoutExpired:
        raise Damage(f"it took longer than {TIME_LIMIT:g} s") from None
    except OSError as error:
        raise Damage(f"it cannot be started ({error.strerror or error})") from error
    if status != 0 or not result.is_file():
        raise Damage(_reason(log, status))
    if result.stat().st_size > _MAX_RESULT:
        raise Damage("its result is too large")


def _reason(log: Path, status: int) -> str:
    """Return the last error message of Blender."""
    if status < 0 or status > 128:
        return "it crashed: the file may have been saved by a newer version of Blender than this one"
    with log.open("rb") as file:
        file.seek(0, io.SEEK_END)
        file.seek(max(file.tell() - 4096, 0))
        lines = file.read().decode("utf-8", "replace").splitlines()
    said = next((line.strip() for line in reversed(lines) if "Error" in line), f"it ended with status {status}")
    return said[:200]


def _load(data: bytes) -> Arrays:
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            return {key: archive[key] for key in archive.files}
    except (ValueError, OSError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise Damage("its result cannot be read") from error


def _key(path: Path, names: list[str], blender: str) -> str:
    """Return a cache key of all that the result depends on: the file, the objects, the script, the program."""
    program = Path(blender).stat()
    digest = hashlib.blake2b(digest_size=20)
    for part in (
        path.read_bytes(),
        _SCRIPT.read_bytes(),
        json.dumps(names).encode(),
        f"{blender} {program.st_size} {program.st_mtime_ns}".encode(),
    ):
        digest.update(hashlib.blake2b(part).digest())
    return digest.hexdigest()


def _cache_folder() -> Path:
    """Return the cache directory of this system."""
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "morse" / "blend"


def _keep(kept: Path, data: bytes) -> None:
    """Store a result in the cache; errors are ignored, and the result is then computed again next time."""
    try:
        kept.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=kept.parent, delete=False) as file:
            file.write(data)
        os.replace(file.name, kept)
        oldest = sorted(kept.parent.glob("*.npz"), key=lambda entry: entry.stat().st_mtime)
        for entry in oldest[:-_MAX_CACHED]:
            entry.unlink(missing_ok=True)
    except OSError:
        return
