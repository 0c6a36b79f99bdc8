"""The pages of the documentation, and their contents."""

import re
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", ROOT / "CONTRIBUTING.md", *sorted(DOCS.glob("*.md"))]
PICTURES = DOCS / "pictures"

_BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")
_HEADING = re.compile(r"^#+ (.+)$", re.MULTILINE)


class Block(NamedTuple):
    """A block of code."""

    page: Path
    language: str
    text: str

    @property
    def is_scene(self) -> bool:
        """Whether it is a scene script."""
        return self.text.startswith("from morse.builder import *") and "\nenv = Environment(" in self.text

    @property
    def is_client(self) -> bool:
        """Whether it is a client program without interactive input."""
        return self.text.startswith("from pymorse import Morse") and "input(" not in self.text


class Link(NamedTuple):
    """A link or a picture."""

    page: Path
    picture: bool
    text: str
    target: str


def blocks(language: str) -> list[Block]:
    """All blocks of code in a language."""
    return [
        Block(page, found, text)
        for page in PAGES
        for found, text in _BLOCK.findall(page.read_text(encoding="utf-8"))
        if found == language
    ]


def links() -> list[Link]:
    """All links and pictures to files of the project."""
    return [
        Link(page, mark == "!", text, target)
        for page in PAGES
        for mark, text, target in _LINK.findall(_BLOCK.sub("", page.read_text(encoding="utf-8")))
        if "://" not in target
    ]


def anchors(page: Path) -> set[str]:
    """The anchors of a page."""
    headings = _HEADING.findall(_BLOCK.sub("", page.read_text(encoding="utf-8")))
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


def named(items: list[Block]) -> list[object]:
    """Blocks as parameters of a test, named after their page."""
    import pytest

    return [pytest.param(item, id=f"{item.page.stem}-{i}") for i, item in enumerate(items)]
