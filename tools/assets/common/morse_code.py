"""Text as dots and dashes, the motif of our models."""

from __future__ import annotations

from typing import TYPE_CHECKING

from common.shapes import pill, prism

if TYPE_CHECKING:
    from collections.abc import Iterator

    from common.parts import Part

CODE = dict(
    zip(
        "ABCDEFGHIJKLMNOPQRSTUVWXYZ",
        [
            ".-",
            "-...",
            "-.-.",
            "-..",
            ".",
            "..-.",
            "--.",
            "....",
            "..",
            ".---",
            "-.-",
            ".-..",
            "--",
            "-.",
            "---",
            ".--.",
            "--.-",
            ".-.",
            "...",
            "-",
            "..-",
            "...-",
            ".--",
            "-..-",
            "-.--",
            "--..",
        ],
        strict=True,
    )
)


def signs(text: str) -> Iterator[tuple[str, float]]:
    """Every sign with the position of its centre, in units of one dot, from 0.

    A dash is three units long, the gap within a letter one, between letters three, between words seven.
    """
    place = 0.0
    for word in text.split():
        for letter in word:
            for sign in CODE[letter]:
                length = 3.0 if sign == "-" else 1.0
                yield sign, place + length / 2
                place += length + 1.0
            place += 2.0
        place += 4.0


def length(text: str) -> float:
    """Units of one dot from the start of the first to the end of the last sign."""
    sign, place = list(signs(text))[-1]
    return place + (1.5 if sign == "-" else 0.5)


def inlay(text: str, unit: float, height: float, width: float = 1.0, segments: int = 4) -> list[Part]:
    """The signs as low plates along X on the XY plane, the text centred on the origin."""
    half = length(text) / 2
    return [
        prism(pill((3.0 if sign == "-" else 1.0) * unit, width * unit, segments), height).moved((place - half) * unit)
        for sign, place in signs(text)
    ]
