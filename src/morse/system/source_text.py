"""The text of Python files, in the encoding that they declare (PEP 263)."""

from __future__ import annotations

import io
import linecache
import os
import tokenize

from morse.system.regular_files import SOURCE_LIMIT, is_regular


def encoding_of(source: bytes) -> str:
    """Return the encoding of a Python file.

    Raises:
        SyntaxError: it declares an encoding that does not exist, or its first lines have none.
    """
    return tokenize.detect_encoding(io.BytesIO(source).readline)[0]


def source_text(source: bytes) -> str:
    """Return the text of a Python file, with its own ends of lines.

    Raises:
        SyntaxError: it is not text in its encoding; Python refuses it too.
    """
    encoding = encoding_of(source)
    try:
        return source.decode(encoding)
    except UnicodeDecodeError as error:
        line = source.count(b"\n", 0, error.start) + 1
        raise SyntaxError(f"line {line} is not text in the encoding {encoding}") from None


def encoded_source(text: str) -> bytes:
    """Return a Python file of a text, in the encoding that the text declares.

    Raises:
        SyntaxError: it declares an encoding that does not exist, or that has not all of its characters.
    """
    encoding = encoding_of(text.encode("utf-8", "surrogatepass"))
    try:
        return text.encode(encoding)
    except UnicodeEncodeError as error:
        missing = text[error.start : error.end]
        raise SyntaxError(f"the file declares the encoding {encoding}, which has no {missing!a}") from None


#: characters that are written as themselves in a string, although they need an escape
_ESCAPES = {"\\": "\\\\", '"': '\\"', "'": "\\'"}


def inside_quotes(text: str, quotes: str = "\"'") -> str:
    """Return what stands between quotes of a Python file for a text; its value is the text.

    Args:
        quotes: the characters that are escaped, because one of them delimits the string.
    """
    return "".join(_escaped(character, quotes) for character in text)


def quoted(text: str) -> str:
    """Return a text as a string literal in double quotes."""
    return f'"{inside_quotes(text, chr(34))}"'


def one_line(text: str) -> str:
    """Return a text for a comment or a docstring: printable, on one line, without quotes that end a docstring."""
    return "".join(c if c.isprintable() else " " for c in text).replace('"""', "'''").replace("\\", "/")


def _escaped(character: str, quotes: str) -> str:
    if character == "\\" or character in quotes:
        return _ESCAPES[character]
    if character.isprintable():
        return character
    code = ord(character)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def source_line(file: str, line: int, names: dict[str, object] | None = None) -> str:
    """Return a line of a file without the space around it.

    Args:
        file: name of the file, as in a traceback.
        line: its number, from 1.
        names: the globals of its module, whose loader may know the source.

    Returns:
        The line; empty if there is none, or the file is larger than a script may be, a pipe, which would block, or a
        device, which may never end.
    """
    try:
        status = os.stat(file)
        if not is_regular(status) or status.st_size > SOURCE_LIMIT:
            return ""
    except (OSError, ValueError):
        pass  # the loader of the module may know it
    linecache.lazycache(file, names or {})
    linecache.checkcache(file)
    return linecache.getline(file, line, names).strip()
