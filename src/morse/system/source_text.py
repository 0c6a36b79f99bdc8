"""The text of Python files, in the encoding that they declare (PEP 263)."""

from __future__ import annotations

import io
import tokenize


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
