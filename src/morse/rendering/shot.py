"""Images that are complete, or will be."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from morse.rendering.picture import Picture


class Shot(Protocol):
    """An image that is complete, or will be."""

    def picture(self) -> Picture:
        """Return the image, and wait until it is complete; raise the error that has ended its rendering."""


class Finished:
    """An image that is complete."""

    def __init__(self, picture: Picture) -> None:
        self._picture = picture

    def picture(self) -> Picture:
        """Return the image."""
        return self._picture
