"""The live view in a notebook."""

from __future__ import annotations

import os
import secrets
import sys
from dataclasses import dataclass
from html import escape
from urllib.parse import urlsplit

#: variables of servers that show ports of this machine under addresses of their own
_HUB = "JUPYTERHUB_SERVICE_PREFIX"
_CODE = "VSCODE_PROXY_URI"
_COLAB = "google.colab"


@dataclass(frozen=True, slots=True)
class Frame:
    """A page in a frame; notebooks display it as the value of a cell.

    Attributes:
        url: address of the page.
        height: pixels.
        note: what to do if the frame stays empty, as a sentence; empty if that is not to be expected.
    """

    url: str
    height: int
    note: str = ""

    def _repr_html_(self) -> str:
        """HTML, for IPython."""
        note = f"<small>{escape(self.note)}</small>" if self.note else ""
        return (
            f'<iframe src="{escape(self.url)}" title="MORSE" width="100%" height="{self.height}" '
            f'style="border: 0; border-radius: 8px" allow="fullscreen; gamepad; clipboard-write"></iframe>{note}'
        )


def frame(url: str, height: int = 480) -> Frame:
    """The live view at an address, for a notebook whose kernel runs on the same machine as the simulation.

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
    address, note = _seen_by_browser(url)
    return Frame(address, int(height), note)


def proxy_token() -> str | None:
    """A token for the live view if browsers reach it through a proxy, which gives it another host; None otherwise."""
    return secrets.token_urlsafe(16) if os.environ.get(_HUB) or os.environ.get(_CODE) else None


def _seen_by_browser(url: str) -> tuple[str, str]:
    """The address by which the browser of the notebook reaches a port of this machine, and a note."""
    parts = urlsplit(url)
    port, query = parts.port or 80, f"?{parts.query}" if parts.query else ""
    if prefix := os.environ.get(_HUB):
        note = (
            "If the frame stays empty, the server of the notebook has no proxy for ports: install jupyter-server-proxy "
            "where JupyterLab runs, and restart it."
        )
        return f"{prefix.rstrip('/')}/proxy/{port}/{query}", note
    if template := os.environ.get(_CODE):
        address = template.replace("{{port}}", str(port)).replace("{port}", str(port))
        return f"{address.rstrip('/')}/{query}", f"If the frame stays empty, open {address} in a tab."
    if _COLAB in sys.modules:
        return url, (
            "Colab does not show ports of its machine in frames: call google.colab.output.serve_kernel_port_as_window("
            f"{port}), or record the run and show the page of morse export --html."
        )
    if os.environ.get("VSCODE_PID") or os.environ.get("TERM_PROGRAM") == "vscode":
        return url, (
            f"If the frame stays empty, open {url} in a browser; if the kernel is on another machine, forward port "
            f"{port} first (view Ports)."
        )
    return url, ""
