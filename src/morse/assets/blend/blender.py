"""Runs Blender in a separate process to evaluate what this reader cannot; results are cached."""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import os
import shutil
import subprocess
import tempfile
import zipfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from morse.assets.blend.errors import Damage
from morse.assets.cache import Cache
from morse.system import variables

Arrays = dict[str, NDArray[np.generic]]

#: timeout for Blender, s
TIME_LIMIT = 120.0
_SCRIPT = Path(__file__).with_name("blend_export.py")
_CACHE = Cache("blend", most=64)
_MAX_RESULT = 1 << 30


def find_blender(program: str | None = None) -> str | None:
    """The Blender program: the given one, that of MORSE_BLENDER, or `blender` on the PATH; None if not found."""
    command = program or variables.text("MORSE_BLENDER") or "blender"
    return shutil.which(command)


def evaluate(path: Path, names: list[str], blender: str) -> Arrays:
    """Return the arrays of `blend_export.py` for the meshes and poses of some objects of a file.

    Raises:
        Damage: Blender failed; the message contains the reason.
    """
    key = _key(path, names, blender)
    cached_result = _CACHE.get(key, _MAX_RESULT)
    if cached_result is not None:
        # a cached result that cannot be read is computed again
        with contextlib.suppress(Damage):
            return _load(cached_result)
    with tempfile.TemporaryDirectory(prefix="morse-blend-") as folder:
        result = Path(folder, "result.npz")
        _run(path, names, blender, result)
        data = result.read_bytes()
    arrays = _load(data)
    _CACHE.put(key, data)
    return arrays


def _run(path: Path, names: list[str], blender: str, result: Path) -> None:
    names_file = result.with_name("names.json")
    names_file.write_text(json.dumps(names), encoding="utf-8")
    command = [
        blender, "-b", "--factory-startup", "-noaudio", "--disable-autoexec", "--python-exit-code", "3",
        "--python", str(_SCRIPT), "--", str(path.absolute()), str(result), str(names_file),
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
    message = next((line.strip() for line in reversed(lines) if "Error" in line), f"it ended with status {status}")
    return message[:200]


def _load(data: bytes) -> Arrays:
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            return {key: archive[key] for key in archive.files}
    except (ValueError, OSError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise Damage("its result cannot be read") from error


def _key(path: Path, names: list[str], blender: str) -> str:
    """Return a cache key of everything that affects the result: the file, the objects, the script, the program."""
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
