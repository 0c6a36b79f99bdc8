"""A release without publishing it: wheels, a local index, an installation, a demo, the documentation.

``python -m tools release [FOLDER]`` builds the source distribution and the wheels of the last commit into a folder and
verifies them. ``python -m tools rehearse [FOLDER]`` goes on: it serves the folder as an index of packages on the
loopback interface, installs from this index into a fresh virtual environment, runs the installed program, and builds
the documentation.
"""

from __future__ import annotations

import hashlib
import os
import sys
import tempfile
import threading
import venv
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import TYPE_CHECKING

from tools.release import contents, steps, wheels

if TYPE_CHECKING:
    from collections.abc import Iterator

NAME = "morse-simulator"


def release(folder: Path) -> int:
    """Build and verify; the result is the status of the process."""
    files = wheels.build(folder)
    errors = contents.verify([file for file in files if file.suffix == ".whl"], wheels.sources("HEAD"))
    for file in files:
        digest = hashlib.sha256(file.read_bytes()).hexdigest()
        print(f"{file.stat().st_size / 1e6:6.1f} MB  {digest}  {file.name}")
    for error in errors:
        print(f"error: {error}", file=sys.stderr)
    print(f"{len(files)} files, {len(errors)} errors")
    return 1 if errors else 0


def rehearse(folder: Path) -> int:
    """Build, verify, install from a local index, run, document; the result is the status of the process."""
    folder = folder.resolve()  # the steps run in another folder
    if release(folder):
        return 1
    with tempfile.TemporaryDirectory() as temporary, index(folder) as address:
        place = Path(temporary)
        venv.create(place / "venv", with_pip=True)
        programs = place / "venv" / ("Scripts" if os.name == "nt" else "bin")
        pip = [str(programs / "python"), "-m", "pip", "install", "-q", "--pre", "--only-binary", NAME]
        for title, command in (
            ("install", [*pip, "--extra-index-url", address, NAME]),
            ("check", [str(programs / "morse"), "check"]),
            ("demo", [str(programs / NAME), "demo", "imu", "--headless", "--speed", "max"]),
            ("sdist", [*pip[:-2], "--no-deps", "--target", str(place / "sdist"), str(next(folder.glob("*.tar.gz")))]),
            ("docs", [sys.executable, "-m", "sphinx", "-q", "-W", str(wheels.ROOT / "docs"), str(place / "docs")]),
        ):
            # in a folder of its own, so that the package is the installed one
            if steps.run(title, command, place) is None:
                return 1
    return 0


@contextmanager
def index(folder: Path) -> Iterator[str]:
    """Serve the files of a folder as an index of packages (PEP 503); the result is the address of the index."""
    with tempfile.TemporaryDirectory() as temporary:
        pages = Path(temporary) / "simple" / NAME
        pages.mkdir(parents=True)
        links = []
        for file in sorted([*folder.glob("*.whl"), *folder.glob("*.tar.gz")]):
            (pages / file.name).symlink_to(file.resolve())
            links.append(
                f'<a href="{file.name}#sha256={hashlib.sha256(file.read_bytes()).hexdigest()}">{file.name}</a>'
            )
        (pages / "index.html").write_text(
            f"<!DOCTYPE html><html><body>{''.join(links)}</body></html>", encoding="utf-8"
        )
        server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Quiet, directory=temporary))
        threading.Thread(target=server.serve_forever, daemon=True).start()
        try:
            yield f"http://127.0.0.1:{server.server_address[1]}/simple/"
        finally:
            server.shutdown()
            server.server_close()


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, format: str, *args: object) -> None:
        """Nothing is printed for each file."""
