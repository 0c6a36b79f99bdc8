"""The files of the page and of its world, over HTTP."""

from __future__ import annotations

import gzip
import hashlib
import mimetypes
from functools import cached_property
from http import HTTPStatus
from pathlib import Path
from typing import TYPE_CHECKING

from websockets.datastructures import Headers

from morse.core.clients.web_connection import FileResponse

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from websockets.http11 import Response

STATIC = Path(__file__).parent / "static"

_POLICY = (
    "default-src 'self'; img-src 'self' blob: data:; style-src 'self' 'unsafe-inline'; worker-src 'self' blob:; "
    "object-src 'none'; base-uri 'none'; form-action 'none'; "
    # a notebook on this machine may show the page
    "frame-ancestors 'self' http://localhost:* http://127.0.0.1:*"
)
_SECURITY = {
    "Content-Security-Policy": _POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
}
_NOT_BUILT = """<!doctype html><meta charset="utf-8"><title>MORSE</title>
<p>The live view is not part of this installation: it was built without it.
<p>Build it with <code>pip install .</code> in MORSE's sources, on a machine with access to the npm registry.
"""
_COMPRESSIBLE = ("text/", "application/javascript", "application/json", "application/octet-stream", "image/svg")
_COMPRESS_FROM = 2048


class File:
    """A file for HTTP requests.

    Attributes:
        lasting: the content at this address never changes.
    """

    def __init__(self, mime: str, data: bytes, *, lasting: bool) -> None:
        self.mime = mime
        self.data = data
        self.lasting = lasting

    @cached_property
    def tag(self) -> str:
        """A hash of the content."""
        return f'"{hashlib.sha256(self.data).hexdigest()[:24]}"'

    @cached_property
    def compressed(self) -> bytes | None:
        """The content, compressed by gzip if it saves space."""
        if not self.mime.startswith(_COMPRESSIBLE) or len(self.data) < _COMPRESS_FROM:
            return None
        return gzip.compress(self.data, compresslevel=4, mtime=0)


class Site:
    """All files of one server.

    Attributes:
        files: by path.

    Args:
        folder: folder with the files of the page.
        origins: origins of other pages that may fetch the files, and show the page in a frame.
    """

    def __init__(self, folder: Path = STATIC, origins: Collection[str] = ()) -> None:
        self.files: dict[str, File] = {}
        self._origins = frozenset(origins)
        self._policy = " ".join([_POLICY, *sorted(origins)])
        for path in sorted(folder.rglob("*")) if folder.is_dir() else ():
            name = path.relative_to(folder).as_posix()
            if path.is_file() and not name.startswith("."):
                mime = mimetypes.guess_type(name)[0] or "application/octet-stream"
                self.files[f"/{name}"] = File(mime, path.read_bytes(), lasting=name.startswith("assets/"))
        index = self.files.get("/index.html")
        self.files["/"] = index or File("text/html", _NOT_BUILT.encode(), lasting=False)
        self._public = {path for path in self.files if path.startswith("/assets/")}

    def is_secret(self, path: str) -> bool:
        """Whether a token is needed for a path (without query)."""
        return path not in self._public

    def respond(self, path: str, headers: Mapping[str, str], extra: Mapping[str, str]) -> Response:
        """The response to a request for a path (without query)."""
        file = self.files.get(path)
        if file is None:
            return refuse(HTTPStatus.NOT_FOUND, f"There is no {path} here.")
        caching = "private, max-age=31536000, immutable" if file.lasting else "no-cache"
        fields = {"ETag": file.tag, "Cache-Control": caching, "Vary": "Accept-Encoding, Origin", **extra}
        fields["Content-Security-Policy"] = self._policy
        origin = headers.get("Origin", "").lower()
        if origin in self._origins:
            fields["Access-Control-Allow-Origin"] = origin
        if headers.get("If-None-Match") == file.tag:
            return _response(HTTPStatus.NOT_MODIFIED, b"", fields)
        data = file.data
        if "gzip" in headers.get("Accept-Encoding", "") and file.compressed is not None:
            data = file.compressed
            fields["Content-Encoding"] = "gzip"
        charset = "; charset=utf-8" if file.mime.startswith("text/") else ""
        return _response(HTTPStatus.OK, data, {"Content-Type": file.mime + charset, **fields})


def refuse(status: HTTPStatus, why: str) -> Response:
    """An error response with a reason."""
    return _response(status, f"{why}\n".encode(), {"Content-Type": "text/plain; charset=utf-8"})


def _response(status: HTTPStatus, body: bytes, fields: Mapping[str, str]) -> Response:
    headers = Headers({"Content-Length": str(len(body)), "Connection": "close", **_SECURITY, **fields})
    return FileResponse(status.value, status.phrase, headers, body)
