"""Images for walls and screens, as targets for cameras; (H, W, 3) sRGB, row 0 at the top."""

from __future__ import annotations

import numpy as np

from common.colors import BERRY, CORAL, CREAM, DEEP_TEAL, LEAF, MINT, NAVY, PLUM, SKY, SUN, TEAL, WHITE, srgb
from common.lettering import write, write_centred
from common.morse_code import CODE

HEIGHT, WIDTH = 512, 288


def blank(color: str) -> np.ndarray:
    return np.broadcast_to(srgb(color), (HEIGHT, WIDTH, 3)).copy()


def alphabet() -> np.ndarray:
    """The Morse alphabet in two columns."""
    picture = blank(CREAM)
    picture[:64] = srgb(TEAL)
    write_centred(picture, "MORSE", 18, srgb(WHITE), 4)
    for number, letter in enumerate(CODE):
        top, left = 78 + 33 * (number % 13), 18 + 142 * (number // 13)
        write(picture, letter, top, left, srgb(NAVY), 3)
        start = left + 32
        for sign in CODE[letter]:
            length = 24 if sign == "-" else 9
            picture[top + 6 : top + 15, start : start + length] = srgb(CORAL)
            start += length + 6
    return picture


def checkerboard() -> np.ndarray:
    """A chequerboard for camera calibration: 7 x 12, black on white."""
    picture = blank("#ffffff")
    side, top, left = 36, 20, 18
    rows, columns = np.mgrid[0:12, 0:7]
    board = ((rows + columns) % 2)[..., None] * np.array([0.96, 0.96, 0.96]) + 0.03
    picture[top : top + 12 * side, left : left + 7 * side] = np.kron(board, np.ones((side, side, 1)))
    write_centred(picture, "12 X 7", 470, srgb(NAVY), 4)
    return picture


def colour_chart() -> np.ndarray:
    """Patches of known colours, and a row of greys."""
    picture = blank(NAVY)
    patches = [CORAL, SUN, LEAF, TEAL, SKY, PLUM, BERRY, MINT, CREAM, "#ff0000", "#00ff00", "#0000ff"]
    greys = ["#ffffff", "#aaaaaa", "#555555"]
    for number, color in enumerate([*patches, *greys]):
        row, column = divmod(number, 3)
        picture[24 + 94 * row : 108 + 94 * row, 18 + 86 * column : 98 + 86 * column] = srgb(color)
    return picture


def hello() -> np.ndarray:
    """The face of the mascot, and a greeting."""
    picture = blank(SUN)
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH].astype(float)

    def disc(top: float, left: float, down: float, across: float, power: float = 2.0) -> np.ndarray:
        return np.abs((y - top) / down) ** power + np.abs((x - left) / across) ** power < 1

    for shape, color in (
        (disc(200, 38, 52, 24), CORAL),
        (disc(200, 250, 52, 24), CORAL),
        (disc(200, 144, 108, 104, 4), CREAM),
        (disc(200, 144, 84, 86, 4.5), NAVY),
        (disc(186, 104, 36, 22), "#c9f5ff"),
        (disc(186, 184, 36, 22), "#c9f5ff"),
        (disc(170, 110, 9, 7), WHITE),
        (disc(170, 190, 9, 7), WHITE),
        (disc(232, 78, 9, 14), CORAL),
        (disc(232, 210, 9, 14), CORAL),
        (disc(226, 144, 24, 28) & ~disc(216, 144, 24, 30), "#c9f5ff"),
        (disc(62, 144, 12, 12), CORAL),
        (disc(82, 144, 14, 3), DEEP_TEAL),
    ):
        picture[shape] = srgb(color)
    write_centred(picture, "HELLO", 352, srgb(DEEP_TEAL), 8)
    write_centred(picture, "ROBOT!", 430, srgb(DEEP_TEAL), 6)
    return picture


def plate(text: str) -> np.ndarray:
    """A name plate, twice as wide as high, with the name in letters and in Morse code."""
    picture = np.broadcast_to(srgb(CREAM), (128, 160, 3)).copy()
    picture[:8] = picture[-8:] = srgb(CORAL)
    write_centred(picture, text, 36, srgb(NAVY), 4)
    signs = "  ".join(CODE[letter] for letter in text)
    width = sum({"-": 6, ".": 2, " ": 2}[sign] + 1 for sign in signs)
    start = (160 - width) // 2
    for sign in signs:
        length = {"-": 6, ".": 2, " ": 2}[sign]
        if sign != " ":
            picture[84:90, start : start + length] = srgb(CORAL)
        start += length + 1
    return picture


def sketch() -> np.ndarray:
    """A whiteboard after a meeting: boxes, arrows and a plan."""
    picture = np.broadcast_to(srgb("#fdfdfb"), (256, 400, 3)).copy()
    ink = {"blue": srgb("#2b57b8"), "red": srgb("#c8322b"), "green": srgb("#2c8a45")}
    for top, left, text, color in ((36, 30, "SENSE", "blue"), (36, 160, "PLAN", "green"), (36, 290, "ACT", "red")):
        picture[top : top + 40, left : left + 84] = ink[color]
        picture[top + 3 : top + 37, left + 3 : left + 81] = srgb("#fdfdfb")
        write(picture, text, top + 13, left + 42 - 6 * len(text), ink[color], 2)
    for left in (118, 248):
        picture[55:58, left : left + 34] = ink["blue"]
        for k in range(8):
            picture[56 - k : 57 + k + 1, left + 34 - k : left + 36 - k] = ink["blue"]
    x = np.arange(340)
    curve = (175 - 45 * np.exp(-x / 120) * np.cos(x / 18)).astype(int)
    for k in range(3):
        picture[curve + k, x + 30] = ink["red"]
    picture[120:232, 28:30] = picture[230:232, 28:372] = srgb("#333333")
    return picture
