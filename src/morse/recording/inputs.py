"""The journal of inputs as a topic, readable by humans and exact for a replay."""

from __future__ import annotations

import ast
import base64
import json
from typing import TYPE_CHECKING, Any

from morse.recording.errors import RecordingError
from morse.rosmsgs.cdr import CdrError, decode, encode
from morse.rosmsgs.table import Qos

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.journal import Entry, Journal
    from morse.recording.streams import TopicFile

TOPIC = "/morse/inputs"
TYPE = "std_msgs/msg/String"
_LENGTH = 2000


def as_message(entry: Entry, pack: Callable[[Entry], bytes], complain: Callable[[ValueError], object]) -> bytes:
    """The message of the topic for an entry.

    Args:
        entry: an entry of the journal.
        pack: encodes an entry as bytes; raises ValueError for values without a representation.
        complain: called with that error.
    """
    exact: str | None = None
    try:
        exact = base64.b64encode(pack(entry)).decode()
    except ValueError as error:
        complain(error)
    text = repr(entry.content)
    line = {
        "tick": entry.tick,
        "kind": entry.kind,
        "name": entry.name,
        "life": entry.life,
        "order": entry.order,
        "content": text if len(text) <= _LENGTH else f"{text[:_LENGTH]}…",
        "exact": exact,
    }
    return encode(TYPE, {"data": json.dumps(line)})


class Inputs:
    """Records all inputs.

    Args:
        journal: the journal of the simulation.
        topic_file: receives the messages.
        pack: encodes an entry as bytes; raises ValueError for values without a representation.

    Attributes:
        count: number of recorded inputs.
    """

    def __init__(self, journal: Journal, topic_file: TopicFile, pack: Callable[[Entry], bytes]) -> None:
        self._journal, self._pack = journal, pack
        self._topic = topic_file.topic(TOPIC, TYPE, Qos(1000))
        self.count = 0
        journal.sinks.append(self._take)

    def _take(self, entry: Entry) -> None:
        # objects that functions spawned have descriptions (`morse.recording.made`)
        self._topic.publish(as_message(entry, self._pack, lambda error: None))
        self.count += 1

    def close(self) -> None:
        """Stop recording."""
        if self._take in self._journal.sinks:
            self._journal.sinks.remove(self._take)


class LostInput(RecordingError):
    """An input that cannot be written to a file: a robot was spawned by a function.

    Attributes:
        tick, kind, name, life, order: see `morse.core.journal.Entry`.
    """

    def __init__(self, tick: int, kind: str, name: str, life: int, order: int) -> None:
        super().__init__(f"the recording cannot be simulated again: '{name[:80]}' was made by a function of a program")
        self.tick, self.kind, self.name, self.life, self.order = tick, kind, name, life, order


def readable_entry(data: bytes) -> dict[str, Any]:
    """The readable part of a message of the topic; empty if it is damaged.

    Returns:
        Its ``tick``, ``kind``, ``name`` and others; ``content`` is a mapping, empty for all but commands.
    """
    try:
        line = json.loads(decode(TYPE, data)["data"])
        text = line["content"] if line.get("kind") == "command" else "{}"
        content = ast.literal_eval(text) if len(text) <= _LENGTH else {}
        if not isinstance(content, dict):
            return {}
    except (CdrError, ValueError, LookupError, TypeError, AttributeError, RecursionError, SyntaxError, MemoryError):
        return {}
    return {**line, "content": content}


def exact_entry(data: bytes) -> bytes:
    """The bytes of an entry in a message of the topic.

    Raises:
        LostInput: the message is not exact.
        RecordingError: the message is damaged.
    """
    try:
        line: Any = json.loads(decode(TYPE, data)["data"])
        exact = line["exact"]
        if exact is None:
            life, order = int(line.get("life", 0)), int(line.get("order", -1))
            raise LostInput(int(line["tick"]), str(line["kind"]), str(line["name"]), life, order)
        return base64.b64decode(exact, validate=True)
    except (CdrError, ValueError, LookupError, TypeError, RecursionError) as error:
        raise RecordingError(f"an input of the recording is damaged: {error}") from None
