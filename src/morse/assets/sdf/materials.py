"""The materials of shapes: colours, pictures, and scripts of OGRE."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from morse.assets.gazebo.values import ValueMistakeError, color_of, number, text_of, vector
from morse.assets.nearby_files import FileRefusedError, find_folder_near, find_near
from morse.assets.pictures import Pictures, usable_picture
from morse.assets.sdf.files import find_file
from morse.mathutils.portable import linear_color
from morse.scene import Image, Material
from morse.system.pictures import opened
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path
    from xml.etree.ElementTree import Element

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


_GREY = (0.7, 0.7, 0.7, 1.0)
#: bytes of a picture, and of all scripts of a model
_MOST_BYTES, _MOST_OF_SCRIPTS = 128 << 20, 8 << 20


class Materials:
    """Converts the materials of a file; each picture and each script is read once.

    Args:
        warn: receives what is left out.
    """

    def __init__(self, warn: Callable[[str], None]) -> None:
        self._warn = warn
        self._pictures = Pictures()
        self._images: dict[Path, Image | None] = {}
        self._scripts: dict[Path, dict[str, Script]] = {}
        self._script_bytes = _MOST_OF_SCRIPTS

    def material(self, visual: Element, path: Path, name: str) -> Material | None:
        """The material of a visual, or None for that of its mesh.

        Args:
            path: the file that contains the element.
            name: name of the result.
        """
        element = visual.find("material")
        opacity = 1.0 - self._share(visual, "transparency", 0.0)
        if element is None:
            return None if opacity == 1.0 else Material(name, linear_color((*_GREY[:3], opacity)))
        color = self._color(element, "diffuse") or self._color(element, "ambient")
        light = self._color(element, "emissive")
        glow = light[:3] if light is not None and max(light[:3]) > 0.0 else None
        image, has_color = None, color is not None
        if element.find("script") is not None:
            script = self._script(element, path)
            if script is not None:
                color, glow = color or script.diffuse, glow or script.emissive
                image = self._image(script.texture, path, self._uris(element)) if script.texture else image
        metal, roughness = 0.0, 0.6
        work = element.find("pbr/metal")
        if work is None:
            work = element.find("pbr/specular")
        if work is not None:
            metal, roughness = self._share(work, "metalness", 0.0), self._share(work, "roughness", 0.6)
            if texture := text_of(work, "albedo_map"):
                image = self._image(texture, path, []) or image
        if color is None and image is None and glow is None and work is None:
            return None
        if image is not None and not has_color:
            color = (1.0, 1.0, 1.0, 1.0 if color is None else color[3])
        r, g, b, alpha = color or (_GREY if glow is None else (*glow, 1.0))
        return Material(
            name,
            linear_color((r, g, b, alpha * opacity)),
            metallic=metal,
            roughness=roughness,
            emission=linear_color((*(glow or (0.0, 0.0, 0.0)), 1.0))[:3],
            image=image,
            shadeless=text_of(element, "lighting").lower() in ("false", "0"),
        )

    def picture(self, uri: str, path: Path) -> Image | None:
        """The picture of a URI; None, with a warning, if it cannot be used."""
        return self._image(uri, path, [])

    # -- parts -------------------------------------------------------------------------------

    def _color(self, element: Element, tag: str) -> tuple[float, float, float, float] | None:
        """A colour and its opacity, or None."""
        if not text_of(element, tag):
            return None
        try:
            words = vector(element, tag, (0.0, 0.0, 0.0))
            if len(text_of(element, tag).split()) > 3:
                words = vector(element, tag, (0.0, 0.0, 0.0, 1.0))
        except ValueMistakeError as error:
            self._warn(f"the colour of a material is left out: {error}")
            return None
        r, g, b, alpha = (min(max(value, 0.0), 1.0) for value in (*words, 1.0)[:4])
        return r, g, b, alpha

    def _share(self, element: Element, tag: str, default: float) -> float:
        try:
            return min(max(number(element, tag, default), 0.0), 1.0)
        except ValueMistakeError as error:
            self._warn(f"{error}; {default:g} is used")
            return default

    def _uris(self, element: Element) -> list[str]:
        return [(uri.text or "").strip() for uri in element.findall("script/uri")]

    def _script(self, element: Element, path: Path) -> Script | None:
        name = text_of(element, "script/name")
        for uri in self._uris(element):
            place = _place(uri, path)
            if place is not None and name in (script := self._scripts_in(place)):
                return script[name]
        color = color_of(name)
        if color is not None:
            return Script(diffuse=(*color, 0.5 if name.endswith("Transparent") else 1.0))
        if name:
            self._warn(f"the material '{name:.80}' is left out: no script of the model contains it")
        return None

    def _scripts_in(self, place: Path) -> dict[str, Script]:
        place = place.resolve()
        if place not in self._scripts:
            try:
                self._scripts[place], size = scripts_in(place, self._script_bytes)
                self._script_bytes -= size
            except (OSError, ValueError) as error:
                self._warn(f"the materials in {place} are left out: {error}")
                self._scripts[place] = {}
        return self._scripts[place]

    def _image(self, name: str, path: Path, uris: list[str]) -> Image | None:
        """The picture of a script or a URI."""
        places = [place if place.is_dir() else place.parent for uri in uris if (place := _place(uri, path))]
        candidates = [folder / part / name for folder in places for part in ("", "../textures")]
        file = next((one for one in candidates if "\0" not in name and one.is_file()), None)
        if file is None:
            try:
                file = find_file(name, path)
            except FileRefusedError as error:
                self._warn(f"the picture '{name:.120}' is left out: {error}")
                return None
        elif not any(file.resolve().is_relative_to(place.parent.resolve()) for place in places):
            self._warn(f"the picture '{name:.120}' is left out: it is outside of the model")
            return None
        file = file.resolve()
        if file not in self._images:
            self._images[file] = self._read(file)
        return self._images[file]

    def _read(self, file: Path) -> Image | None:
        try:
            data = usable_picture(read_regular(file, _MOST_BYTES))
        except (OSError, ValueError) as error:
            self._warn(f"the picture {file.name:.80} is left out: {error}")
            return None
        image = self._pictures.image(file.stem, opened(data))
        for warning in self._pictures.warnings:
            self._warn(warning)
        return image


def _place(uri: str, path: Path) -> Path | None:
    """The file or folder of a URI of a script; None if it does not exist, or is part of Gazebo itself."""
    if uri.startswith("file://media"):
        return None
    try:
        return find_near(uri, path) if uri.endswith(".material") else find_folder_near(uri, path)
    except FileRefusedError:
        return None
