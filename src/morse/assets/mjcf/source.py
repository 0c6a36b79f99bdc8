"""An MJCF file with all files that it includes, reduced to the robot.

The parser of the engine would read any file that a model names, and allocate any amount of memory that a model
requests. The text that it receives from here names no files, and has no elements that request much memory.
"""

from __future__ import annotations

import math
import os
import re
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from morse.assets.errors import AssetError
from morse.assets.mjcf.flexes import FILES, MOST_MOVING, MOST_VERTICES, moving_of, put_in, vertices_of
from morse.assets.mjcf.heights import MOST_POINTS, check_implied, check_points, suffix_of
from morse.assets.mjcf.old_files import modernize
from morse.assets.mjcf.skins import MOST_NUMBERS, read_skin
from morse.assets.mjcf.textures import take_textures
from morse.assets.nearby_files import FileRefusedError, find_near
from morse.assets.triangle_limit import check_parts
from morse.assets.xml_files import line_of, read_xml
from morse.scene.mjcf import MARKER, AttachedModel, MjcfFile
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from morse.assets.mjcf.skins import Skin
    from morse.assets.mjcf.textures import Texture

_MOST_ELEMENTS, _MOST_FILES = 100_000, 200
_MOST_MESH_BYTES = 512 << 20
_LARGEST = 1e15
#: attribute of the elements of included files: that file
_ORIGIN = "included-from"
#: top-level elements that do not describe the robot
_LEFT_OUT = ("visual", "statistic", "custom", "size")
#: elements that are not supported
_UNSUPPORTED = ("composite", "extension", "plugin", "skin")
#: maximum number of models that attach each other
_MOST_MODELS = 50
#: attributes that request memory or name files
_ATTRIBUTES = ("nsample", "delay", "interval", "plugin", "file", "fileleft", "fileright")
#: no limit, in ranges
_INFINITE = re.compile(r"(?<![^\s])[+-]?inf(inity)?(?![^\s])", re.IGNORECASE)
#: attributes with words that may look like numbers
_WORDS = ("name", "class", "childclass", "mesh", "material", "model")


class Source:
    """The text for the engine, and the meshes that it requires.

    Args:
        path: the file.
        main: the model that attaches this one.

    Attributes:
        name: name of the model.
        meshes: name in the texts to the content of the file.
        textures: pictures and patterns; the pixel that the engine has of each is its number.
        skins: read here; the engine has no part in them.
        warnings: ignored elements, one sentence each.
    """

    def __init__(self, path: Path, main: Source | None = None) -> None:
        self.path = path
        self._main: Source = main or self
        self.warnings: list[str] = main.warnings if main else []
        self.meshes: dict[str, bytes] = main.meshes if main else {}
        self.textures: list[Texture] = main.textures if main else []
        self.skins: list[Skin] = []
        self._texts: list[str] = main._texts if main else []
        self._attached: dict[int, tuple[AttachedModel, ...]] = main._attached if main else {}
        self._files = self._elements = 0
        self._bytes = 0
        number = len(self._texts)
        self._texts.append("")
        root = self._read(path, ("mujoco",))
        self._include(root, path, [path])
        self.name = root.get("model") or path.stem
        self._check(root)
        self._folder = self._texture_folder = ""
        self._reduce(root)
        self._take_meshes(root)
        self._take_heights(root)
        self._attached[number] = tuple(self._take_models(root, number))
        self._places = _lines_of(root)
        self._texts[number] = ElementTree.tostring(root, encoding="unicode")

    def file(self) -> MjcfFile:
        """Return everything that the engine requires."""
        attached = tuple(self._attached[number] for number in range(len(self._texts)))
        return MjcfFile(tuple(self._texts), self.meshes, attached)

    def place_of(self, line: int) -> str:
        """Return where the file has what is in a line of the text for the engine, or nothing if that is not known."""
        if len(self._texts) > 1 or not 0 < line <= len(self._places):
            return ""
        file, number = self._places[line - 1]
        return f"line {number}{f' of {Path(file).name}' if file else ''}" if number else ""

    def _fail(self, message: str, element: ElementTree.Element | None = None) -> AssetError:
        origin = None if element is None else element.get(_ORIGIN)
        return AssetError(origin or self.path, f"{message}{line_of(element)}")

    # -- files -----------------------------------------------------------------------------

    def _read(self, path: Path, tags: tuple[str, ...]) -> ElementTree.Element:
        root = read_xml(path)
        if root.tag == "mujocoinclude" and root.tag not in tags:
            raise AssetError(path, "it is a part of models: load the file that includes it")
        if root.tag not in tags:
            raise AssetError(path, f"it is not MJCF: it begins with <{root.tag:.60}>, expected <{tags[0]}>")
        self._files += 1
        self._elements += sum(1 for _ in root.iter())
        if self._files > _MOST_FILES or self._elements > _MOST_ELEMENTS:
            raise self._fail(f"it includes more than {_MOST_FILES} files or {_MOST_ELEMENTS} elements")
        return root

    def _include(self, parent: ElementTree.Element, path: Path, above: list[Path]) -> None:
        """Replace the elements ``include`` by the content of their files."""
        for child in list(parent):
            if child.tag != "include":
                self._include(child, path, above)
                continue
            name = child.get("file") or ""
            included = self._found(name, path)
            if included in above:
                circle = " includes ".join(one.name for one in [*above[above.index(included) :], included])
                raise self._fail(f"{circle}: files include each other")
            content = self._read(included, ("mujocoinclude", "mujoco"))
            self._include(content, included, [*above, included])
            for element in content.iter():
                element.attrib.setdefault(_ORIGIN, str(included))
            index = list(parent).index(child)
            parent.remove(child)
            for number, element in enumerate(content):
                parent.insert(index + number, element)

    def _found(self, name: str, path: Path) -> Path:
        reason: Exception | None = None
        # the path is relative to the model, or to the file that includes it
        for model in (self.path, path):
            try:
                return self._near(name, model).absolute()
            except FileRefusedError as error:
                reason = reason or error
        raise self._fail(f"the file {name[:200]!r} cannot be included: {reason}")

    def _near(self, name: str, model: Path) -> Path:
        """Return a file that a file of the model names; the package is that of the main model."""
        main = self._main.path
        if model.parent != main.parent and "://" not in name and not os.path.isabs(name):
            name = os.path.relpath(model.parent / name.replace("\\", "/"), main.parent)
        return find_near(name, main)

    # -- attached models -------------------------------------------------------------------

    def _take_models(self, root: ElementTree.Element, text: int) -> Iterator[AttachedModel]:
        """Read the models that this one attaches, and replace the elements ``attach`` by frames."""
        texts: dict[str, int] = {}
        for assets in root.iter("asset"):
            for asset in list(assets.iter("model")):
                assets.remove(asset)
                file = asset.get("file") or ""
                if len(self._texts) >= _MOST_MODELS:
                    raise self._fail(f"it consists of more than {_MOST_MODELS} models")
                try:
                    path = self._near(file, self.path)
                except FileRefusedError as error:
                    raise self._fail(f"the model {file[:200]!r} cannot be attached: {error}") from None
                texts[asset.get("name") or Path(file).stem] = len(self._texts)
                Source(path, self._main)
        for number, element in enumerate(list(root.iter("attach"))):
            model = texts.get(element.get("model") or "")
            if model is None:
                raise self._fail(
                    f"<attach> names the model {(element.get('model') or '')[:60]!r}, which is not an asset"
                )
            name = f"{MARKER}{text}.{number} "
            place = AttachedModel(name, model, element.get("body") or "", element.get("prefix") or "")
            element.tag = "frame"
            element.attrib.clear()
            element.set("name", name)
            yield place

    # -- elements --------------------------------------------------------------------------

    def _check(self, root: ElementTree.Element) -> None:
        """Refuse invalid or extremely large numbers, and a too large number of copies."""
        for element in root.iter():
            for name, value in element.attrib.items():
                if name in _WORDS or name == _ORIGIN:
                    continue
                if "range" in name:
                    value = _INFINITE.sub("0", value)
                for number in _numbers(value):
                    if not abs(number) <= _LARGEST:
                        raise self._fail(
                            f"<{element.tag} {name}={value[:60]!r}>: expected numbers that are realistic for a robot",
                            element,
                        )
        counts: Counter[str] = Counter()
        _count(root, 1, counts)
        for tag, count in counts.items():
            check_parts(self.path, count, f"elements <{tag:.40}>")

    def _reduce(self, root: ElementTree.Element) -> None:
        modernize(root, self.path)
        for child in list(root):
            if child.tag in _LEFT_OUT:
                root.remove(child)
        skins = list(root.iter("skin"))
        unsupported = sorted({element.tag for element in root.iter() if _is_lost(element)})
        if any(element.get("type") == "sdf" for element in root.iter("geom")):
            unsupported.append("geom of type sdf")
        if any(element.get("camera") for element in root.iter("rangefinder")):
            unsupported.append("rangefinder of a camera")
        for compiler in root.iter("compiler"):
            folder = compiler.get("assetdir") or ""
            self._folder = compiler.get("meshdir") or folder or self._folder
            self._texture_folder = compiler.get("texturedir") or folder or self._texture_folder
        lost_flexes = self._take_flexes(root)
        lost_joints = "composite" in unsupported or bool(lost_flexes)
        if lost_joints and (keys := root.findall("keyframe")):
            # they have values for the joints of what is left out
            unsupported.append("keyframe")
            for key in keys:
                root.remove(key)
        if unsupported:
            self.warnings.append(f"it has {', '.join(unsupported)}; they are left out")
        made = [mesh for mesh in root.iter("mesh") if mesh.find("plugin") is not None and not mesh.get("file")]
        for parent in list(root.iter()):
            for child in list(parent):
                if _is_left_out(child) or child in made or child in lost_flexes:
                    parent.remove(child)
        _remove_shapes(root, "mesh", {_asset_name(mesh) for mesh in made})
        if lost_joints:
            _remove_links(root, {element.get("name") for element in lost_flexes})
        self._take_skins(skins)
        self.warnings += take_textures(root, self.textures, self._picture, _ORIGIN)
        for element in root.iter():
            if element.tag not in ("mesh", "hfield", "model"):
                for name in _ATTRIBUTES:
                    element.attrib.pop(name, None)
        if root.find("compiler") is None:
            root.insert(0, ElementTree.Element("compiler"))
        for compiler in root.iter("compiler"):
            for name in ("meshdir", "assetdir", "texturedir", "strippath"):
                compiler.attrib.pop(name, None)
            # the links of the file and its visible shapes are kept separate
            compiler.attrib.update(fusestatic="false", discardvisual="false", balanceinertia="true")

    # -- meshes ----------------------------------------------------------------------------

    def _take_meshes(self, root: ElementTree.Element) -> None:
        removed_meshes: set[str] = set()
        # by everything that a mesh has except its name: equal ones are compiled once
        first: dict[tuple[tuple[str, str], ...], str] = {}
        for assets in root.iter("asset"):
            for mesh in list(assets.iter("mesh")):
                file, origin = mesh.get("file"), mesh.attrib.pop(_ORIGIN, None)
                name = _asset_name(mesh)
                if mesh.get("builtin") and max([0.0, *map(abs, _numbers(mesh.get("params", "")))]) > 64.0:
                    raise self._fail(f"the mesh '{name:.60}' has the parameters {mesh.get('params', '')[:60]!r}")
                if file is None:
                    continue
                content = tuple(sorted((key, value) for key, value in mesh.items() if key != "name"))
                if content in first:
                    _rename(root, "mesh", name, first[content])
                    assets.remove(mesh)
                    continue
                first[content] = name
                mesh.set("name", name)
                try:
                    mesh.set("file", self._content(file, origin))
                except (FileRefusedError, OSError) as error:
                    self.warnings.append(f"the mesh '{file:.200}' is left out: {error}")
                    removed_meshes.add(name)
                    assets.remove(mesh)
        _remove_shapes(root, "mesh", removed_meshes)

    def _take_skins(self, elements: Sequence[ElementTree.Element]) -> None:
        for element in elements:
            file = element.get("file")
            try:
                if self._main is not self:
                    raise ValueError("it belongs to a model that is attached")
                path = None if file is None else self._file(file, element.get(_ORIGIN))
                skin = read_skin(element, None if path is None else read_regular(path, _MOST_MESH_BYTES))
                if sum(one.size for one in self.skins) + skin.size > MOST_NUMBERS:
                    raise ValueError(f"all skins together have more than {MOST_NUMBERS} numbers")
                self.skins.append(skin)
            except (ValueError, FileRefusedError, OSError) as error:
                name = element.get("name") or file or ""
                self.warnings.append(f"the skin '{name:.200}' is left out: {error}")

    def _take_flexes(self, root: ElementTree.Element) -> list[ElementTree.Element]:
        """Read the files of deformable bodies, and return those that cannot be read or are too large."""
        lost, vertices, moving = [], 0, 0
        for element, copies in _flexes(root, 1):
            file = element.attrib.pop("file", None)
            name = element.get("name") or file or ""
            try:
                if element.tag == "flexcomp" and element.get("type", "grid") in FILES:
                    if file is None:
                        raise ValueError("it names no file")
                    put_in(element, self._file(file, element.get(_ORIGIN)))
                own = copies * vertices_of(element)
                if vertices + own > MOST_VERTICES:
                    raise ValueError(f"all deformable bodies together have more than {MOST_VERTICES} vertices")
                alone = copies * moving_of(element)
                if moving + alone > MOST_MOVING:
                    raise ValueError(f"all deformable bodies together have more than {MOST_MOVING} moving vertices")
                vertices, moving = vertices + own, moving + alone
            except (ValueError, OSError) as error:
                self.warnings.append(f"the deformable body '{name:.200}' is left out: {error}")
                lost.append(element)
        return lost

    def _take_heights(self, root: ElementTree.Element) -> None:
        removed_heights: set[str] = set()
        points = 0.0
        for assets in root.iter("asset"):
            for field in list(assets.iter("hfield")):
                file, origin = field.get("file"), field.attrib.pop(_ORIGIN, None)
                name = _asset_name(field)
                field.set("name", name)
                source = f" ('{file:.200}')" if file else ""
                field.attrib.pop("content_type", None)
                try:
                    rows, columns = ([*_numbers(field.get(word, "0")), 0.0][0] for word in ("nrow", "ncol"))
                    points += check_points(rows, columns)
                    if not file:
                        check_implied(rows, columns)
                    if points > MOST_POINTS:
                        raise FileRefusedError(f"all height fields together have more than {MOST_POINTS} points")
                    if file is not None:
                        field.set("file", self._heights(file, origin))
                except (FileRefusedError, OSError) as error:
                    self.warnings.append(f"the hfield '{name:.200}'{source} is left out: {error}")
                    removed_heights.add(name)
                    assets.remove(field)
        _remove_shapes(root, "hfield", removed_heights)

    def _heights(self, file: str, origin: str | None) -> str:
        content = read_regular(self._file(file, origin), _MOST_MESH_BYTES)
        key = f"heights{len(self.meshes)}{suffix_of(content)}"
        self.meshes[key] = content
        return key

    def _picture(self, file: str, origin: str | None) -> bytes:
        return read_regular(self._file(file, origin, self._texture_folder), _MOST_MESH_BYTES)

    def _file(self, file: str, origin: str | None, folder: str | None = None) -> Path:
        """Return the path of an asset, relative to the model, or to the included file that names it."""
        folder = self._folder if folder is None else folder
        name = f"{folder}/{file}" if folder and not file.startswith("/") else file
        try:
            path = self._near(name, self.path)
        except FileRefusedError:
            if origin is None:
                raise
            path = self._near(name, Path(origin))
        self._bytes += path.stat().st_size
        if self._bytes > _MOST_MESH_BYTES:
            raise FileRefusedError(f"all meshes and pictures together are larger than {_MOST_MESH_BYTES >> 20} MB")
        return path

    def _content(self, file: str, origin: str | None) -> str:
        suffix = Path(file.replace("\\", "/")).suffix.lower()
        if suffix not in (".stl", ".obj", ".msh"):
            raise FileRefusedError(f"files of type '{suffix}' cannot be read; supported: .msh, .obj, .stl")
        key = f"mesh{len(self.meshes)}{suffix}"
        self.meshes[key] = read_regular(self._file(file, origin), _MOST_MESH_BYTES)
        return key


def _lines_of(root: ElementTree.Element) -> list[tuple[str, int]]:
    """Lay out a model with one element in a line, and return the included file and the line of each."""
    places: list[tuple[str, int]] = []

    def lay_out(element: ElementTree.Element) -> None:
        place = element.attrib.pop(_ORIGIN, ""), getattr(element, "line", 0)
        places.append(place)
        element.text, element.tail = "\n" if len(element) else None, "\n"
        for child in element:
            lay_out(child)
        if len(element):
            places.append(place)

    lay_out(root)
    return places


def _is_lost(element: ElementTree.Element) -> bool:
    """Whether nothing is shown of an element that the engine does not get."""
    return element.tag in _UNSUPPORTED and element.tag != "skin"


def _is_left_out(child: ElementTree.Element) -> bool:
    """Whether an element is ignored, because it is not supported."""
    if child.tag == "geom":
        return child.get("type") == "sdf"
    if child.tag == "rangefinder":
        # it measures as many distances as the picture has pixels
        return child.get("camera") is not None
    return child.tag in _UNSUPPORTED


def _count(element: ElementTree.Element, copies: int, counts: Counter[str]) -> None:
    """Add the numbers of elements of each kind, with the copies that ``replicate`` makes of them."""
    counts[element.tag] += copies
    for child in element:
        _count(child, copies * _copies(element), counts)


def _copies(element: ElementTree.Element) -> int:
    """The number of copies that an element makes of those below it."""
    return int(max([1.0, *_numbers(element.get("count", "1"))])) if element.tag == "replicate" else 1


def _flexes(element: ElementTree.Element, copies: int) -> Iterator[tuple[ElementTree.Element, int]]:
    """The deformable bodies below an element, and the number of copies of each."""
    for child in element:
        if child.tag in ("flexcomp", "flex") and element.tag != "equality":
            yield child, copies
        else:
            yield from _flexes(child, copies * _copies(child))


def _numbers(text: str) -> Iterator[float]:
    """The words of a text that are numbers, including infinity."""
    for word in text.split():
        try:
            number = float(word)
        except ValueError:
            continue
        yield number if not math.isnan(number) else math.inf


def _asset_name(asset: ElementTree.Element) -> str:
    """The name of an asset, which is by default that of its file."""
    file = asset.get("file")
    return asset.get("name") or (Path(file.replace("\\", "/")).stem if file else "")


def _remove_links(root: ElementTree.Element, flexes: Collection[str | None]) -> None:
    """Remove the constraints and exclusions that name bodies which are left out, or deformable ones of these names."""
    names = {body.get("name") for body in root.iter("body")} | {"world", None, ""}
    for parent in [*root.iter("equality"), *root.iter("contact")]:
        for child in list(parent):
            if not {child.get("body1"), child.get("body2")} <= names or child.get("flex", "") in flexes:
                parent.remove(child)


def _rename(root: ElementTree.Element, attribute: str, name: str, other: str) -> None:
    """Use another asset in place of one that is removed."""
    for element in root.iter():
        if element.get(attribute) == name:
            element.set(attribute, other)


def _remove_shapes(root: ElementTree.Element, attribute: str, names: set[str]) -> None:
    """Remove the shapes whose asset is left out, and what names these shapes: pairs, sensors, tendons."""
    if not names:
        return
    shapes = set()
    for parent in list(root.iter()):
        for child in list(parent):
            if child.get(attribute) not in names:
                continue
            if child.tag == "site":
                del child.attrib[attribute]
                child.attrib.pop("type", None)
            else:
                parent.remove(child)
                shapes.add(child.get("name") if child.tag == "geom" else None)
    shapes.discard(None)
    for parent in list(root.iter()):
        for child in list(parent):
            objects = {child.get(f"{word}name") for word in ("obj", "ref") if child.get(f"{word}type") == "geom"}
            if shapes & {child.get("geom"), child.get("geom1"), child.get("geom2"), *objects}:
                parent.remove(child)
