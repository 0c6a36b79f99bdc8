"""Reads descriptions of objects that functions have spawned from a recording."""

from __future__ import annotations

import hashlib
import json
import logging
from typing import TYPE_CHECKING, Any

import zstandard

from morse.builder.assembly.spawning import Newcomer
from morse.core.classes.classpath import load_class
from morse.core.exceptions import MorseError
from morse.core.modifier import AbstractModifier
from morse.core.object import Object
from morse.core.reports.quoting import quoted
from morse.recording.errors import RecordingError
from morse.recording.made.packing import OWN
from morse.recording.made.unpacking import Unpacking, unpacked_scene
from morse.recording.made.writing import BLOCKS, OBJECTS, SCENE, TOPIC, TYPE
from morse.recording.mcap.reader import LARGEST
from morse.rosmsgs.cdr import CdrError, decode

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from morse.recording.recording import Recording
    from morse.scene import Scene

logger = logging.getLogger(__name__)

#: maximum size of all meshes and images of a recording, bytes: a small file can contain as many as it wants
_MOST_BYTES = 4 * LARGEST


def _number(value: Any) -> float:
    if type(value) not in (int, float):
        raise TypeError(f"{value!r:.40} is no number")
    return value  # type: ignore[no-any-return]


class Description:
    """The description of an object; a call creates it.

    Args:
        name: of the object.
        title: of the attachment.
        position, rotation: where it was spawned, m and rad.
    """

    def __init__(
        self, source: RecordedMade, name: str, title: str, position: tuple[float, ...], rotation: tuple[float, ...]
    ) -> None:
        self._source, self.name, self.title = source, name, title
        self.position, self.rotation = position, rotation

    def __call__(self) -> Newcomer:
        """Return the object.

        Raises:
            RecordingError: the description is damaged.
        """
        return self._source.newcomer(self)


class RecordedMade:
    """The descriptions in a recording.

    Args:
        recording: the recording.
        modules: returns the modules of the project, whose classes the descriptions may name as well.
        exact: whether an object is refused that is not complete, with the classes of all its components.
        all_kinds: whether objects are described as well whose input names a kind, which creates the same object.

    Raises:
        RecordingError: the names are damaged.
    """

    def __init__(
        self,
        recording: Recording,
        modules: Callable[[], Collection[str]],
        *,
        exact: bool = False,
        all_kinds: bool = True,
    ) -> None:
        self._recording, self._modules, self._exact = recording, modules, exact
        self._contents: dict[str, bytes] = {}
        self._size = 0
        self._warnings: set[str] = set()
        self._descriptions: dict[int, dict[str, Description]] = {}
        try:
            for one in recording.messages(recording.topic_numbers(TOPIC)):
                entry = json.loads(decode(TYPE, one.data)["data"])
                name, title = str(entry["name"]), str(entry["description"])
                place, turn = (tuple(map(_number, entry[part])) for part in ("position", "rotation"))
                if entry.get("kind") and not all_kinds:
                    continue
                description = Description(self, name, title, place, turn)
                self._descriptions.setdefault(int(entry["input"]), {})[name] = description
        except (CdrError, ValueError, LookupError, TypeError, RecursionError) as error:
            raise RecordingError(f"{recording.path}: the names of spawned objects are damaged: {error}") from None

    @staticmethod
    def describe_the_scene(recording: Recording) -> bool:
        """Whether a recording describes the scene; those of the inputs alone, and of earlier versions, do not."""
        return SCENE in recording.attachments and OBJECTS in recording.attachments

    def scene(self) -> Scene:
        """Return the scene at the launch.

        Raises:
            RecordingError: the description is damaged.
        """
        unpacking = self._unpacked(OBJECTS)
        if self._exact and (unlike := [*unpacking.omitted, *unpacking.replaced]):
            raise RecordingError(f"the class of {quoted(unlike[0])} is not a part of MORSE")
        for name in unpacking.omitted:
            self._say_once(f"{quoted(name)} is not shown: its class is not a part of MORSE")
        return unpacked_scene(self._attached(SCENE), unpacking)

    @property
    def is_empty(self) -> bool:
        """Whether there are no descriptions: recordings of earlier versions have none."""
        return not self._descriptions

    def check(self) -> None:
        """Create all objects once.

        Raises:
            RecordingError: a description is damaged, or not complete.
        """
        every = {(one.name, one.title): one for some in self._descriptions.values() for one in some.values()}
        for description in every.values():
            self.newcomer(description)

    def after(self, index: int) -> dict[str, Description]:
        """The objects that the input of this number created; -1 for those present at the beginning."""
        return self._descriptions.get(index, {})

    def known(self, index: int) -> dict[str, Description]:
        """The latest description of each name up to an input."""
        descriptions: dict[str, Description] = {}
        for number in sorted(number for number in self._descriptions if number <= index):
            descriptions |= self._descriptions[number]
        return descriptions

    def newcomer(self, description: Description) -> Newcomer:
        """Create the object of a description.

        Raises:
            RecordingError: the description is damaged.
        """
        try:
            unpacking = self._unpacked(description.title)
            if description.name not in [root.name for root in unpacking.roots]:
                raise RecordingError("its description is that of another object")
            if self._exact and (unlike := [*unpacking.omitted, *unpacking.replaced]):
                raise RecordingError(f"the class of {quoted(unlike[0])} is not a part of MORSE or of this project")
        except RecordingError as error:
            self._say_once(f"{quoted(description.name)} is not shown: {error}")
            raise
        for name in unpacking.omitted:
            self._say_once(f"{quoted(name)} is not shown: its class is not a part of MORSE or of this project")
        return Newcomer(unpacking.roots, unpacking.components)

    def _say_once(self, text: str) -> None:
        if text not in self._warnings:
            self._warnings.add(text)
            logger.warning("%s", text)

    def _unpacked(self, name: str) -> Unpacking:
        content = self._attached(name)
        try:
            return Unpacking(content, self._block, self._class_of)
        except RecordingError as error:
            raise RecordingError(f"{self._recording.path}: {error}") from None

    def _attached(self, name: str) -> bytes:
        """The content of an attachment, which is decompressed once."""
        if name not in self._contents:
            content = self._decompressed(name)
            self._size += len(content)
            if self._size > _MOST_BYTES:
                raise RecordingError(f"{self._recording.path}: the meshes are larger than {_MOST_BYTES >> 20} MiB")
            self._contents[name] = content
        return self._contents[name]

    def _decompressed(self, name: str) -> bytes:
        data = self._recording.attachment(name)
        if data is None:
            raise RecordingError(f"{self._recording.path}: the attachment {name[:80]!r} is missing")
        try:
            reader = zstandard.ZstdDecompressor(max_window_size=LARGEST).stream_reader(data)
            content = reader.read(LARGEST + 1)
        except zstandard.ZstdError as error:
            raise RecordingError(f"{self._recording.path}: {name[:80]} is damaged: {error}") from None
        if len(content) > LARGEST:
            raise RecordingError(f"{self._recording.path}: {name[:80]} is larger than {LARGEST >> 20} MiB")
        return content

    def _block(self, digest: str) -> bytes:
        name = f"{BLOCKS}{digest}"
        is_new = name not in self._contents
        block = self._attached(name)
        if is_new and hashlib.sha256(block).hexdigest() != digest:
            del self._contents[name]
            raise RecordingError(f"{self._recording.path}: the block {digest[:80]} is damaged")
        return block

    def _class_of(self, paths: list[str]) -> str | None:
        """The first class that is one of MORSE or of the project: other modules might be programs."""
        for path in paths:
            module = path.rpartition(".")[0]
            if not path.startswith(OWN) and module not in self._modules():
                continue
            try:
                cls = load_class(path)
            except (MorseError, ImportError):
                continue
            if issubclass(cls, (Object, AbstractModifier)) and not getattr(cls, "__abstractmethods__", None):
                return path
        return None
