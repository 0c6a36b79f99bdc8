"""Which browsers may use a server of the simulation: the live view, or a middleware.

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
    from collections.abc import Mapping, Sequence


#: characters of the names and addresses of hosts
_OF_HOSTS = frozenset("abcdefghijklmnopqrstuvwxyz0123456789.-_:")


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


def checked_origin(text: str) -> str:
    """An origin as browsers send it: scheme, host and port in lower case, without a path.

    Raises:
        ValueError: the text is not the origin of a web page.
    """
    given = text.strip().lower().rstrip("/")
    expected = f"expected the origin of a page, such as 'http://localhost:8080', got {text!r:.80}"
    try:
        parts = urlsplit(given)
        port = parts.port
    except ValueError:
        raise ValueError(expected) from None
    if parts.scheme not in ("http", "https") or not parts.hostname:
        raise ValueError(expected)
    # brackets and colons of an address of IPv6 are allowed; what separates words of a header is not
    if not set(parts.hostname) <= _OF_HOSTS or parts.username is not None:
        raise ValueError(f"{expected}; a pattern such as '*' is not possible: list each origin")
    host = f"[{parts.hostname}]" if ":" in parts.hostname else parts.hostname
    origin = f"{parts.scheme}://{host}" + (f":{port}" if port is not None else "")
    if origin != given:
        raise ValueError(f"{expected}; did you mean {origin!r}?")
    return origin


class Access:
    """The rules for one server.

    Args:
        host: address to which the server is bound.
        token: what has to be shown; one is made up if other machines can reach ``host``.
        name: how messages call the server.
        elsewhere: what to do to reach the server from another machine.
        origins: other pages that may use the server, such as ``http://localhost:8080``.

    Attributes:
        token: what has to be shown, or None if being on this machine is enough.
        origins: in lower case.
    """

    def __init__(
        self,
        host: str,
        token: str | None,
        *,
        name: str = "live view",
        elsewhere: str = "start with --view-token and --host",
        origins: Sequence[str] = (),
    ) -> None:
        self._name, self._elsewhere = name, elsewhere
        self.origins = frozenset(origin.lower().rstrip("/") for origin in origins)
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
                f"The {self._name} answers on localhost only, not as '{authority}'. "
                f"To reach it from another machine, {self._elsewhere}, or use an ssh tunnel."
            )
        origin = headers.get("Origin")
        own = origin is None or origin.lower().partition("://")[2] == authority.lower()
        if not own and str(origin).lower() not in self.origins:
            return f"Pages of {origin} may not use the {self._name} of '{authority}'."
        if secret and self.token is not None and not self._shown(path, headers, cookie):
            return f"This {self._name} wants the token that 'morse run' printed: open the address with ?token=..."
        return None

    def cookie(self, path: str, name: str) -> dict[str, str]:
        """Headers with which the browser stores the token of the address."""
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
