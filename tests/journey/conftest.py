"""A person, a browser and a terminal for the tutorial."""

from __future__ import annotations

import pytest
from playwright.sync_api import sync_playwright
from steps import Person

CHROMIUM = "/usr/bin/chromium"
_ARGUMENTS = [
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]


@pytest.fixture(scope="module")
def person(tmp_path_factory):
    made = Person(tmp_path_factory.mktemp("journey"))
    yield made
    made.leaves()


@pytest.fixture(scope="module")
def browser():
    with sync_playwright() as playwright:
        made = playwright.chromium.launch(executable_path=CHROMIUM, args=_ARGUMENTS)
        yield made
        made.close()


@pytest.fixture
def page(browser):
    made = browser.new_page(viewport={"width": 900, "height": 600})
    yield made
    made.close()
