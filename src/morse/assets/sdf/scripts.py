"""Scripts of materials of the renderer OGRE: colours and pictures.

See https://ogrecave.github.io/ogre/api/latest/_material-_scripts.html.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from pathlib import Path

#: scripts in a folder, materials in a script
_MOST_FILES, _MOST_MATERIALS = 100, 2000
_MATERIAL = re.compile(r'^\s*material\s+("[^"\n]+"|[^\s:{]+)\s*(?::\s*("[^"\n]+"|[^\s{]+))?')


@dataclass(frozen=True, slots=True)
class Script:
    """A material.

    Attributes:
        diffuse: sRGB and opacity, or None.
        emissive: sRGB, or None.
        texture: name of a picture, or empty.
    """

    diffuse: tuple[float, float, float, float] | None = None
    emissive: tuple[float, float, float] | None = None
    texture: str = ""


def scripts_in(place: Path, most: int) -> tuple[dict[str, Script], int]:
    """The materials of a file ``*.material``, or of those of a folder, and the number of bytes that were read.

    A symbolic link in the folder that leads out of it is left out.

    Args:
        most: bytes of all files together.

    Raises:
        OSError: a file cannot be read, or is too large.
    """
    files = [place] if place.is_file() else sorted(place.glob("*.material"))[:_MOST_FILES]
    scripts: dict[str, Script] = {}
    size = 0
    for file in dict.fromkeys(file.resolve() for file in files):
        if file.is_relative_to((place if place.is_dir() else place.parent).resolve()):
            content = read_regular(file, most - size)
            size += len(content)
            _read(content.decode("utf-8", errors="replace"), scripts)
    return scripts, size


def _read(text: str, scripts: dict[str, Script]) -> None:
    name, current = "", Script()
    for raw in text.splitlines():
        line = raw.partition("//")[0].strip()
        match = _MATERIAL.match(line)
        if match:
            name, above = match[1].strip('"'), (match[2] or "").strip('"')
            current = scripts.get(above, Script())
            if len(scripts) < _MOST_MATERIALS:
                scripts[name] = current
            continue
        words = line.split()
        if len(words) < 2 or name not in scripts:
            continue
        current = scripts[name] = _changed(current, words)


def _changed(script: Script, words: list[str]) -> Script:
    """A material after one more line; the first pass and the first picture count."""
    if words[0] in ("diffuse", "emissive"):
        try:
            numbers = [min(max(float(word), 0.0), 1.0) for word in words[1:5]]
        except ValueError:
            return script
        if len(numbers) < 3:
            return script
        r, g, b, alpha = (*numbers, 1.0)[:4]
        if words[0] == "diffuse":
            return replace(script, diffuse=(r, g, b, alpha))
        return replace(script, emissive=(r, g, b))
    if words[0] == "texture" and not script.texture:
        return replace(script, texture=words[1].strip('"'))
    if words[0] == "set" and len(words) > 3 and words[1] == "$diffuse_map":
        return replace(script, texture=words[2].strip('"'))
    return script
