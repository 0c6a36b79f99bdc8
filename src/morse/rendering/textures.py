"""Textures of materials for the kernel."""

from __future__ import annotations

import hashlib
import logging
import math
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image as Picture

from morse.kernel.drawing.arrays import ENCODED, TEXTURE
from morse.mathutils.portable import linear_light
from morse.system.pictures import load_readers, open_picture

if TYPE_CHECKING:
    from collections.abc import Iterable
    from concurrent.futures import Future

    from numpy.typing import NDArray

    from morse.scene import Image


logger = logging.getLogger(__name__)
# textures may be read within a tick, when there may be no file descriptor left
load_readers()

#: maximum number of texels along a side; larger images are scaled down
_MOST_ASIDE = 2048
_codes = np.arange(256) / 255
#: (256,) linear light of sRGB codes
LINEAR = linear_light(_codes)
#: opacity in the format of texels
_ALPHAS = (_codes * 3 + 0.5).astype(np.uint32) << np.uint32(30)


class TextureStore:
    """Textures by image, decoded once."""

    def __init__(self) -> None:
        self._numbers: dict[int, int] = {}
        self._images: list[Image] = []
        self._rows: list[tuple[int, ...]] = []
        self._texels: list[NDArray[np.int32]] = []
        self._masked: list[bool] = []
        self._size = 0
        #: the sizes of textures that were enlarged, relative to those of their texels
        self._true_sizes: dict[int, float] = {}
        #: the first texture of each content that was added
        self._same: dict[bytes, int] = {}
        self._ahead: dict[int, Future[NDArray[np.uint8]]] = {}

    def read_ahead(self, images: Iterable[Image]) -> None:
        """Decode textures in advance in a separate thread."""
        if new_images := {id(image): image for image in images if id(image) not in self._numbers}:
            # the decoders of Pillow run without the GIL
            pool = ThreadPoolExecutor(1, thread_name_prefix="morse-textures")
            self._ahead = {key: pool.submit(_pixels, image) for key, image in new_images.items()}
            pool.shutdown(wait=False)

    def number(self, image: Image) -> int:
        """The index of the texture of an image."""
        number = self._numbers.get(id(image))
        if number is None:
            # keeps the image alive, so that its id is not reused
            self._images.append(image)
            ahead = self._ahead.pop(id(image), None)
            number = self._numbers[id(image)] = self._add(_pixels(image) if ahead is None else ahead.result())
        return number

    def add(self, pixels: NDArray[np.uint8], light: NDArray[np.float64] = LINEAR) -> int:
        """Add a texture of pixels (H, W, 4), RGBA, as OpenGL has it; return its number.

        The texture coordinate v is 0 in the first row. Sizes that are not powers of two become larger, but each level
        shows what that of OpenGL does.

        Args:
            light: (256,) the light of each code, 0 to 1; by default that of sRGB.
        """
        digest = hashlib.blake2b(f"{pixels.shape}".encode() + light.tobytes() + pixels.tobytes()).digest()
        like = self._same.setdefault(digest, len(self._rows))
        if like < len(self._rows):
            # sides of a sky are often the same
            self._rows.append(self._rows[like])
            self._masked.append(self._masked[like])
            if like in self._true_sizes:
                self._true_sizes[len(self._rows) - 1] = self._true_sizes[like]
            return len(self._rows) - 1
        height, width = pixels.shape[:2]
        if width & (width - 1) == 0 and height & (height - 1) == 0 and max(width, height) <= _MOST_ASIDE:
            return self._add(pixels, light)
        sizes = _larger_power_of_two(width), _larger_power_of_two(height)
        self._masked.append(bool((pixels[..., 3] < 255).any()))
        # Pillow takes a tenth of the time for the first level, which is the largest
        whole = np.asarray(Picture.fromarray(pixels).resize(sizes, Picture.Resampling.BILINEAR))
        firsts = [self._keep(_coded(whole, (np.sqrt(light) * 1023 + 0.5).astype(np.uint32)))]
        level = np.empty((4, height, width), np.float32)
        for channel in range(3):
            np.take(light.astype(np.float32), pixels[..., channel], out=level[channel])
        np.multiply(pixels[..., 3], np.float32(1 / 255), out=level[3])
        for step in range(1, max(width, height).bit_length()):
            level = _sampled(level, max(level.shape[1] // 2, 1), max(level.shape[2] // 2, 1))
            across, down = (max(size >> step, 1) for size in sizes)
            firsts.append(self._keep(_packed(_sampled(level, down, across))))
        self._rows.append((*sizes, *firsts))
        self._true_sizes[len(self._rows) - 1] = max(width / sizes[0], height / sizes[1])
        return len(self._rows) - 1

    def has_holes(self, number: int) -> bool:
        """Whether a part of a texture is transparent."""
        return self._masked[number]

    def arrays(self) -> tuple[NDArray[np.int32], NDArray[np.void]]:
        """All texels (N,), and the textures (X,) `TEXTURE`."""
        rows = np.zeros(len(self._rows), TEXTURE)
        for row, (width, height, *firsts) in zip(rows, self._rows, strict=True):
            row["width"], row["height"], row["levels"] = width, height, len(firsts)
            row["first"][: len(firsts)] = firsts
        for number, share in self._true_sizes.items():
            rows["spare"][number] = np.float32(share).view(np.int32)
        return np.concatenate([*self._texels, np.full(1, -1, np.int32)]), rows

    def _add(self, pixels: NDArray[np.uint8], light: NDArray[np.float64] = LINEAR) -> int:
        roots, share = (np.sqrt(light) * 1023 + 0.5).astype(np.uint32), light.astype(np.float32)
        self._masked.append(bool((pixels[..., 3] < 255).any()))
        firsts = [self._keep(_coded(pixels, roots))]
        level = np.empty((4, *pixels.shape[:2]), np.float32)
        for channel in range(3):
            np.take(share, pixels[..., channel], out=level[channel])
        np.multiply(pixels[..., 3], np.float32(1 / 255), out=level[3])
        while level.shape[1:] != (1, 1):
            level = (level[:, 0::2] + level[:, 1::2]) * np.float32(0.5) if level.shape[1] > 1 else level
            level = (level[..., 0::2] + level[..., 1::2]) * np.float32(0.5) if level.shape[2] > 1 else level
            firsts.append(self._keep(_packed(level)))
        self._rows.append((pixels.shape[1], pixels.shape[0], *firsts))
        return len(self._rows) - 1

    def _keep(self, texels: NDArray[np.uint32]) -> int:
        """Append a level of a texture (H, W); returns the index of its first texel."""
        first = self._size
        # the row is one texel longer, so that the kernel reads neighbours together
        texels = np.concatenate([texels, texels[:, :1]], axis=1)
        self._texels.append(texels.view(np.int32).ravel())
        self._size += texels.size
        return first


# Texels are square roots of linear light, 10 bits each, and 2 bits of alpha: precise in the dark, fast to decode.


def _coded(pixels: NDArray[np.uint8], roots: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """The texels of an image."""
    r, g, b = (roots[pixels[..., channel]] for channel in range(3))
    return _joined(r, g, b, _ALPHAS[pixels[..., 3]])


def _packed(level: NDArray[np.float32]) -> NDArray[np.uint32]:
    """The texels of linear light and opacity (4, H, W)."""
    r, g, b = ((np.sqrt(channel) * np.float32(1023) + np.float32(0.5)).astype(np.uint32) for channel in level[:3])
    return _joined(r, g, b, (level[3] * 3 + np.float32(0.5)).astype(np.uint32) << np.uint32(30))


def _joined(
    r: NDArray[np.uint32], g: NDArray[np.uint32], b: NDArray[np.uint32], alpha: NDArray[np.uint32]
) -> NDArray[np.uint32]:
    return np.asarray(r | g << np.uint32(10) | b << np.uint32(20) | alpha, np.uint32)


def _pixels(image: Image) -> NDArray[np.uint8]:
    """(H, W, 4) RGBA, bottom row first, sizes powers of two; a chequered pattern for unreadable images."""
    try:
        with open_picture(image.data) as picture:
            size = (_power_of_two(picture.width), _power_of_two(picture.height))
            pixels = picture.convert("RGBA").resize(size, Picture.Resampling.BICUBIC)
            return np.asarray(pixels, dtype=np.uint8)[::-1].copy()
    except Exception as error:  # Pillow's readers raise many kinds of errors for damaged files
        logger.warning(
            "the picture '%s' cannot be read (%s): cameras see a chequered pattern instead", image.name, error
        )
        return _checkered()


def _power_of_two(size: int) -> int:
    return int(min(1 << max(0, round(math.log2(max(size, 1)))), _MOST_ASIDE))


def _larger_power_of_two(size: int) -> int:
    """The size of a texture that is enlarged; see `TextureStore.add`."""
    return int(min((2 if size <= _MOST_ASIDE // 4 else 1) << (size - 1).bit_length(), _MOST_ASIDE))


def _sampled(level: NDArray[np.float32], height: int, width: int) -> NDArray[np.float32]:
    """A level (4, H, W) of another size, sampled with bilinear weights, repeated at its borders."""
    for axis, size in ((1, height), (2, width)):
        old = level.shape[axis]
        if old == size:
            continue
        at = (np.arange(size) + 0.5) * (old / size) - 0.5
        first = np.floor(at)
        share = (at - first).astype(np.float32).reshape((-1, 1) if axis == 1 else (-1,))
        index = first.astype(np.intp)
        one, other = np.take(level, index % old, axis=axis), np.take(level, (index + 1) % old, axis=axis)
        level = one + (other - one) * share
    return level


def _checkered() -> NDArray[np.uint8]:
    y, x = np.mgrid[0:16, 0:16] // 4
    pixels = np.full((16, 16, 4), 255, np.uint8)
    pixels[(x + y) % 2 == 1] = (255, 0, 255, 255)
    return pixels


# Conversion between sRGB values and linear light.

#: (256,) float32, the light of each code, 0 to 1
LIGHT = LINEAR.astype(np.float32)
_STEPS = np.float32(len(ENCODED) - 1)


def encoded(light: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Convert linear light to sRGB values; light is clipped to 0..1."""
    steps = np.clip(light, np.float32(0), np.float32(1)) * _STEPS + np.float32(0.5)
    return np.asarray(ENCODED[steps.astype(np.intp)], np.uint8)
