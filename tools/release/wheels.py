"""Builds the source distribution and the wheels of all platforms from the last commit."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

from morse.kernel import targets

ROOT = Path(__file__).parents[2]


def build(folder: Path, platforms: list[str] | None = None, revision: str = "HEAD") -> list[Path]:
    """Write the distributions of a commit into a folder.

    Args:
        folder: where they are written; created if it is missing.
        platforms: names of targets, as of `morse.kernel.targets`; all if None.
        revision: the commit. Changes that are not committed are left out.

    Returns:
        The files, the source distribution first.

    Raises:
        subprocess.CalledProcessError: a step failed; its output has been printed.
    """
    folder = folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        tree = Path(temporary) / "tree"
        tree.mkdir()
        archive = subprocess.run(["git", "archive", revision], cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout
        subprocess.run(["tar", "-x", "-C", str(tree)], input=archive, check=True)
        moment = subprocess.run(
            ["git", "log", "-1", "--format=%ct", revision], cwd=ROOT, check=True, capture_output=True, encoding="utf-8"
        )
        python = _environment(Path(temporary) / "venv", tree)
        settings = {
            **os.environ,
            "SOURCE_DATE_EPOCH": moment.stdout.strip(),
            # the C libraries of the systems are compiled once for all processors
            "ZIG_GLOBAL_CACHE_DIR": str(Path(temporary) / "zig"),
            "ZIG_LOCAL_CACHE_DIR": str(Path(temporary) / "zig"),
        }
        _hatchling(python, tree, folder, "sdist", settings)
        for name in platforms or [str(target) for target in targets.ALL]:
            print(f"wheel for {name}", flush=True)
            _hatchling(python, tree, folder, "wheel", {**settings, "MORSE_BUILD_TARGET": name})
    return sorted(folder.glob("*.tar.gz")) + sorted(folder.glob("*.whl"))


def sources(revision: str | None = None) -> list[str]:
    """The paths of the files below ``src`` in a commit, or in the present tree if it is None."""
    listing = ["ls-files"] if revision is None else ["ls-tree", "-r", "--name-only", revision]
    words = ["git", *listing, "--", "src"]
    lines = subprocess.run(words, cwd=ROOT, check=True, capture_output=True, encoding="utf-8").stdout.splitlines()
    return [line.removeprefix("src/") for line in lines]


def _environment(folder: Path, tree: Path) -> Path:
    """A virtual environment with what the build needs; the result is its Python."""
    venv.create(folder, with_pip=True)
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    # nothing that is not the file that was there when .ci/lock was called
    hashed = ["--require-hashes", "--only-binary", ":all:", "-r", str(tree / ".ci" / "build.txt")]
    _run([str(python), "-m", "pip", "install", "-q", *hashed], tree, dict(os.environ))
    return python


def _hatchling(python: Path, tree: Path, folder: Path, kind: str, settings: dict[str, str]) -> None:
    _run([str(python), "-m", "hatchling", "build", "-t", kind, "-d", str(folder)], tree, settings)


def _run(command: list[str], folder: Path, settings: dict[str, str]) -> None:
    process = subprocess.run(
        command, cwd=folder, env=settings, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8"
    )
    if process.returncode:
        print(process.stdout[-8000:], file=sys.stderr)
        process.check_returncode()
