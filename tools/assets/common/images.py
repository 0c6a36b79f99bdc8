"""Images computed with numpy and packed into the .blend file."""

from __future__ import annotations

import tempfile
from pathlib import Path

import bpy
import numpy as np

QUALITY = 85


def packed(name: str, pixels: np.ndarray) -> bpy.types.Image:
    """A packed image from (H, W, 3) sRGB values 0..1, row 0 at the top; ``name`` ends in .png or .jpg."""
    height, width, _ = pixels.shape
    rgba = np.ones((height, width, 4), dtype=np.float32)
    rgba[..., :3] = np.clip(pixels[::-1], 0.0, 1.0)
    image = bpy.data.images.new(name, width, height)
    image.pixels.foreach_set(rgba.ravel())
    image.file_format = "JPEG" if name.endswith(".jpg") else "PNG"
    with tempfile.TemporaryDirectory() as folder:
        image.filepath_raw = str(Path(folder) / name)
        image.save(quality=QUALITY)
        image.source = "FILE"
        image.reload()
        image.pack()
    # the file must not contain paths of the machine that made it
    for path in ("/" * 1023, f"//textures/{name}"):  # a short path alone would leave the rest of the old path in memory
        image.filepath_raw = image.packed_files[0].filepath = path
    return image
