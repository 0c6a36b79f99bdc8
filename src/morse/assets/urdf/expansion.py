"""URDF files with macros (xacro), and with substitutions such as ``$(optenv NAME default)``."""

from __future__ import annotations

import contextlib
import os
import re
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from morse.assets.arguments import ARGUMENTS
from morse.assets.errors import AssetError
from morse.assets.nearby_files import FileRefusedError, find_near, find_package
from morse.assets.xml_files import parse_xml, read_xml

if TYPE_CHECKING:
    from pathlib import Path

#: package://, file://
_URL = re.compile(r"[a-z][a-z0-9+.-]*://")
_SUBSTITUTION = re.compile(r"\$\((optenv|env|find|dirname)\s*([^)]*)\)")


def read_expanded(path: Path) -> ElementTree.Element:
    """Return the root element of a URDF file, without macros and substitutions.

    Raises:
        AssetError: it is not XML, or cannot be expanded.
        OSError: it cannot be opened.
    """
    if path.suffix == ".xacro":
        return parse_xml(_expanded(path), path)
    root = read_xml(path)
    for element in root.iter():
        for name, value in element.attrib.items():
            if "$(" in value:
                element.set(name, _substituted(value, path))
    return root


def text_with_urls(robot: ElementTree.Element, path: Path) -> tuple[str, dict[str, str]]:
    """A robot as text, in which relative paths of meshes are URLs, so that programs elsewhere read them.

    Returns:
        The text, and the URLs of the meshes with their files.
    """
    files = {}
    for mesh in robot.iter("mesh"):
        name = mesh.get("filename", "")
        with contextlib.suppress(FileRefusedError, OSError, ValueError):
            file = find_near(name, path).resolve()
            url = name if _URL.match(name) else file.as_uri()
            mesh.set("filename", url)
            files[url] = str(file)
    return ElementTree.tostring(robot, encoding="unicode"), files


def _substituted(value: str, path: Path) -> str:
    def replace(match: re.Match[str]) -> str:
        word, rest = match[1], match[2].split(maxsplit=1)
        if word == "dirname":
            return str(path.parent)
        if not rest:
            raise AssetError(path, f"'{match[0][:60]}' names nothing")
        if word == "find":
            return _package(rest[0], path)
        default = rest[1] if len(rest) > 1 else ""
        if word == "env" and rest[0] not in os.environ:
            raise AssetError(path, f"the environment variable {rest[0]:.60} is not set")
        return os.environ.get(rest[0], default)

    return _SUBSTITUTION.sub(replace, value)


def _package(name: str, path: Path) -> str:
    try:
        return str(find_package(name, path))
    except FileRefusedError as error:
        raise AssetError(path, f"$(find {name[:60]}): {error}") from None


def _expanded(path: Path) -> bytes:
    try:
        import xacro
        from xacro import substitution_args
    except ImportError:
        raise AssetError(path, "files of xacro need: pip install 'morse-simulator[xacro]'") from None
    refused: list[AssetError] = []

    def package(name: str) -> str:
        try:
            return _package(name, path)
        except AssetError as error:
            # xacro raises errors of its own instead
            refused.append(error)
            raise

    # without ROS, xacro cannot find packages
    substitution_args._eval_find = package
    try:
        document = xacro.process_file(str(path), mappings=dict(ARGUMENTS.get({})))
    except Exception as error:  # the expressions of the file raise anything
        if refused:
            raise refused[0] from None
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise AssetError(path, f"xacro cannot expand it: {reason:.300}") from None
    if not document.getElementsByTagName("link"):
        raise AssetError(path, "it defines macros or properties, and no links: load the file that includes it")
    expanded: bytes = document.toxml(encoding="utf-8")
    return expanded
