"""Rules about which browsers may use a server of the simulation: the live view, or a middleware.

Any web page that the user visits can make the browser connect to ``localhost``. A host name that first pointed to
another machine can be changed to point to this machine (DNS rebinding). Therefore, the host in a request must be this
machine, and the origin of a request must be this page. Browsers on other machines need a token.
"""

from __future__ import annotations

import ipaddress
import re
import secrets
from http.cookies import CookieError, SimpleCookie
from typing import TYPE_CHECKING
from urllib.parse import parse_qs, quote, unquote, urlsplit

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


#: characters in names and addresses of hosts
_OF_HOSTS = frozenset("abcdefghijklmnopqrstuvwxyz0123456789.-_:")
#: a name, an IPv4 address, or an IPv6 address in brackets; then the port
_AUTHORITY = re.compile(r"(?:\[(?P<address>[0-9A-Fa-f:.]+)\]|(?P<name>[A-Za-z0-9._-]+))(?::(?P<port>[0-9]{0,5}))?")


def is_loopback(host: str) -> bool:
    """True for ``localhost`` and the loopback addresses."""
    if host.removesuffix(".").lower() == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def _host_of(authority: str) -> str | None:
    """The host of a ``Host`` header; None if it is not a name or an address, with or without a port (RFC 9110)."""
    match = _AUTHORITY.fullmatch(authority)
    if match is None or int(match["port"] or 0) > 65535:
        return None
    if match["address"] is None:
        return match["name"]
    try:
        return str(ipaddress.IPv6Address(match["address"]))
    except ValueError:
        return None


def checked_origin(text: str) -> str:
    """An origin as browsers send it: scheme, host and port in lower case, without a path.

    Raises:
        ValueError: the text is not the origin of a web page.
    """
    lower = text.strip().lower().rstrip("/")
    message = f"expected the origin of a page, such as 'http://localhost:8080', got {text!r:.80}"
    try:
        parts = urlsplit(lower)
        port = parts.port
    except ValueError:
        raise ValueError(message) from None
    if parts.scheme not in ("http", "https") or not parts.hostname:
        raise ValueError(message)
    # brackets and colons of an IPv6 address are allowed; separators of words in a header are not
    if not set(parts.hostname) <= _OF_HOSTS or parts.username is not None:
        raise ValueError(f"{message}; a pattern such as '*' is not possible: list each origin")
    host = f"[{parts.hostname}]" if ":" in parts.hostname else parts.hostname
    origin = f"{parts.scheme}://{host}" + (f":{port}" if port is not None else "")
    if origin != lower:
        raise ValueError(f"{message}; did you mean {origin!r}?")
    return origin


class Access:
    """The rules for one server.

    Args:
        host: address to which the server is bound.
        token: the token that browsers have to send; a random one is created if other machines can reach ``host``.
        name: name of the server in messages.
        elsewhere: instruction for access from another machine.
        origins: origins of other pages that may use the server, such as ``http://localhost:8080``.

    Attributes:
        token: the token that browsers have to send, or None if the server is reached only from this machine.
        origins: origins in lower case.
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
        # an address that other machines can reach always needs a token
        self.token = token or (None if is_loopback(host) else secrets.token_urlsafe(16))

    def refusal(self, path: str, headers: Mapping[str, str], *, secret: bool, cookie: str) -> str | None:
        """The reason why a request is refused, or None.

        Args:
            path: path with the query.
            headers: headers of the request.
            secret: whether it requests content that the token protects.
            cookie: name of the cookie that may contain the token.
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
            return f"This {self._name} requires the token that 'morse run' printed: open the address with ?token=..."
        return None

    def cookie(self, path: str, name: str) -> dict[str, str]:
        """Headers with which the browser stores the token of the address."""
        if self.token is None or "token" not in parse_qs(urlsplit(path).query):
            return {}
        return {"Set-Cookie": f"{name}={quote(self.token, safe='')}; HttpOnly; SameSite=Strict; Path=/"}

    def _shown(self, path: str, headers: Mapping[str, str], name: str) -> bool:
        assert self.token is not None
        tokens = parse_qs(urlsplit(path).query).get("token", [])
        try:
            morsel = SimpleCookie(headers.get("Cookie", "")).get(name)
        except CookieError:
            morsel = None
        tokens += [unquote(morsel.value)] if morsel is not None else []
        return any(secrets.compare_digest(value.encode(), self.token.encode()) for value in tokens)
