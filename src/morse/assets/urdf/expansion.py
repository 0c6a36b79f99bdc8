"""URDF files with macros (xacro), and with substitutions such as ``$(optenv NAME default)``."""

from __future__ import annotations

import contextlib
import importlib.util
import json
import os
import re
import time
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from morse.assets.errors import AssetError
from morse.assets.formats import ARGUMENTS, SUBSTITUTIONS
from morse.assets.nearby_files import FOLDERS, FileRefusedError, find_near, find_package
from morse.assets.urdf.xacro_program import TIME_LIMIT
from morse.assets.xml_files import parse_xml, read_xml
from morse.system.extras import install
from morse.system.workers import Worker, WorkerError, bare_environment

if TYPE_CHECKING:
    from pathlib import Path

_PROGRAM = "morse.assets.urdf.xacro_program"
#: package://, file://
_URL = re.compile(r"[a-z][a-z0-9+.-]*://")
#: up to the next one: its end is searched once
_SUBSTITUTION = re.compile(r"\$\((optenv|env|find|dirname)((?:[^)$]|\$(?!\())*)\)")


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
            if "$(" in value:  # of the parsed file: as a text, it may be written "&#36;(" or in UTF-16
                if not SUBSTITUTIONS.get():
                    raise AssetError(path, "a file that is sent cannot contain substitutions, such as $(env NAME)")
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
        values = ARGUMENTS.get({})
        if word == "env" and rest[0] not in values:
            raise AssetError(
                path, f"a file reads no environment variables: give {rest[0]:.60} as in "
                f"Robot({path.name!r}, arguments={{'{rest[0]:.60}': ...}})",
            )  # fmt: skip
        return str(values.get(rest[0], rest[1] if len(rest) > 1 else ""))

    return _SUBSTITUTION.sub(replace, value)


def _package(name: str, path: Path) -> str:
    try:
        return str(find_package(name, path))
    except FileRefusedError as error:
        raise AssetError(path, f"$(find {name[:60]}): {error}") from None


def _expanded(path: Path) -> bytes:
    if importlib.util.find_spec("xacro") is None:
        raise AssetError(path, f"files of xacro need: {install('xacro')}")
    question = {"path": str(path.absolute()), "arguments": ARGUMENTS.get({})}
    folders = {name: os.environ[name] for name in FOLDERS if name in os.environ}
    begin = time.monotonic()
    worker = Worker.program(_PROGRAM, {**bare_environment(), **folders}, is_silent=True)
    try:
        answer = json.loads(worker.ask(json.dumps(question).encode(), TIME_LIMIT))
    except (WorkerError, ValueError):
        if time.monotonic() - begin > TIME_LIMIT:
            raise AssetError(path, f"xacro needs more than {TIME_LIMIT:g} s to expand it") from None
        raise AssetError(path, "xacro cannot expand it: its process ended, perhaps without memory") from None
    finally:
        worker.close()
    if "error" in answer:
        raise AssetError(path, answer["error"])
    return str(answer["text"]).encode()
