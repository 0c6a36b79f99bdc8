"""The site of the documentation has a folder for each version, their selection, and a page for wrong addresses."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from doc_pages import DOCS

from tools.release import site

jinja2 = pytest.importorskip("jinja2")

if TYPE_CHECKING:
    from playwright.sync_api import Browser

_VERSIONS = ["2.1.0", "2.1.0.dev0", "2.0.10", "2.0.9"]
#: what the theme puts around the sidebar
_PAGE = """<!DOCTYPE html><html lang="en" data-content_root="./"><title>{1}</title><p id="page">{0} {1}</p>{2}</html>"""


class _Pages(SimpleHTTPRequestHandler):
    """Shows the page for wrong addresses as forges do."""

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        page = (site.ROOT / "docs/_site/404.html").read_bytes()
        self.send_response(code)
        self.end_headers()
        if self.command == "GET":
            self.wfile.write(page)

    def log_message(self, format: str, *args: object) -> None:
        """Print nothing."""


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    """A site in a folder of its server; the oldest version lacks a page."""
    template = jinja2.Template((DOCS / "_templates/sidebar/versions.html").read_text(encoding="utf-8"))
    for version in _VERSIONS:
        folder = tmp_path / "morse" / version
        folder.mkdir(parents=True)
        for name in ("index", "sweeps"):
            if (version, name) != ("2.0.9", "sweeps"):
                sidebar = template.render(site=True, release=version, pagename=name, file_suffix=".html")
                (folder / f"{name}.html").write_text(_PAGE.format(version, name, sidebar), encoding="utf-8")
    site.update(tmp_path / "morse")
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Pages, directory=str(tmp_path)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_address[1]}/morse/"
    server.shutdown()
    server.server_close()


def test_versions_are_listed_newest_first(address: str, tmp_path: Path):
    folder = tmp_path / "morse"
    assert json.loads((folder / "versions.json").read_text(encoding="utf-8")) == _VERSIONS
    assert "url=2.1.0/" in (folder / "index.html").read_text(encoding="utf-8")


@pytest.mark.browser
def test_another_version_is_selected(address: str, browser: Browser):
    page = browser.new_page()
    try:
        page.goto(address + "2.1.0/sweeps.html")
        select = page.get_by_label("Version", exact=False)
        select.locator("option:checked", has_text="2.1.0").wait_for(state="attached")  # the list is loaded later
        assert select.input_value() == "2.1.0"
        select.select_option("2.0.10")
        page.wait_for_url("**/2.0.10/sweeps.html")
        page.get_by_label("Version", exact=False).select_option("2.0.9")
        page.wait_for_url("**/2.0.9/")  # which has no such page
        assert page.locator("#page").inner_text() == "2.0.9 index"
    finally:
        page.close()


@pytest.mark.browser
def test_a_wrong_address_leads_to_the_newest_version(address: str, browser: Browser):
    page = browser.new_page()
    try:
        page.goto(address + "1.4/user/moving-robots.html")
        start = page.locator("#start[href$='/2.1.0/']")
        start.wait_for()
        assert (page.get_attribute("#search", "href") or "").endswith("/2.1.0/search.html?q=moving%20robots")
        start.click()
        assert page.locator("#page").inner_text() == "2.1.0 index"
    finally:
        page.close()
