"""Other names and quality of service for topics, from a YAML file or a dictionary of the scene script.

The file is a mapping of topics, to a new name or to a mapping of `_ENTRIES`. Of YAML, it may have nested mappings in
block style, quotes and comments.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from morse.core.exceptions import MorseMiddlewareError
from morse.core.reports.quoting import nearest, shown
from morse.rosmsgs.names import checked_topic
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from morse.core.values import DecodedMessage
    from morse.rosmsgs.table import Qos

_RELIABILITY = {"reliable": True, "best_effort": False}
_DURABILITY = {"volatile": False, "transient_local": True}
_ENTRIES = ("topic", "reliability", "durability", "depth")
_DEEPEST = 10_000
_LINE = re.compile(
    r"""(?P<indent>[ ]*)(?P<key>"[^"]*"[ ]*|'[^']*'[ ]*|[^\s"'#:{}\[\],&*!|>%@`-][^"'#:]*):(?:[ ]+(?P<value>.*))?"""
)
_COMMENT = re.compile(r"""^((?:[^"'#]|"[^"]*"|'[^']*')*?)(?:(?:^|(?<=\s))#.*)?$""")


class Remap(NamedTuple):
    """The changes of a topic; None for what stays.

    Attributes:
        where: file and line, for messages.
    """

    where: str
    topic: str | None = None
    reliable: bool | None = None
    latched: bool | None = None
    depth: int | None = None


class Remaps:
    """The changes of all topics.

    Args:
        option: the option ``remap``: name of a file, or topics to names or mappings; None for no changes.
        folders: where the file is searched.

    Raises:
        MorseMiddlewareError: the file cannot be read; the message has the line and what was expected.
    """

    def __init__(self, option: str | Mapping[str, object] | None, folders: Iterable[str] = ()) -> None:
        self._by_topic: dict[str, Remap] = {}
        self._rest: dict[str, str] = {}
        self._topics: set[str] = set()
        entries = _read(_path(option, folders)) if isinstance(option, str) else _of_script(option or {})
        for topic, value, where in entries:
            name = "/" + _checked(topic, where).lstrip("/")
            if name in self._by_topic:
                raise MorseMiddlewareError(f"{where}: the topic {shown(name)} is there twice")
            self._by_topic[name] = _remap(value, where)
            self._rest[name] = where

    def apply(self, topic: str, qos: Qos) -> tuple[str, Qos]:
        """The name and the quality of service of a topic."""
        if not self._by_topic:
            return topic, qos
        self._topics.add(topic)
        change = self._by_topic.get(topic)
        if change is None:
            return topic, qos
        self._rest.pop(topic, None)
        changes = {name: value for name, value in change._asdict().items() if name in qos._fields and value is not None}
        return change.topic or topic, qos._replace(**changes)

    def unused(self) -> Iterator[str]:
        """Iterate once over what is wrong with names that no topic has."""
        for topic, where in self._rest.items():
            yield f"{where}: there is no topic {shown(topic)}{nearest(topic, self._topics)}"
        self._rest = {}


def _path(name: str, folders: Iterable[str]) -> Path:
    path = Path(name)
    candidates = [path, *(Path(folder) / path for folder in folders)]
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    places = ", ".join(dict.fromkeys(str(one.absolute().parent) for one in candidates))
    raise MorseMiddlewareError(f"option 'remap': there is no file {shown(name)} in {places}")


def _of_script(entries: Mapping[str, object]) -> Iterator[tuple[str, object, str]]:
    for topic, value in entries.items():
        where = f"option 'remap', {shown(topic)}"
        inner = {key: (one, where) for key, one in value.items()} if isinstance(value, dict) else value
        yield topic, inner, where


def _read(path: Path) -> Iterator[tuple[str, object, str]]:
    """Iterate over topic, new name or mapping of entries with their lines, and line."""
    topic: tuple[str, object, str] | None = None
    depth: int | None = None
    try:
        lines = read_regular(path).decode("utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise MorseMiddlewareError(f"{path}: {error}") from None
    for number, line in enumerate(lines, 1):
        where = f"{path}, line {number}"
        comment = _COMMENT.match(line)
        text = (comment.group(1) if comment else line).rstrip()
        if not text or text == "---":
            continue
        match = _LINE.fullmatch(text)
        if match is None:
            raise MorseMiddlewareError(f"{where}: {shown(text.strip())}, expected 'name: value', indented by spaces")
        key, value = _plain(match["key"].rstrip(" ")), _plain(match["value"] or "")
        if not match["indent"]:
            if topic is not None:
                yield topic
            topic, depth = (key, value or {}, where), None
        elif topic is None or not isinstance(topic[1], dict) or (depth or len(match["indent"])) != len(match["indent"]):
            raise MorseMiddlewareError(f"{where}: the indentation of {shown(key)} is not that of a value of a topic")
        elif key in topic[1]:
            raise MorseMiddlewareError(f"{where}: {shown(key)} is there twice")
        else:
            depth = len(match["indent"])
            topic[1][key] = value, where
    if topic is not None:
        yield topic


def _plain(text: str) -> str:
    text = text.strip()
    return text[1:-1] if len(text) > 1 and text[0] == text[-1] and text[0] in "\"'" else text


def _checked(topic: object, where: str) -> str:
    if not isinstance(topic, str):
        raise MorseMiddlewareError(f"{where}: {shown(topic)}, expected the name of a topic")
    return checked_topic(topic, f"{where}: the topic")


def _remap(value: object, where: str) -> Remap:
    if not isinstance(value, dict):
        return Remap(where, "/" + _checked(value, where).lstrip("/"))
    if not value:
        raise MorseMiddlewareError(f"{where}: expected a new name, or {', '.join(_ENTRIES)}")
    changes: DecodedMessage = {}
    for key, (entry, line) in value.items():
        if key == "topic":
            changes["topic"] = "/" + _checked(entry, line).lstrip("/")
        elif key == "reliability":
            changes["reliable"] = _word(key, entry, _RELIABILITY, line)
        elif key == "durability":
            changes["latched"] = _word(key, entry, _DURABILITY, line)
        elif key == "depth":
            if not str(entry).isdecimal() or not 0 < int(entry) <= _DEEPEST:
                raise MorseMiddlewareError(f"{line}: depth is {shown(entry)}, expected a number from 1 to {_DEEPEST}")
            changes["depth"] = int(entry)
        else:
            raise MorseMiddlewareError(f"{line}: there is no {shown(key)}{nearest(key, _ENTRIES)}")
    return Remap(where, **changes)


def _word(key: str, value: Any, words: Mapping[str, bool], where: str) -> bool:
    if value not in words:
        choice = " or ".join(words)
        raise MorseMiddlewareError(f"{where}: {key} is {shown(value)}, expected {choice}{nearest(value, words)}")
    return words[value]
