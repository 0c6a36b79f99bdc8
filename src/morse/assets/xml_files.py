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
_COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)


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
    """Return the root element of the content of a file; see `read_xml`."""
    # several programs write "--" into comments
    data = _COMMENT.sub(b"", data.strip()).strip()
    _check(data, path)
    try:
        return ElementTree.fromstring(data)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise AssetError(path, f"it is not XML: {error}") from None


def _check(data: bytes, path: Path) -> None:
    parser = expat.ParserCreate()
    depth = 0

    def entity(name: str, *_: object) -> None:
        raise AssetError(path, f"it defines the entity '{name:.60}'; files with entities are not read")

    def begin(*_: object) -> None:
        nonlocal depth
        depth += 1
        if depth > _DEEPEST:
            raise AssetError(path, f"its elements are nested more than {_DEEPEST} deep")

    def end(_: str) -> None:
        nonlocal depth
        depth -= 1

    parser.EntityDeclHandler = entity
    parser.StartElementHandler, parser.EndElementHandler = begin, end
    try:
        parser.Parse(data, True)
    except AssetError:
        raise
    except (expat.ExpatError, ValueError, LookupError) as error:
        raise AssetError(path, f"it is not XML: {error}") from None
