"""Model files that the driving page sends: they are stored in a temporary folder, examined, and offered to be added.

Names and contents are those of anybody. Only models, their meshes and their pictures are stored, below a folder that
the server names, and never a program: a saved scene has the folder beside its script, where Python looks for modules.
"""

from __future__ import annotations

import base64
import binascii
import json
import os
import queue
import re
import shutil
import tempfile
import threading
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from morse.assets import search
from morse.assets.formats import suffixes
from morse.assets.loader import keep
from morse.builder.editing.changes import UnwritableError
from morse.core.exceptions import MorseError
from morse.core.reports.quoting import quoted
from morse.core.validation.names import DEVICES
from morse.helpers.descriptions import robot_file
from morse.services.recording_services import LEAST
from morse.system.free_names import free_name
from morse.system.workers import Worker, WorkerError
from morse.viewer.examination import MOST_MEMORY, MOST_SECONDS, PATIENCE, Examined, entry, read_answer
from morse.viewer.view_messages import Answer

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from morse.scene import Scene
    from morse.viewer import page_messages as page
    from morse.viewer.catalog import Catalog
    from morse.viewer.page_inputs import ServiceCalls
    from morse.viewer.server import ViewServer

#: bytes of one upload, and of all uploads of a run; uploads and files of a run
_LARGEST, _MOST_BYTES = 128 << 20, 512 << 20
_MOST_UPLOADS, _MOST_FILES = 100, 5000
#: folders below each other, characters of a name
_DEEPEST, _LONGEST = 8, 100
#: characters that no file has on all systems, and names that begin or end as those of files do not
_ODD_NAME = re.compile(r'[\x00-\x1f\x7f<>:"/\\|?*]|^[. ]|[. ]$')
#: what models refer to, beside other models
_PARTS = frozenset(
    (".mtl", ".bin", ".config", ".png", ".jpg", ".jpeg", ".bmp", ".gif", ".tga", ".tif", ".tiff", ".webp", ".hdr")
)
#: a file of xacro runs expressions, and names files of the disk
_NEVER = frozenset({".xacro", ".py"})
_PROGRAM = "morse.viewer.examination"


@dataclass
class _Upload:
    """The files of one upload.

    Attributes:
        folder: in the temporary folder; its name is that of the folder beside the script.
        files: path below the folder, and size, bytes.
        received: bytes of each file so far.
    """

    folder: Path
    files: list[tuple[PurePosixPath, int]]
    received: list[int] = field(default_factory=list)


class Uploads:
    """The uploads of one run of a scene."""

    def __init__(self, scene: Scene, server: ViewServer, services: ServiceCalls, catalog: Catalog) -> None:
        self._scene, self._server, self._services, self._catalog = scene, server, services, catalog
        self._root: tempfile.TemporaryDirectory[str] | None = None
        self._uploads: dict[int, _Upload] = {}
        self._examined: queue.SimpleQueue[tuple[int, Examined]] = queue.SimpleQueue()
        self._reader: Worker | None = None
        self._thread: threading.Thread | None = None

    # -- requests --------------------------------------------------------------------------

    def begin(self, event: page.BeginUpload) -> None:
        """Check what is to be sent, and make a place for it."""
        self._attempt(event.request, lambda: self._begin(event))

    def _begin(self, event: page.BeginUpload) -> int:
        files = [(_checked_path(path), size) for path, size in event.files]
        size = sum(own for _, own in files)
        if size > _LARGEST:
            raise MorseError(f"the files have {size >> 20} MiB together: a page sends at most {_LARGEST >> 20} MiB")
        uploads = self._uploads.values()
        whole = size + sum(own for upload in uploads for _, own in upload.files)
        number = len(files) + sum(len(upload.files) for upload in uploads)
        if whole > _MOST_BYTES or number > _MOST_FILES or len(self._uploads) >= _MOST_UPLOADS:
            raise MorseError(
                f"a run takes at most {_MOST_UPLOADS} models of pages, with {_MOST_FILES} files of {_MOST_BYTES >> 20} "
                "MiB together: save the scene, and start it again"
            )
        names = [path.as_posix().lower() for path, _ in files]
        folders = {folder.as_posix().lower() for path, _ in files for folder in path.parents}
        if len({*names}) < len(names) or folders & {*names}:
            raise MorseError("two of the files have the same name, for a disk that does not distinguish a from A")
        if self._root is None:
            self._root = tempfile.TemporaryDirectory(prefix="morse-files-", ignore_cleanup_errors=True)
            self._scene.resource_paths.append(self._root.name)
        if (free := shutil.disk_usage(self._root.name).free) < size + LEAST:
            raise MorseError(f"only {free >> 20} MB are free on the disk for {size >> 20} MB of files")
        folder = Path(self._root.name) / self._free_folder(event.name)
        folder.mkdir()
        for path, _ in files:
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).touch(exist_ok=False)
        number = len(self._uploads) + 1
        self._uploads[number] = _Upload(folder, files, [0] * len(files))
        return number

    def _free_folder(self, name: str) -> str:
        """A name that no folder has in which models are searched, in the form of a name of Python."""
        word = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")[:40] or "model"
        places = [Path.cwd(), *map(Path, [*self._scene.resource_paths, *self._scene.nearby_paths])]
        places += [*search.resource_dirs(), *search.component_dirs()]
        return free_name(
            word, lambda one: one.lower() in DEVICES or any(os.path.lexists(place / one) for place in places)
        )

    def take(self, event: page.UploadPart) -> None:
        """Store the next bytes of a file."""
        self._attempt(event.request, lambda: self._take(event))

    def _take(self, event: page.UploadPart) -> int:
        upload = self._upload(event.upload)
        if event.file >= len(upload.files):
            raise MorseError(f"the upload has {len(upload.files)} files, not one of number {event.file}")
        path, size = upload.files[event.file]
        try:
            data = base64.b64decode(event.data, validate=True)
        except (binascii.Error, ValueError) as error:
            raise MorseError(f"the data of {quoted(path.as_posix())} are not base64: {error}") from None
        if upload.received[event.file] + len(data) > size:
            raise MorseError(f"{quoted(path.as_posix())} has more than the {size} bytes that were announced")
        with open(upload.folder / path, "ab") as file:
            file.write(data)
        upload.received[event.file] += len(data)
        return upload.received[event.file]

    def _upload(self, number: int) -> _Upload:
        upload = self._uploads.get(number)
        if upload is None:
            raise MorseError(f"there is no upload {number}")
        return upload

    def examine(self, event: page.ExamineUpload) -> None:
        """Read the models in another process: a large one takes seconds. The answer comes when they have been read."""
        if self._services.attempt(event.request, lambda: self._check_complete(event.upload)):
            upload, request = self._uploads[event.upload], event.request
            self._thread = threading.Thread(
                target=lambda: self._examined.put((request, self._examination(upload))),
                name="uploaded models",
                daemon=True,
            )
            self._thread.start()

    def _examination(self, upload: _Upload) -> Examined:
        """What the process says, in a thread that waits for it."""
        name, why = upload.folder.name, "the process that reads it has ended"
        try:
            self._reader = reader = Worker.program(_PROGRAM, is_silent=True)
            try:
                paths = [path.as_posix() for path, _ in upload.files]
                return read_answer(reader.ask(json.dumps([str(upload.folder), paths]).encode(), PATIENCE))
            finally:
                self._reader = None
                reader.kill()
                reader.close()
        except WorkerError as error:
            why = f"{why}{error}: a model takes at most {MOST_SECONDS:g} s and {MOST_MEMORY >> 30} GiB of memory"
        except OSError as error:
            why = f"the process that reads it cannot be started: {error.strerror or error}"
        return Examined([entry(name, why)], [], [])

    def _check_complete(self, number: int) -> None:
        upload = self._upload(number)
        missing = [path for (path, size), own in zip(upload.files, upload.received, strict=True) if own < size]
        if missing:
            raise MorseError(f"{quoted(missing[0].as_posix())} is not complete")
        if self._thread is not None and self._thread.is_alive():
            raise MorseError("another model is being examined: wait until it has been added")

    def update(self) -> None:
        """Answer what has been examined."""
        while not self._examined.empty():
            request, examined = self._examined.get()
            keep(examined.contents)
            self._catalog.add(examined.models)
            self._server.send(Answer(request, True, examined.report))

    def _attempt(self, request: int, action: Callable[[], object]) -> None:
        values: list[object] = []
        if self._services.attempt(request, lambda: values.append(action())):
            self._server.send(Answer(request, True, values[0]))

    # -- saving ----------------------------------------------------------------------------

    def folders(self, kinds: Iterable[str]) -> list[Path]:
        """The folders of the models of these kinds."""
        names = {(robot_file(kind) or kind).partition("/")[0] for kind in kinds}
        return [upload.folder for upload in self._uploads.values() if upload.folder.name in names]

    def save(self, kinds: Iterable[str], script: Path) -> None:
        """Copy the models of these kinds into the folder of models of a script, unless that has been done.

        Raises:
            UnwritableError: the disk refuses it; then nothing is left of it.
        """
        for folder in self.folders(kinds):
            target = saved_place(folder, script)
            if target.is_dir() and _holds(target, folder):
                continue
            try:
                target.parent.mkdir(exist_ok=True)
                if target.parent.is_symlink():  # it may have come with the folder of the script
                    raise UnwritableError(
                        f"{target} is not written: {target.parent.name} is a link to another folder; replace it by a "
                        f"folder, or copy {folder.name} there yourself"
                    )
                target.mkdir()  # never into a folder that somebody else has made
                try:
                    shutil.copytree(folder, target, dirs_exist_ok=True, copy_function=shutil.copyfile)
                except OSError:
                    shutil.rmtree(target, ignore_errors=True)
                    raise
            except OSError as error:
                raise UnwritableError(f"{target} is not written: {error.strerror or error}") from None

    def close(self) -> None:
        """Delete the files, and end the process that reads them."""
        if (reader := self._reader) is not None:
            reader.kill()
        if self._root is not None:
            self._root.cleanup()


def saved_place(folder: Path, script: Path) -> Path:
    """Where a saved scene has an uploaded folder: in ``data`` beside its script, where models are searched."""
    return script.parent / "data" / folder.name


def _holds(target: Path, folder: Path) -> bool:
    files = [path.relative_to(folder) for path in folder.rglob("*") if path.is_file()]
    return all(
        (target / one).is_file() and (target / one).stat().st_size == (folder / one).stat().st_size for one in files
    )


def _checked_path(text: str) -> PurePosixPath:
    """A path below the folder of an upload.

    Raises:
        MorseError: it may lead elsewhere, or is none on some system, or the file is not part of a model.
    """
    parts = text.split("/")
    if len(parts) > _DEEPEST:
        raise MorseError(f"{quoted(text)} is in more than {_DEEPEST - 1} folders")
    for part in parts:
        is_device = part.partition(".")[0].strip().lower() in DEVICES
        if not part or len(part) > _LONGEST or len(part.encode(errors="replace")) > 200:
            raise MorseError(f"{quoted(text)} has a name of {len(part)} characters: 1 to {_LONGEST} are possible")
        if is_device or _ODD_NAME.search(part) or not part.isprintable():
            raise MorseError(f"{quoted(text)} is not a name that files have on all systems: rename {quoted(part)}")
    suffix = PurePosixPath(parts[-1]).suffix.lower()
    if suffix in _NEVER or suffix not in {*_PARTS, *suffixes()}:
        kinds = " ".join(one for one in suffixes() if one not in _NEVER)
        raise MorseError(f"{quoted(text)} is not part of a model: expected files {kinds}, and their pictures")
    return PurePosixPath(*parts)
