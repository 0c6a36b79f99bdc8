"""Letters as pixels, for images with text."""

from __future__ import annotations

import numpy as np

# five columns per letter, top pixel in bit 0
_COLUMNS = {
    "A": "7e1111117e", "B": "7f49494936", "C": "3e41414122", "D": "7f4141221c", "E": "7f49494941", "F": "7f09090901",
    "G": "3e41495f7a", "H": "7f0808087f", "I": "00417f4100", "J": "2040413f01", "K": "7f08142241", "L": "7f40404040",
    "M": "7f020c027f", "N": "7f0408107f", "O": "3e4141413e", "P": "7f09090906", "Q": "3e4151215e", "R": "7f09192946",
    "S": "2649494932", "T": "01017f0101", "U": "3f4040403f", "V": "1f2040201f", "W": "3f4038403f", "X": "6314081463",
    "Y": "0708700807", "Z": "6151494543", "0": "3e5149453e", "1": "00427f4000", "2": "4261514946", "3": "2141454b31",
    "4": "1814127f10", "5": "2745454539", "6": "3c4a494930", "7": "0171090503", "8": "3649494936", "9": "064949291e",
    " ": "0000000000", "!": "00005f0000", "-": "0808080808",
}  # fmt: skip


def word(text: str, scale: int = 1) -> np.ndarray:
    """(7 scale, 6 scale len(text)) mask, 1 where there is ink."""
    columns: list[int] = []
    for letter in text:
        columns += [*bytes.fromhex(_COLUMNS[letter]), 0]
    bits = (np.array(columns)[None, :] >> np.arange(7)[:, None]) & 1
    return np.kron(bits, np.ones((scale, scale), dtype=int))


def write(picture: np.ndarray, text: str, top: int, left: int, color: np.ndarray, scale: int = 1) -> None:
    """Draw a word into an image (H, W, 3)."""
    ink = word(text, scale).astype(bool)
    picture[top : top + ink.shape[0], left : left + ink.shape[1]][ink] = color


def write_centred(picture: np.ndarray, text: str, top: int, color: np.ndarray, scale: int = 1) -> None:
    write(picture, text, top, (picture.shape[1] - scale * (6 * len(text) - 1)) // 2, color, scale)
