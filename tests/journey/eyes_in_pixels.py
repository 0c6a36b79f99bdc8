"""Finds the eyes of the ranger in a picture of the live view."""

from pathlib import Path

import numpy as np
from PIL import Image


def eyes(picture: Path) -> list[tuple[float, float, float]]:
    """The eyes from left to right in the picture: x of the centre, and the position of the pupil.

    Returns:
        For each eye the column of its centre, and right and up offset of the pupil's centre, pixels.
    """
    pixels = np.asarray(Image.open(picture).convert("RGB"), dtype=int)
    brightest, darkest = pixels.max(axis=2), pixels.min(axis=2)
    white = (darkest > 150) & (brightest - darkest < 40)
    found = []
    for rows, columns in _blobs(white, at_least=300):
        top, bottom, left, right = rows.min(), rows.max(), columns.min(), columns.max()
        if not 0.5 < (bottom - top) / max(right - left, 1) < 2.0:
            continue
        inside = brightest[top : bottom + 1, left : right + 1] < 70
        dark_rows, dark_columns = np.nonzero(inside)
        if not 0.02 * inside.size < len(dark_rows) < 0.5 * inside.size:
            continue
        middle = ((bottom - top) / 2, (right - left) / 2)
        found.append((left + middle[1], dark_columns.mean() - middle[1], middle[0] - dark_rows.mean()))
    return sorted(found)


def _blobs(mask: np.ndarray, at_least: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Connected regions of a mask, as rows and columns of their pixels."""
    left = mask.copy()
    regions = []
    while left.any():
        start = tuple(np.argwhere(left)[0])
        stack, rows, columns = [start], [], []
        left[start] = False
        while stack:
            row, column = stack.pop()
            rows.append(row)
            columns.append(column)
            for r, c in ((row + 1, column), (row - 1, column), (row, column + 1), (row, column - 1)):
                if 0 <= r < mask.shape[0] and 0 <= c < mask.shape[1] and left[r, c]:
                    left[r, c] = False
                    stack.append((r, c))
        if len(rows) >= at_least:
            regions.append((np.array(rows), np.array(columns)))
    return regions
