"""Bottles in the text form of YARP: ``1 2.5 "some text" (a list) [word]``."""

from __future__ import annotations

import re

from morse.plugins.yarp.bottle import BottleError, Vocab

#: a value: brackets, a text in quotes, or a word up to the next blank
_TOKEN = re.compile(r'[\s,]*([()]|\[[^\]\s]{0,8}\]|\{[^}]*\}|"(?:[^"\\]|\\.)*"|[^\s,()"\[\]{}]+)', re.DOTALL)
_INTEGER = re.compile(r"[+-]?(?:0[xX][0-9a-fA-F]{1,8}|\d{1,19})$")
#: a run of digits belongs to one part only: the time for a word of n digits that is not a number is O(n), not O(n²)
_NUMBER = re.compile(r"[+-]?(?:\d++(?:\.\d*+)?|\.\d++)(?:[eE][+-]?\d++)?$|-?inf$|nan$")
_BARE = re.compile(r"[A-Za-z_][A-Za-z_0-9.-]*$")
_ESCAPES = {"n": "\n", "r": "\r", "0": "\0"}
_ESCAPED = {"\\": r"\\", '"': r"\"", "\n": r"\n", "\r": r"\r", "\0": r"\0"}
_DEEPEST = 32


def to_text(values: list[object]) -> str:
    """The text of a bottle, on one line."""
    return " ".join(map(_text, values))


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Vocab):
        return f"[{value}]"
    if isinstance(value, str):
        if _BARE.match(value) and value not in ("true", "false", "inf", "nan", "null"):
            return value
        return '"' + "".join(_ESCAPED.get(letter, letter) for letter in value) + '"'
    if isinstance(value, bytes):
        return "{" + " ".join(map(str, value)) + "}"
    if isinstance(value, (list, tuple)):
        return "(" + to_text(list(value)) + ")"
    return repr(value)


def from_text(text: str) -> list[object]:
    """The values of a text.

    Raises:
        BottleError: a bracket or a quote is not closed, or it is nested too deeply.
    """
    stack: list[list[object]] = [[]]
    place = 0
    text = text.rstrip()
    while place < len(text):
        match = _TOKEN.match(text, place)
        if match is None:
            raise BottleError("a bracket or a quote is not closed")
        place = match.end()
        token = match[1]
        if token == "(":
            stack.append([])
            if len(stack) > _DEEPEST:
                raise BottleError("it is nested too deeply")
        elif token == ")":
            if len(stack) == 1:
                raise BottleError("a bracket is closed that was not opened")
            inner = stack.pop()
            stack[-1].append(inner)
        else:
            stack[-1].append(_value(token))
    if len(stack) > 1:
        raise BottleError("a bracket is not closed")
    return stack[0]


def _value(token: str) -> object:
    if token[0] == '"':
        return re.sub(r"\\(.)", lambda match: _ESCAPES.get(match[1], match[1]), token[1:-1], flags=re.DOTALL)
    if token[0] == "[":
        return Vocab(token[1:-1])
    if token[0] == "{":
        return _bytes(token[1:-1])
    if _INTEGER.match(token):
        return int(token, 16 if "x" in token.lower() else 10)
    if _NUMBER.match(token):
        return float(token)
    if token in ("true", "false"):
        return token == "true"
    return token


def _bytes(text: str) -> bytes:
    try:
        return bytes(int(number) for number in text.split())
    except ValueError:
        raise BottleError("the bytes of a blob are numbers from 0 to 255") from None
