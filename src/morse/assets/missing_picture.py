"""The picture that replaces pictures that are missing or cannot be read."""

from __future__ import annotations

import functools
import io

#: size and pixels of a square of the pattern; its two colours
_SIZE, _SQUARE = 16, 4
_COLOURS = ((255, 255, 255), (255, 0, 255))


@functools.cache
def chequered() -> bytes:
    """Return a chequered pattern in white and magenta, 16 x 16 pixels, PNG."""
    from PIL import Image

    pattern = Image.new("RGB", (_SIZE, _SIZE))
    squares = ((x, y) for y in range(_SIZE) for x in range(_SIZE))
    pattern.putdata([_COLOURS[(x // _SQUARE + y // _SQUARE) % 2] for x, y in squares])
    file = io.BytesIO()
    pattern.save(file, "PNG")
    return file.getvalue()
