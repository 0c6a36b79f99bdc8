"""A user, a browser and a terminal for the tutorial."""

import pytest
from steps import Person


@pytest.fixture(scope="module")
def person(tmp_path_factory):
    made = Person(tmp_path_factory.mktemp("journey"))
    yield made
    made.leaves()


@pytest.fixture
def page(browser):
    made = browser.new_page(viewport={"width": 900, "height": 600})
    yield made
    made.close()
