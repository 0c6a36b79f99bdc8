"""URDF files with macros (xacro), and with substitutions such as ``$(optenv NAME default)``."""

from __future__ import annotations

import contextlib
import importlib.util
import json
import os
import re
import subprocess
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from morse.assets.arguments import ARGUMENTS
from morse.assets.errors import AssetError
from morse.assets.nearby_files import FileRefusedError, find_near, find_package
from morse.assets.xml_files import parse_xml, read_xml
from morse.system.own_programs import command

if TYPE_CHECKING:
    from pathlib import Path

#: of the expansion of a file of xacro, s
TIME_LIMIT = 30.0
_PROGRAM = "morse.assets.urdf.xacro_program"
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
    if importlib.util.find_spec("xacro") is None:
        raise AssetError(path, "files of xacro need: pip install 'morse-simulator[xacro]'")
    try:
        result = subprocess.run(
            command(_PROGRAM, str(path.absolute()), json.dumps(ARGUMENTS.get({}))),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=TIME_LIMIT,
            check=False,
        )
        answer = json.loads(result.stdout)
    except subprocess.TimeoutExpired:
        raise AssetError(path, f"xacro needs more than {TIME_LIMIT:g} s to expand it") from None
    except (OSError, ValueError):
        raise AssetError(path, "xacro cannot expand it: its process ended, perhaps without memory") from None
    if "error" in answer:
        raise AssetError(path, answer["error"])
    return str(answer["text"]).encode()
