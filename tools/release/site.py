"""Adds the documentation of this version to a site that has a folder for each version.

``python -m tools site FOLDER``: the pages are in ``FOLDER/2.0.0``; ``versions.json`` lists the versions, the newest
first, for the selection in the sidebar; the first page leads to the newest; ``404.html`` is for wrong addresses.
"""

from __future__ import annotations

import json
import re
import shutil
import sys
import tempfile
from typing import TYPE_CHECKING

from morse.version import __version__
from tools.release import steps
from tools.release.wheels import ROOT

if TYPE_CHECKING:
    from pathlib import Path

_FIRST = """<!DOCTYPE html><html lang="en"><meta charset="utf-8" /><title>MORSE</title>
<meta http-equiv="refresh" content="0; url={0}/" /><a href="{0}/">MORSE {0}</a></html>
"""


def main(site: Path) -> int:
    """Build and list; the result is the status of the process."""
    pages = site / __version__
    shutil.rmtree(pages, ignore_errors=True)
    with tempfile.TemporaryDirectory() as trees:
        options = ["-q", "-W", "-A", "site=1", "-d", trees]
        command = [sys.executable, "-m", "sphinx", *options, str(ROOT / "docs"), str(pages)]
        if steps.run("docs", command, ROOT) is None:
            return 1
    update(site)
    return 0


def update(site: Path) -> None:
    """Write what concerns all versions in the folder."""
    versions = [page.parent.name for page in site.glob("*/index.html") if page.parent.name[0].isdigit()]
    versions.sort(key=_order, reverse=True)
    (site / "versions.json").write_text(json.dumps(versions), encoding="utf-8")
    (site / "index.html").write_text(_FIRST.format(versions[0]), encoding="utf-8")
    shutil.copyfile(ROOT / "docs/_site/404.html", site / "404.html")


def _order(version: str) -> tuple[list[int], bool]:
    """The key for sorting: numbers, then finished versions after their forms for developers."""
    return [int(part) for part in re.findall(r"\d+", version)[:3]], ".dev" not in version
