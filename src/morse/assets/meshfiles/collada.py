"""COLLADA files: checks before they are read."""

from __future__ import annotations

import importlib.util
import math
from typing import TYPE_CHECKING

from morse.assets.errors import AssetError
from morse.assets.meshfiles.collada_counts import check_instances
from morse.assets.xml_files import read_xml
from morse.system.extras import install

if TYPE_CHECKING:
    from pathlib import Path


def collada_unit(path: Path) -> float:
    """Return the unit of a COLLADA file, m.

    Raises:
        AssetError: it is not COLLADA, shows too much, or the package that reads such files is not installed.
    """
    root = read_xml(path)
    if root.tag.rpartition("}")[2] != "COLLADA":
        raise AssetError(path, f"it is not COLLADA: it begins with <{root.tag:.60}>")
    if importlib.util.find_spec("collada") is None:
        raise AssetError(path, f"COLLADA files need another package: {install('collada')}")
    check_instances(path, root)
    unit_element = root.find("./{*}asset/{*}unit")
    text = "1" if unit_element is None else unit_element.get("meter", "1")
    try:
        unit = float(text)
    except ValueError:
        unit = math.nan
    if not 1e-9 < unit < 1e9:
        raise AssetError(path, f"its unit is {text[:60]!r} m, expected a positive number")
    return unit
