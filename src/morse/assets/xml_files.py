"""Untrusted XML files."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING
from xml.etree import ElementTree
from xml.parsers import expat

from morse.assets.errors import AssetError
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from pathlib import Path

#: maximum size, bytes, and maximum depth of nested elements
MOST_BYTES, _DEEPEST = 64 << 20, 200
#: a tag, and the end of a value that the name of the next attribute touches
_TAG, _TOUCHING = re.compile(rb"<[^<>]*>"), re.compile(rb"""(=\s*(?:"[^"]*"|'[^']*'))(?=[A-Za-z_])""")


class LocatedElement(ElementTree.Element):
    """An element that knows the line of the file in which it begins."""

    __slots__ = ("line",)
    line: int


def line_of(element: ElementTree.Element | None) -> str:
    """Return " (line 12)" for the end of a message; nothing if the line is not known, as in expanded macros."""
    line = getattr(element, "line", 0)
    return f" (line {line})" if line else ""


def read_xml(path: Path) -> ElementTree.Element:
    """Return the root element of a file.

    Raises:
        AssetError: it is not XML, too large, nested too deeply, or defines entities, whose expansion can be of any
            size.
        OSError: it cannot be opened.
    """
    if path.stat().st_size > MOST_BYTES:
        raise AssetError(path, f"it is larger than {MOST_BYTES >> 20} MB")
    return parse_xml(read_regular(path, MOST_BYTES), path)


def parse_xml(data: bytes, path: Path) -> ElementTree.Element:
    """Return the root element of the content of a file; see `read_xml`.

    The programs that robots are written for also accept what is not XML: comments with double dashes, prefixes without
    a namespace, Latin-1 without a declaration, attributes without a space between them, and a zero at the end. A prefix
    without a namespace remains part of the name.
    """
    data = _in_lines(_without_comments(data.rstrip()).rstrip())
    try:
        return _parsed(data, path)
    except (expat.ExpatError, ValueError, LookupError) as error:
        try:
            return _parsed(_mended(data), path)
        except (expat.ExpatError, ValueError, LookupError):
            raise AssetError(path, f"it is not XML: {error}") from None


def _without_comments(data: bytes) -> bytes:
    """Return a text with the ends of lines of its comments only.

    No regular expression: it would search the end of each of a million comments that have none.
    """
    parts, place = [], 0
    while (begin := data.find(b"<!--", place)) >= 0 and (end := data.find(b"-->", begin + 4)) >= 0:
        parts += [data[place:begin], b"\n" * data.count(b"\n", begin, end)]
        place = end + 3
    return b"".join([*parts, data[place:]])


def _in_lines(data: bytes) -> bytes:
    """Return a text without the space at its begin, but with the same lines, which errors name."""
    text = data.lstrip()
    begin = text.find(b"?>") + 2 if text.startswith(b"<?xml") else 0
    return text[:begin] + b"\n" * data[: len(data) - len(text)].count(b"\n") + text[begin:]


def _mended(data: bytes) -> bytes:
    data = data.rstrip(b"\0 \t\r\n")
    try:
        data.decode()
    except UnicodeDecodeError:
        data = data.decode("latin-1").encode()
    return _TAG.sub(lambda tag: _TOUCHING.sub(rb"\1 ", tag[0]), data)


def _parsed(data: bytes, path: Path) -> ElementTree.Element:
    """Return the root element; a prefix without a namespace is a part of the name."""
    tree = _tree(data, path, None)
    try:
        return _tree(data, path, "}") if b"xmlns" in data else tree
    except expat.ExpatError:
        return tree


def _tree(data: bytes, path: Path, separator: str | None) -> ElementTree.Element:
    builder = ElementTree.TreeBuilder(element_factory=LocatedElement)
    parser = expat.ParserCreate(namespace_separator=separator)
    depth = 0

    def entity(name: str, *_: object) -> None:
        raise AssetError(path, f"it defines the entity '{name:.60}'; files with entities are not read")

    def begin(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > _DEEPEST:
            raise AssetError(path, f"its elements are nested more than {_DEEPEST} deep")
        names = {_qualified(name): value for name, value in attributes.items()}
        builder.start(_qualified(tag), names).line = parser.CurrentLineNumber  # type: ignore[attr-defined]

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(_qualified(tag))

    parser.buffer_text = True
    parser.EntityDeclHandler = entity
    parser.StartElementHandler, parser.EndElementHandler = begin, end
    parser.CharacterDataHandler = builder.data
    parser.Parse(data, True)
    return builder.close()


def _qualified(name: str) -> str:
    return f"{{{name}" if "}" in name else name
