"""The title of a page is the name of the project."""

import pytest

from morse.viewer.live_view import title_of


@pytest.mark.parametrize(
    ("script", "environment", "title"),
    [
        ("/home/me/ranger_sim/default.py", "sandbox", "ranger_sim"),
        ("/data/examples/laser/scene.py", "indoors-1/boxes", "laser"),
        ("/home/me/ranger_sim/race.py", "sandbox", "race"),
        ("race.py", "sandbox", "race"),
        ("", "sandbox", "sandbox"),
        ("", "", "MORSE"),
    ],
)
def test_titles(script: str, environment: str, title: str) -> None:
    assert title_of(script, environment) == title
