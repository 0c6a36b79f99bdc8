"""A Sphinx extension that generates the component library from the declarations of the components.

The pages are in ``docs/library/``, so that they can be read without building the documentation. They are written by
``python -m tools library`` and whenever the documentation is built, and are not edited by hand.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from component_library import (
    component_pages,
    coverage_page,
    index_page,
    kind_page,
    middleware_page,
    model_pages,
    modifier_page,
    pictures,
    robot_pages,
    service_pages,
    world_page,
)

if TYPE_CHECKING:
    from sphinx.application import Sphinx

FOLDER = "library"


def page_names() -> list[str]:
    """The names of all pages, below the folder of the library."""
    names = [f"robots/{name.lower()}" for name in robot_pages.robot_classes()]
    for kind in ("sensors", "actuators"):
        names += [f"{kind}/{name.lower()}" for name in component_pages.builder_classes(kind)]
    others = ["modifiers", "models", "message-kinds", "middlewares", "services", "world", "coverage"]
    return ["index", *(f"{kind}/index" for kind in index_page.KINDS), *names, *others]


def write(folder: Path) -> list[Path]:
    """Write the pages that have changed into a folder, delete all others there, and return the paths of all."""
    pages = {
        **index_page.pages(),
        **robot_pages.pages(),
        **component_pages.pages("sensors"),
        **component_pages.pages("actuators"),
        **modifier_page.pages(),
        **model_pages.pages(),
        **kind_page.pages(),
        **middleware_page.pages(),
        **service_pages.pages(),
        **world_page.pages(),
        **coverage_page.pages(),
    }
    paths = {folder / f"{name}.md": text for name, text in pages.items()}
    for path in set(folder.rglob("*.md")) - set(paths):
        path.unlink()
    for path, text in paths.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8", newline="\n")
    return list(paths)


def without_picture() -> list[str]:
    """The components and visible robots for which no picture has been taken yet."""
    names = (name.rpartition("/") for name in page_names())
    others = {"index", *robot_pages.bodiless()}
    return [
        name for kind, _, name in names if kind in index_page.KINDS and name not in others and not pictures.of(name)
    ]


def _build(app: Sphinx) -> None:
    write(Path(app.srcdir) / FOLDER)
    if missing := without_picture():
        from sphinx.util import logging  # the library is also written where Sphinx is not installed

        logging.getLogger(__name__).info(f"no picture of {', '.join(missing)}: `python -m tools` takes one")


def setup(app: Sphinx) -> dict[str, Any]:
    """Register with Sphinx."""
    app.connect("builder-inited", _build)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
