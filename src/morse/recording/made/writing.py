"""Writes descriptions of objects that functions have spawned into a recording."""

from __future__ import annotations

import json
import logging
from functools import partial
from typing import TYPE_CHECKING

import zstandard

from morse.middleware.ros2.backends.backend import Qos
from morse.middleware.ros2.cdr import encode
from morse.recording.made.packing import Packing

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from morse.recording.disk import Disk
    from morse.recording.made.made import Made
    from morse.recording.mcap.writer import McapWriter
    from morse.recording.streams import Tape

logger = logging.getLogger(__name__)

#: topic of the names, and prefixes of the attachments
TOPIC, TYPE, DESCRIPTIONS, BLOCKS = "/morse/made", "std_msgs/msg/String", "made/", "blocks/"
_MEDIA_TYPE = "application/zstd"


class MadeObjects:
    """Writes the description of each present object that a function spawned, once.

    Args:
        tape, disk: receive the messages and the attachments.
        present: returns the present objects by name.
        count: returns the number of recorded inputs.
    """

    def __init__(
        self, tape: Tape, disk: Disk, present: Callable[[], Mapping[str, Made]], count: Callable[[], int]
    ) -> None:
        self._tape, self._disk = tape, disk
        self._present, self._count = present, count
        self._known: dict[str, object] = {}
        self._written: set[str] = set()
        self._packed: dict[int, tuple[object, str]] = {}
        self._number = 0
        self.follow()

    def follow(self) -> None:
        """Objects may have been spawned or deleted."""
        present = self._present()
        for name, made in present.items():
            if self._known.get(name) is made.identity:
                continue
            try:
                newcomer = made.describe()
                packing = Packing(newcomer.roots, newcomer.components, self._packed)
                data = packing.to_bytes()
            except Exception as error:  # a component of the user may have values of any class
                self._packed.clear()
                logger.warning(
                    "'%s' was spawned by a function and cannot be described: the recording does not show it, and "
                    "cannot be simulated again: %s",
                    name[:80],
                    error,
                )
                self._name(name, made, "")
                continue
            self._write(name, made, data, packing.blocks)
        self._known = {name: made.identity for name, made in present.items()}

    def _write(self, name: str, made: Made, data: bytes, blocks: Mapping[str, bytes]) -> None:
        for digest, block in blocks.items():
            if digest not in self._written:
                self._written.add(digest)
                self._attach(f"{BLOCKS}{digest}", block)
        title = f"{DESCRIPTIONS}{self._number}"
        self._number += 1
        self._attach(title, data)
        self._name(name, made, title)

    def _name(self, name: str, made: Made, title: str) -> None:
        said = {
            "name": name,
            "input": self._count() - 1,
            "position": [_number(value) for value in made.position],
            "rotation": [_number(value) for value in made.rotation],
            "description": title,
        }
        self._tape.topic(TOPIC, TYPE, Qos(1000)).publish(encode(TYPE, {"data": json.dumps(said)}))

    def _attach(self, name: str, data: bytes) -> None:
        self._disk.other(partial(_attach, name=name, data=data))


def _number(value: float) -> float:
    # a saved state contains integers as integers
    return value if type(value) is int else float(value)


def _attach(file: McapWriter, name: str, data: bytes) -> None:
    # in the thread of the disk
    file.attachment(name, _MEDIA_TYPE, zstandard.ZstdCompressor(level=3).compress(data))
