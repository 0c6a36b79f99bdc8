"""What is kept of the images of a camera, so that the next ones take less time."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.kernel.drawing.native_kept import NativeKept


class Kept:
    """The last image of a camera, of which the next image takes over all tiles that are the same.

    The images are those of a renderer that keeps nothing.

    Attributes:
        of: the data of the drawer; None before the first image, and without the kernel.
    """

    __slots__ = ("of",)

    def __init__(self) -> None:
        self.of: NativeKept | None = None
