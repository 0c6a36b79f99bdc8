"""The files of SDF models: URIs, and folders with ``model.config``."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets.errors import AssetError
from morse.assets.model_folders import CONFIG, model_file
from morse.assets.nearby_files import FileRefusedError, find_near
from morse.assets.xml_files import read_xml

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

_ROOTS = ("sdf", "gazebo")


def find_model(uri: str, model: Path) -> Path:
    """Return the SDF file that ``<include><uri>`` names: a file, or the folder of a model.

    Args:
        model: the file that contains the element.

    Raises:
        FileRefusedError: it does not exist, is on a server, or is outside of the folders that may be read.
    """
    uri = uri.strip()
    if uri.startswith(("http://", "https://")):
        return _downloaded(uri, model)
    if Path(uri).suffix.lower() in (".sdf", ".world", ".urdf"):
        return find_near(uri, model)
    stem = uri.rstrip("/")
    try:
        folder = find_near(f"{stem}/{CONFIG}", model).parent
    except FileRefusedError:
        if "://" not in stem:
            with contextlib.suppress(FileRefusedError):
                return find_model(f"model://{stem}", model)  # the name of a model, without a scheme
        return find_near(f"{stem}/model.sdf", model)
    file = model_file(folder)
    if file is None:
        raise FileRefusedError(f"{folder / CONFIG} names no file that exists")
    return file


def _downloaded(uri: str, model: Path) -> Path:
    """A model of a server of which the user has a copy, in the cache of Gazebo or in a folder of its name."""
    parts = uri.rstrip("/").split("/")
    name = parts[-2] if parts[-1].isdigit() or parts[-1] == "tip" else parts[-1]
    if "models" in parts[:-1]:
        index = parts.index("models")
        owner, name = parts[index - 1], parts[index + 1]
        for folder in (Path.home() / ".gz" / "fuel", Path.home() / ".ignition" / "fuel"):
            versions = folder / parts[2] / owner.lower() / "models" / name.lower().replace("%20", " ")
            for version in sorted(versions.glob("*"), key=lambda one: (len(one.name), one.name), reverse=True)[:1]:
                if (file := model_file(version)) is not None:
                    return file
    try:
        return find_model(f"model://{name}", model)
    except FileRefusedError:
        raise FileRefusedError(
            f"nothing is downloaded: put the model into a folder '{name:.80}' in one of GZ_SIM_RESOURCE_PATH"
        ) from None


def read_root(path: Path) -> Element:
    """Return the element ``sdf`` of a file.

    Raises:
        AssetError: it is no SDF file, or is refused by `read_xml`.
        OSError: it cannot be opened.
    """
    root = read_xml(path)
    if root.tag not in _ROOTS:
        raise AssetError(path, f"it is not SDF: it begins with <{str(root.tag)[:60]}>, expected <sdf>")
    return root
