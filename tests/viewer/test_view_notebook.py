"""The page in a frame of a notebook."""

from __future__ import annotations

from html.parser import HTMLParser

import pytest
from view_pages import fetch

from morse.viewer.notebook import frame


def attributes(html: str) -> dict[str, str | None]:
    found: list[tuple[str, dict[str, str | None]]] = []
    parser = HTMLParser()
    parser.handle_starttag = lambda tag, given: found.append((tag, dict(given)))  # type: ignore[method-assign]
    parser.feed(html)
    ((tag, given),) = found
    assert tag == "iframe"
    return given


def test_the_frame_shows_the_address_at_the_height_asked_for() -> None:
    given = attributes(frame("http://127.0.0.1:8765/?token=a%26b&x=1", 300)._repr_html_())
    assert given["src"] == "http://127.0.0.1:8765/?token=a%26b&x=1"
    assert given["height"] == "300"


def test_an_address_cannot_break_out_of_the_frame() -> None:
    url = 'http://x/"><script>alert(1)</script>'
    assert attributes(frame(url)._repr_html_())["src"] == url


@pytest.mark.parametrize(
    ("url", "height"), [("javascript:alert(1)", 300), ("", 300), ("http://x/", 5), ("http://x/", 1e9)]
)
def test_what_is_no_page_is_refused(url: str, height: int) -> None:
    with pytest.raises(ValueError, match=r"expected the address|the height of a frame"):
        frame(url, height)


def test_notebooks_of_this_machine_may_frame_the_page_and_others_may_not(served) -> None:
    _, url = served
    policy = fetch(url)[1]["Content-Security-Policy"]
    (ancestors,) = [rule.strip() for rule in policy.split(";") if "frame-ancestors" in rule]
    assert ancestors.split()[1:] == ["'self'", "http://localhost:*", "http://127.0.0.1:*"]


@pytest.mark.browser
def test_the_page_runs_within_a_frame(running, make_server, open_page) -> None:
    _, url = running
    page = open_page(url)
    page.evaluate("""html => { document.body.innerHTML = html }""", frame(url + "?quality=low", 300)._repr_html_())
    framed = page.frame_locator("iframe")
    framed.locator('[data-name="robot0"]').wait_for(state="attached", timeout=60_000)
    framed.locator("canvas").first.wait_for(timeout=60_000)
