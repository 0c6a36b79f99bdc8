"""The page of the live view with a tape in it, as one file."""

from __future__ import annotations

import base64
import html
import re
from typing import TYPE_CHECKING

from morse.viewer.site import STATIC

if TYPE_CHECKING:
    from pathlib import Path

#: the browser loads nothing from elsewhere
_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
    "connect-src data: blob:; base-uri 'none'; form-action 'none'"
)
_SCRIPT = re.compile(r'<script type="module"[^>]* src="\./([^"]+)"></script>')
_STYLE = re.compile(r'<link rel="stylesheet"[^>]* href="\./([^"]+)">')
_ICON = re.compile(r'<link rel="icon"[^>]* href="\./([^"]+)"[^>]*>')


def page_of(tape: bytes, title: str, folder: Path = STATIC) -> str:
    """The text of a page that plays a tape.

    Args:
        tape: see `morse.viewer.page_export.page_recording.Tape.to_bytes`.
        title: of the page.
        folder: the files of the page.

    Raises:
        FileNotFoundError: MORSE was installed without the page.
    """
    index = folder / "index.html"
    if not index.is_file():
        raise FileNotFoundError(f"{index}: MORSE was built without the page of the live view")
    text = index.read_text(encoding="utf-8")

    def content(name: str) -> str:
        return (folder / name).read_text(encoding="utf-8")

    licences = content("assets/licences.txt").replace("--", "- -")
    icon = _ICON.search(text)
    image = base64.b64encode((folder / icon[1]).read_bytes()).decode() if icon else ""
    data = f'<script id="tape" type="application/octet-stream">{base64.b64encode(tape).decode()}</script>'
    text = text.replace("<title>MORSE</title>", f"<title>{html.escape(title)}</title>")
    text = _ICON.sub(f'<link rel="icon" type="image/svg+xml" href="data:image/svg+xml;base64,{image}">', text)
    text = _STYLE.sub(lambda match: f"<style>{content(match[1])}</style>", text)
    text = _SCRIPT.sub(lambda match: f'{data}<script type="module">{_inline(content(match[1]))}</script>', text)
    policy = f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}" />'
    return text.replace("<head>", f"<head>\n    <!-- made by MORSE; it contains:\n{licences}-->\n    {policy}", 1)


def _inline(script: str) -> str:
    """A script ends at the first ``</script``, also within a string."""
    return script.replace("</script", "<\\/script")
