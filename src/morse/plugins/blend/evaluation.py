"""Evaluates what only Blender can, such as modifiers, in a process of Blender; results are cached."""

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
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from morse.assets.cache import Cache
from morse.mathutils import Matrix
from morse.plugins.blend.container import Damage
from morse.plugins.blend.meshes import build
from morse.plugins.blend.polygons import gather
from morse.plugins.blend.unevaluated import needs
from morse.scene import NodeKind
from morse.scene.frames import set_free
from morse.system.variables import text

if TYPE_CHECKING:
    from morse.plugins.blend.file import BlendFile
    from morse.plugins.blend.objects import Objects
    from morse.scene import Material, Mesh, Node

Arrays = dict[str, NDArray[np.generic]]

#: timeout for Blender, s
TIME_LIMIT = 120.0
_SCRIPT = Path(__file__).with_name("blend_export.py")
_CACHE = Cache("blend", most=64)
_MAX_RESULT = 1 << 30


def find_blender(program: str | None = None) -> str | None:
    """The Blender program: the given one, that of MORSE_BLENDER, or `blender` on the PATH; None if not found."""
    command = program or text("MORSE_BLENDER") or "blender"
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


_MAX_NAMED = 8
_KEYS = ("vertices", "corners", "sizes", "materials", "smooth", "normals", "uvs")


def complete(path: Path, file: BlendFile, objects: Objects, blender: str | None) -> None:
    """Evaluate objects with Blender; without Blender, warn about the objects that are shown as stored."""
    needs_of_objects = {address: need for address in objects.nodes if any(need := needs(objects.records[address]))}
    if not needs_of_objects:
        return
    nodes = [objects.nodes[address] for address in needs_of_objects]
    program = find_blender(blender)
    if program is None:
        file.warn(
            f"{_listed(nodes)}: modifiers, curves and constraints can only be evaluated by Blender, which was not "
            "found. Apply them in the file, or install Blender (or set MORSE_BLENDER to the path of the program)"
        )
        return
    try:
        arrays = evaluate(path, [node.name for node in nodes], program)
        surfaces = _Surfaces(objects, arrays)
        empty = [
            nodes[number]
            for number, (address, need) in enumerate(needs_of_objects.items())
            if need.mesh and not surfaces.show(address, f"{number}_")
        ]
        if empty:
            file.warn(f"{_listed(empty)}: Blender evaluated no surface; shown as stored in the file")
        posed_numbers = [number for number, need in enumerate(needs_of_objects.values()) if need.pose]
        # parents before their children
        for number in sorted(posed_numbers, key=lambda number: len(list(nodes[number].ancestors()))):
            pose = arrays.get(f"{number}_matrix")
            if pose is not None and pose.shape == (4, 4) and np.isfinite(pose).all():
                _move(nodes[number], Matrix(pose.tolist()))
    except Damage as damage:
        file.warn(
            f"{_listed(nodes)}: modifiers, curves and constraints are ignored, because '{program}' could not "
            f"evaluate them: {damage}"
        )


class _Surfaces:
    """Assigns surfaces that Blender has evaluated to objects; equal surfaces share one mesh."""

    def __init__(self, objects: Objects, arrays: Arrays) -> None:
        self._objects = objects
        self._arrays = arrays
        self._meshes: dict[tuple[object, ...], Mesh] = {}

    def show(self, address: int, prefix: str) -> bool:
        """Set the mesh of an object; False if it has no surface."""
        own = {key: self._arrays[prefix + key] for key in _KEYS if prefix + key in self._arrays}
        if "vertices" not in own:
            return False
        node = self._objects.nodes[address]
        slots = tuple(self._objects.slots(self._objects.records[address]))
        key = (slots, *(hashlib.blake2b(value.tobytes()).digest() for value in own.values()))
        if key not in self._meshes:
            self._meshes[key] = _mesh(node.name, own, slots)
        node.kind, node.mesh, node.materials = NodeKind.MESH, self._meshes[key], []
        return True


def _mesh(name: str, own: Arrays, slots: tuple[Material | None, ...]) -> Mesh:
    if not {"corners", "sizes", "materials", "smooth", "normals"} <= own.keys():
        raise Damage("its result cannot be read")
    counts = own["sizes"].astype(np.int64)
    polygons = gather(
        own["vertices"].astype(np.float64).reshape(-1, 3),
        own["corners"].astype(np.int64),
        np.cumsum(counts) - counts,
        counts,
        materials=own["materials"].astype(np.int64),
        smooth=own["smooth"].astype(np.bool_),
        uvs=own["uvs"].astype(np.float64).reshape(-1, 2) if "uvs" in own else None,
    )
    normals = own["normals"].astype(np.float64).reshape(-1, 3)
    usable = polygons.smooth.any() and len(normals) == len(polygons.corners)
    return build(name, polygons, normals if usable else None, slots)


def _move(node: Node, world: Matrix) -> None:
    """Set the pose of a node to the pose that Blender computed."""
    if node.parent is None:
        set_free(node, world)
        return
    above, basis = (matrix.inverted(None) for matrix in (node.parent.world_matrix(), node.basis_matrix()))
    if above is not None and basis is not None:
        node.parent_inverse = above @ world @ basis


def _listed(nodes: list[Node]) -> str:
    names = ", ".join(f"'{node.name}'" for node in nodes[:_MAX_NAMED])
    more = f" and {len(nodes) - _MAX_NAMED} more" if len(nodes) > _MAX_NAMED else ""
    return f"object{'s' if len(nodes) > 1 else ''} {names}{more}"
