"""Folders of models of Gazebo, with ``model.config``."""

from __future__ import annotations

import os
import re
from pathlib import PurePath
from typing import TYPE_CHECKING

from morse.assets.xml_files import read_xml

if TYPE_CHECKING:
    from pathlib import Path
    from xml.etree.ElementTree import Element

CONFIG = "model.config"


def model_file(folder: Path) -> Path | None:
    """The SDF file of a model: the newest one that its ``model.config`` names, or ``model.sdf``; None without any.

    A name that leads out of the folder is left out.
    """
    config = folder / CONFIG
    elements = read_xml(config).iter("sdf") if config.is_file() else ()
    names = [(version_of(element), (element.text or "").strip()) for element in elements]
    for _, name in sorted(names, reverse=True):
        if name and "\0" not in name and _is_below(name) and (folder / name).is_file():
            return folder / name
    usual = folder / "model.sdf"
    return usual if usual.is_file() else None


def _is_below(name: str) -> bool:
    path = PurePath(os.path.normpath(name.replace("\\", "/")))
    return not path.is_absolute() and ".." not in path.parts


def version_of(element: Element) -> tuple[int, ...]:
    """The version of SDF in an element: (1, 6)."""
    words = re.findall(r"\d{1,6}", element.get("version") or "")
    return tuple(int(word) for word in words[:2]) or (1, 4)
