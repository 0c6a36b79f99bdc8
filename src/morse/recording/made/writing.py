"""Writes descriptions of objects that functions have spawned into a recording."""

from __future__ import annotations

import json
import logging
from functools import partial
from typing import TYPE_CHECKING, Any

import zstandard

from morse.recording.made.packing import Packing, scene_to_bytes
from morse.rosmsgs.cdr import encode
from morse.rosmsgs.table import Qos

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from morse.recording.disk import Disk
    from morse.recording.made.made import Made
    from morse.recording.mcap.writer import McapWriter
    from morse.recording.streams import TopicFile
    from morse.scene import Scene

logger = logging.getLogger(__name__)

#: topic of the names, and prefixes of the attachments
TOPIC, TYPE, DESCRIPTIONS, BLOCKS = "/morse/made", "std_msgs/msg/String", "made/", "blocks/"
#: names of the attachments that describe the scene: its settings; its nodes and components
SCENE, OBJECTS = "scene/settings", "scene/objects"
_MEDIA_TYPE = "application/zstd"


class MadeObjects:
    """Writes the description of the scene, and of each present object that was spawned, once.

    Args:
        topic_file, disk: receive the messages and the attachments.
        present: returns the present objects by name.
        count: returns the number of recorded inputs.
        scene: the scene at the launch.
        objects: the components by name.
    """

    def __init__(
        self,
        topic_file: TopicFile,
        disk: Disk,
        present: Callable[[], Mapping[str, Made]],
        count: Callable[[], int],
        scene: Scene,
        objects: Mapping[str, Any],
    ) -> None:
        self._topic_file, self._disk = topic_file, disk
        self._present, self._count = present, count
        self._identities: dict[str, object] = {}
        self._digests_so_far: set[str] = set()
        self._digests: dict[int, tuple[object, str]] = {}
        self._number = 0
        self._objects = objects
        self._describe(scene)
        self.follow()

    def _describe(self, scene: Scene) -> None:
        try:
            packing = Packing(scene.roots, scene.components, self._digests, self._objects)
            objects, settings = packing.to_bytes(), scene_to_bytes(scene)
        except Exception as error:  # a scene script may set values of any class
            self._digests.clear()
            logger.warning(
                "the scene cannot be described: to show the recording, morse replay will need the script: %s", error
            )
            return
        self._attach_blocks(packing.blocks)
        self._attach(OBJECTS, objects)
        self._attach(SCENE, settings)

    def follow(self) -> None:
        """Objects may have been spawned or deleted."""
        present = self._present()
        for name, entry in present.items():
            if self._identities.get(name) is entry.identity:
                continue
            try:
                newcomer = entry.describe()
                packing = Packing(newcomer.roots, newcomer.components, self._digests, self._objects)
                data = packing.to_bytes()
            except Exception as error:  # a component of the user may have values of any class
                self._digests.clear()
                logger.warning(
                    "'%s' cannot be described: the recording does not show it%s: %s",
                    name[:80],
                    "" if entry.kind else ", and cannot be simulated again, because a function spawned it",
                    error,
                )
                self._name(name, entry, "")
                continue
            self._write(name, entry, data, packing.blocks)
        self._identities = {name: entry.identity for name, entry in present.items()}

    def _write(self, name: str, entry: Made, data: bytes, blocks: Mapping[str, bytes]) -> None:
        self._attach_blocks(blocks)
        title = f"{DESCRIPTIONS}{self._number}"
        self._number += 1
        self._attach(title, data)
        self._name(name, entry, title)

    def _attach_blocks(self, blocks: Mapping[str, bytes]) -> None:
        for digest, block in blocks.items():
            if digest not in self._digests_so_far:
                self._digests_so_far.add(digest)
                self._attach(f"{BLOCKS}{digest}", block)

    def _name(self, name: str, entry: Made, title: str) -> None:
        line = {
            "name": name,
            "input": self._count() - 1,
            "position": [_number(value) for value in entry.position],
            "rotation": [_number(value) for value in entry.rotation],
            "description": title,
            "kind": entry.kind,
        }
        self._topic_file.topic(TOPIC, TYPE, Qos(1000)).publish(encode(TYPE, {"data": json.dumps(line)}))

    def _attach(self, name: str, data: bytes) -> None:
        self._disk.other(partial(_attach, name=name, data=data))


def _number(value: float) -> float:
    # a saved state contains integers as integers
    return value if type(value) is int else float(value)


def _attach(file: McapWriter, name: str, data: bytes) -> None:
    # in the thread of the disk
    file.attachment(name, _MEDIA_TYPE, zstandard.ZstdCompressor(level=3).compress(data))
