"""Pictures and films as files."""

from __future__ import annotations

import shutil
import subprocess
from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from pathlib import Path
    from typing import IO

    from numpy.typing import NDArray

#: image formats that Pillow writes
PICTURES = (".png", ".jpg", ".jpeg", ".webp", ".bmp", ".tif", ".tiff")
#: film formats that Pillow writes, and those that need ffmpeg
ANIMATIONS, VIDEOS = (".gif", ".webp"), (".mp4", ".webm", ".mkv")
_QUALITY = 92
#: options of ffmpeg for browsers and papers
_CODECS = {".webm": ("libvpx-vp9", "-crf", "30", "-b:v", "0"), ".mp4": ("libx264", "-crf", "18"), ".mkv": ("ffv1",)}


class Film(Protocol):
    """A film that is being written."""

    def add(self, pixels: NDArray[np.uint8]) -> None:
        """Add a frame (H, W, 3)."""

    def close(self) -> None:
        """Write the remaining frames."""


def check(path: Path, *, film: bool) -> None:
    """Check whether a file of that name can be written, before anything is rendered.

    Raises:
        ValueError: the format is unknown, the folder does not exist, or ffmpeg is missing.
    """
    suffix = path.suffix.lower()
    if not path.parent.is_dir():
        raise ValueError(f"there is no folder {path.parent}")
    suffixes = (*ANIMATIONS, *VIDEOS) if film else PICTURES
    if film and "%" in path.name:
        _frame_name(path, 0)
        suffixes = PICTURES
    if suffix not in suffixes:
        what = "a film" if film else "a picture"
        more = ", or frames such as 'frame_%04d.png'" if film else ""
        raise ValueError(f"{what} is a file that ends in {', '.join(suffixes)}{more}, not {path.name!r}")
    if film and suffix in VIDEOS and shutil.which("ffmpeg") is None:
        raise ValueError(
            f"{path.name} needs ffmpeg, which is not installed (Debian: apt install ffmpeg); "
            f"without it there are {', '.join(ANIMATIONS)} and frames such as 'frame_%04d.png'"
        )


def save_picture(path: Path, pixels: NDArray[np.uint8]) -> None:
    """Write pixels (H, W, 3).

    Raises:
        OSError: the file cannot be written.
    """
    from PIL import Image

    # lossless formats ignore the quality
    Image.fromarray(np.ascontiguousarray(pixels)).save(path, quality=_QUALITY)


def film(path: Path, size: tuple[int, int], rate: float) -> Film:
    """A film of frames of a ``size``, width and height, at a rate."""
    if "%" in path.name:
        return _Frames(path)
    if path.suffix.lower() in VIDEOS:
        return _Video(path, size, rate)
    return _Animation(path, rate)


def _frame_name(path: Path, number: int) -> Path:
    try:
        name = path.name % number
    except (TypeError, ValueError):
        name = path.name
    if name == path.name:
        raise ValueError(f"the names of frames have one number, such as 'frame_%04d.png', not {path.name!r}")
    return path.with_name(name)


class _Frames:
    def __init__(self, path: Path) -> None:
        self._path, self._count = path, 0

    def add(self, pixels: NDArray[np.uint8]) -> None:
        save_picture(_frame_name(self._path, self._count), pixels)
        self._count += 1

    def close(self) -> None:
        """Nothing is left to write."""


class _Animation:
    """Frames are kept in memory, because Pillow writes all of them at once."""

    def __init__(self, path: Path, rate: float) -> None:
        self._path, self._rate = path, rate
        self._frames: list[NDArray[np.uint8]] = []

    def add(self, pixels: NDArray[np.uint8]) -> None:
        self._frames.append(pixels.copy())

    def close(self) -> None:
        from PIL import Image

        if not self._frames:
            return
        first, *rest = (Image.fromarray(frame) for frame in self._frames)
        first.save(self._path, save_all=True, append_images=rest, duration=round(1000 / self._rate), loop=0)


class _Video:
    def __init__(self, path: Path, size: tuple[int, int], rate: float) -> None:
        codec, *options = _CODECS[path.suffix.lower()]
        shape = f"{size[0]}x{size[1]}"
        source = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", shape, "-r", f"{rate:g}", "-i", "-"]
        # common players need even sizes and this format
        form = [] if codec == "ffv1" else ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"]
        command = ["ffmpeg", "-v", "error", "-y", *source, "-c:v", codec, *options, *form, str(path)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE)

    def add(self, pixels: NDArray[np.uint8]) -> None:
        pipe: IO[bytes] | None = self._process.stdin
        assert pipe is not None
        try:
            pipe.write(np.ascontiguousarray(pixels).tobytes())
        except BrokenPipeError:
            self.close()

    def close(self) -> None:
        """Wait for ffmpeg.

        Raises:
            OSError: the film could not be written.
        """
        _, errors = self._process.communicate()
        if self._process.returncode:
            raise OSError(f"ffmpeg: {errors.decode(errors='replace').strip()[-400:]}")
