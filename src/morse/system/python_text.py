"""Text of others in Python files that MORSE writes: a name in a model file must not become a statement."""

from __future__ import annotations

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
