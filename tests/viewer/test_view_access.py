"""Access to the live view."""

import pytest
from view_pages import Client, fetch
from websockets.exceptions import InvalidStatus

from morse.core.clients.web_access import Access, checked_origin


def refused(status: InvalidStatus) -> str:
    assert status.response.status_code == 403
    return status.response.body.decode()


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "https://127.0.0.1.evil.example", "http://localhost:1"]
)
def test_pages_of_others_are_refused(served, origin) -> None:
    _, url = served
    with pytest.raises(InvalidStatus) as error:
        Client(url, origin=origin)
    assert "may not use the live view" in refused(error.value)
    assert fetch(url, {"Origin": origin})[0] == 403


def test_own_pages_and_programs_are_welcome(served) -> None:
    _, url = served
    with Client(url, origin=url.rstrip("/")) as page:
        assert page.expect("welcome")["page"] == 1
    with Client(url) as program:
        program.expect("welcome")


def test_a_name_that_was_made_to_point_here_is_refused(served) -> None:
    _, url = served
    status, _, body = fetch(url, {"Host": "evil.example"})
    assert status == 403
    assert b"localhost only" in body
    assert fetch(url, {"Host": "localhost:9999"})[0] == 200  # a tunnel may end at any port


def test_token(make_server) -> None:
    _, url = make_server(token="käse+wein")
    base, _, query = url.partition("?")
    assert query.startswith("token=")
    for address in (base, base + "?token=wrong", base + "?token="):
        status, _, body = fetch(address)
        assert status == 403
        assert b"requires the token" in body
        with pytest.raises(InvalidStatus) as error:
            Client(base, query=address.partition("?")[2])
        assert "requires the token" in refused(error.value)


def test_token_shown_once_becomes_a_cookie(make_server) -> None:
    _, url = make_server(token="secret")
    status, headers, _ = fetch(url)
    assert status == 200
    assert "HttpOnly" in headers["Set-Cookie"]
    assert "SameSite=Strict" in headers["Set-Cookie"]
    cookie = headers["Set-Cookie"].split(";")[0]
    base = url.partition("?")[0]
    assert fetch(base, {"Cookie": cookie})[0] == 200
    assert fetch(base, {"Cookie": cookie + "x"})[0] == 403
    with Client(base, additional_headers={"Cookie": cookie}) as page:
        page.expect("welcome")


@pytest.mark.parametrize("token", ["a&b#c d", "käse+wein", "100%", 'a;b"c=d/e?', "機"])
def test_the_address_and_the_cookie_hold_any_token(make_server, token) -> None:
    _, url = make_server(token=token)
    status, headers, _ = fetch(url)
    assert status == 200
    base, _, query = url.partition("?")
    with Client(base, query=query) as page:
        page.expect("welcome")
    cookie = headers["Set-Cookie"].split(";")[0]
    assert fetch(base, {"Cookie": cookie})[0] == 200


def test_an_address_that_others_reach_is_never_open() -> None:
    assert Access("127.0.0.1", None).token is None
    assert Access("::1", None).token is None
    assert Access("localhost", None).token is None
    made = Access("0.0.0.0", None).token
    assert made is not None
    assert len(made) >= 16
    assert made != Access("0.0.0.0", None).token


@pytest.mark.parametrize("header", ["Host", "Origin", "Cookie"])
@pytest.mark.parametrize("value", ["", "[::1", "a" * 4000, "\x80", "http://[", ";;=;", ":"])
def test_odd_headers_are_refused_not_stumbled_over(header, value) -> None:
    access = Access("127.0.0.1", "token")
    headers = {"Host": "localhost", header: value}
    assert access.refusal("/", headers, secret=True, cookie="c") is not None


def test_security_headers(served) -> None:
    _, url = served
    _, headers, _ = fetch(url)
    assert "default-src 'self'" in headers["Content-Security-Policy"]
    assert "unsafe-eval" not in headers["Content-Security-Policy"]
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert headers["Referrer-Policy"] == "no-referrer"


FRIEND = "https://course.example.org:8443"


def test_named_pages_may_connect_fetch_and_show_the_page(make_server) -> None:
    _, url = make_server(origins=[FRIEND])
    with Client(url, origin=FRIEND) as page:
        page.expect("welcome")
    status, headers, _ = fetch(url, {"Origin": FRIEND})
    assert (status, headers["Access-Control-Allow-Origin"]) == (200, FRIEND)
    ancestors = headers["Content-Security-Policy"].partition("frame-ancestors")[2].split()
    assert FRIEND in ancestors
    for other in ("https://course.example.org", "http://course.example.org:8443", "https://evil.example"):
        assert fetch(url, {"Origin": other})[0] == 403
    assert "Access-Control-Allow-Origin" not in fetch(url)[1]


def test_without_named_pages_nobody_else_shows_the_page(served) -> None:
    _, url = served
    ancestors = fetch(url)[1]["Content-Security-Policy"].partition("frame-ancestors")[2].split()
    assert ancestors == ["'self'", "http://localhost:*", "http://127.0.0.1:*"]


@pytest.mark.parametrize("origin", ["http://localhost:8080", "https://a-b.example", "http://[::1]:9", "HTTP://Host/"])
def test_origins(origin) -> None:
    assert checked_origin(origin) == origin.lower().rstrip("/")


@pytest.mark.parametrize(
    "text",
    [
        "", "*", "localhost", "localhost:8080", "http://", "http://*", "http://*.example", "ftp://example",
        "http://a b", "http://a;script-src", "http://a,b", "http://user@host", "http://host/path", "http://host?q",
        "http://host:99999", "http://[::1", "null", "http://host\nX: y",
    ],
)  # fmt: skip
def test_what_is_no_origin_is_refused(text) -> None:
    with pytest.raises(ValueError, match="expected the origin of a page"):
        checked_origin(text)
