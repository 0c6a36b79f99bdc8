"""The live view in a notebook."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape


@dataclass(frozen=True, slots=True)
class Frame:
    """A page in a frame; notebooks display it as the value of a cell.

    Attributes:
        url: address of the page.
        height: pixels.
    """

    url: str
    height: int

    def _repr_html_(self) -> str:
        """HTML, for IPython."""
        return (
            f'<iframe src="{escape(self.url)}" title="MORSE" width="100%" height="{self.height}" '
            'style="border: 0; border-radius: 8px" allow="fullscreen; gamepad; clipboard-write"></iframe>'
        )


def frame(url: str, height: int = 480) -> Frame:
    """The live view at an address, for a notebook on the same machine.

    Args:
        url: `morse.viewer.live_view.View.url`.
        height: pixels, from 100 to 4000.

    Raises:
        ValueError: the address is not an HTTP address, or the height is out of range.
    """
    if not url.startswith(("http://", "https://")):
        raise ValueError(f"expected the address of a live view, such as http://127.0.0.1:8765/, not {url!r}")
    if not 100 <= height <= 4000:
        raise ValueError(f"the height of a frame is 100 to 4000 pixels, not {height!r}")
    return Frame(url, int(height))
