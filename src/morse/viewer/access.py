"""Which browsers may open the live view.

Any web page the user visits can make the browser connect to ``localhost``, and a name that first pointed elsewhere can
be made to point there (DNS rebinding). So the host that the browser believes it talks to must be this machine, and
a request across pages must have this page as its origin. Browsers on other machines need a token.
"""

from __future__ import annotations

import ipaddress
import secrets
from http.cookies import CookieError, SimpleCookie
from typing import TYPE_CHECKING
from urllib.parse import parse_qs, quote, unquote, urlsplit

if TYPE_CHECKING:
    from collections.abc import Mapping


def is_loopback(host: str) -> bool:
    """True for ``localhost`` and the loopback addresses."""
    if host.rstrip(".").lower() == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def _host_of(authority: str) -> str | None:
    try:
        return urlsplit("//" + authority).hostname
    except ValueError:
        return None


class Access:
    """The rules for one server.

    Attributes:
        token: what has to be shown, or None if being on this machine is enough.
    """

    def __init__(self, host: str, token: str | None) -> None:
        # an address that others can reach is never left open
        self.token = token or (None if is_loopback(host) else secrets.token_urlsafe(16))

    def refusal(self, path: str, headers: Mapping[str, str], *, secret: bool, cookie: str) -> str | None:
        """Why a request is refused, or None.

        Args:
            path: with the query.
            headers: of the request.
            secret: whether it asks for something that the token protects.
            cookie: the name of the cookie that may hold the token.
        """
        authority = headers.get("Host", "")
        host = _host_of(authority)
        if host is None or (self.token is None and not is_loopback(host)):
            return (
                f"The live view answers on localhost only, not as '{authority}'. "
                "To reach it from another machine, start with --view-token and --host, or use an ssh tunnel."
            )
        origin = headers.get("Origin")
        if origin is not None and origin.lower().partition("://")[2] != authority.lower():
            return f"Pages of {origin} may not use the live view of '{authority}'."
        if secret and self.token is not None and not self._shown(path, headers, cookie):
            return "This live view wants the token that 'morse run' printed: open the address with ?token=..."
        return None

    def cookie(self, path: str, name: str) -> dict[str, str]:
        """Headers that let the browser keep the token that it has shown in the address."""
        if self.token is None or "token" not in parse_qs(urlsplit(path).query):
            return {}
        return {"Set-Cookie": f"{name}={quote(self.token, safe='')}; HttpOnly; SameSite=Strict; Path=/"}

    def _shown(self, path: str, headers: Mapping[str, str], name: str) -> bool:
        assert self.token is not None
        given = parse_qs(urlsplit(path).query).get("token", [])
        try:
            morsel = SimpleCookie(headers.get("Cookie", "")).get(name)
        except CookieError:
            morsel = None
        given += [unquote(morsel.value)] if morsel is not None else []
        return any(secrets.compare_digest(value.encode(), self.token.encode()) for value in given)
