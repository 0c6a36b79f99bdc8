"""The files of SDF models: URIs, and folders with ``model.config``."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote

from morse.assets.errors import AssetError
from morse.assets.gazebo.values import CONFIG, model_file
from morse.assets.nearby_files import FileRefusedError, find_near
from morse.assets.xml_files import read_xml
from morse.system.regular_files import home

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

#: below the home folder, where Gazebo keeps what it has downloaded
_CACHES = ((".gz", "fuel"), (".ignition", "fuel"))
_ROOTS = ("sdf", "gazebo")


class NotDownloadedError(FileRefusedError):
    """A file is on a server; the message names the model, and is the same for all of its files."""


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
        raise FileRefusedError(f"{folder / CONFIG} names no file that exists in its folder")
    return _inside(file, folder)


def _inside(file: Path, folder: Path) -> Path:
    """Return a file that is in a folder, also after symbolic links are resolved."""
    if not file.resolve().is_relative_to(folder.resolve()):
        raise FileRefusedError(f"{file.name:.80} of {folder} is a symbolic link that leads out of this folder")
    return file


def _downloaded(uri: str, model: Path) -> Path:
    """A model of a server of which the user has a copy, in the cache of Gazebo or in a folder of its name."""
    name, page, versions, _ = _of_server(uri)
    for version in versions:
        if (file := model_file(version)) is not None:
            return _inside(file, version)
    try:
        return find_model(f"model://{name}", model)
    except FileRefusedError:
        raise _not_downloaded(name, page) from None


def find_file(uri: str, model: Path) -> Path:
    """Return the file that a mesh or a picture is read from; one of a server from the cache of Gazebo.

    Raises:
        FileRefusedError: it does not exist, or must not be read.
    """
    if not uri.startswith(("http://", "https://")):
        return find_near(uri, model)
    name, page, versions, inside = _of_server(uri)
    for version in versions:
        file = (version / inside).resolve()
        if inside and file.is_file() and file.is_relative_to(version.resolve()):
            return file
    with contextlib.suppress(FileRefusedError):
        return find_near(f"model://{name}/{inside}", model)
    raise _not_downloaded(name, page)


def _of_server(uri: str) -> tuple[str, str, list[Path], str]:
    """The name of a model on a server, its address, the copies in the caches of Gazebo, and a file."""
    parts = [unquote(part) for part in uri.rstrip("/").split("/")]
    if "models" not in parts[3:-1]:
        return (parts[-2] if parts[-1].isdigit() or parts[-1] == "tip" else parts[-1]), "", [], ""
    index = parts.index("models", 3)
    name, page = parts[index + 1], "/".join(uri.split("/")[: index + 2])
    inside = "/".join(parts[parts.index("files") + 1 :]) if "files" in parts[index:] else ""
    versions: list[Path] = []
    place = (parts[2], parts[index - 1].lower(), "models", name.lower())
    if all(part not in ("", ".", "..") and os.sep not in part and "\0" not in part for part in place):
        own = home()
        for folder in [own.joinpath(*cache, *place) for cache in _CACHES] if own is not None else ():
            found = [one for one in folder.glob("*") if one.name.isdecimal() and one.is_dir()]
            versions += sorted(found, key=lambda one: int(one.name[:9]), reverse=True)
    wanted = parts[index + 2] if len(parts) > index + 2 else ""
    versions.sort(key=lambda one: one.name != wanted)
    return name, page, versions, inside


def _not_downloaded(name: str, page: str) -> NotDownloadedError:
    # in an address, a space would be a second word of the command
    fetch = f"fetch it once with `gz fuel download -u {page.replace(' ', '%20'):.200}`, or " if page else ""
    return NotDownloadedError(
        f"the model '{name:.80}' is not on this machine, and nothing is downloaded: {fetch}put it into a folder "
        f"'{name:.80}' in one of GZ_SIM_RESOURCE_PATH"
    )


def read_root(path: Path) -> Element:
    """Return the element ``sdf`` of a file.

    Raises:
        AssetError: it is not an SDF file, or is refused by `read_xml`.
        OSError: it cannot be opened.
    """
    root = read_xml(path)
    if root.tag not in _ROOTS:
        raise AssetError(path, f"it is not SDF: it begins with <{str(root.tag)[:60]}>, expected <sdf>")
    return root
