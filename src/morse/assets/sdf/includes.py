"""Builds the scopes of an SDF file, with the models that it includes."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from morse.assets.errors import AssetError
from morse.assets.gazebo.values import ValueMistakeError, boolean, pose_of, text_of, vector, version_of
from morse.assets.nearby_files import FileRefusedError
from morse.assets.sdf.files import NotDownloadedError, find_model, read_root
from morse.assets.sdf.scope import MODEL, Part, Scope
from morse.assets.triangle_limit import check_parts
from morse.system.free_names import free_name

if TYPE_CHECKING:
    from collections.abc import Container

    from morse.mathutils import Matrix

_PLANE = "<geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry>"
_MODELS = {
    "ground_plane": f"""<sdf version="1.6"><model name="ground_plane"><static>true</static><link name="link">
        <collision name="collision">{_PLANE}</collision><visual name="visual">{_PLANE}
        <material><diffuse>0.7 0.7 0.7 1</diffuse></material></visual></link></model></sdf>""",
    "sun": """<sdf version="1.6"><light type="directional" name="sun"><cast_shadows>true</cast_shadows>
        <pose>0 0 10 0 0 0</pose><diffuse>0.8 0.8 0.8 1</diffuse><direction>-0.5 0.1 -0.9</direction></light></sdf>""",
}


def usual_model(uri: str) -> Element | None:
    """The element ``sdf`` of a floor or a sun that is not installed; None for any other model."""
    name = uri.rstrip("/").rpartition("/")[2].lower().replace(" ", "_")
    text = _MODELS.get(name)
    return None if text is None else ElementTree.fromstring(text)


#: models in models, and models that are included, each use counted
_DEEPEST, _MOST_INCLUDES = 20, 2000
#: links, joints, frames, shapes and sensors, those of each use of an included model counted
_MOST_PARTS = 20_000
#: elements with an effect in Gazebo
_LEFT_OUT = (
    "particle_emitter", "projector", "audio_source", "audio_sink", "battery", "gripper", "population", "road",
    "fluid_added_mass", "wind",
)  # fmt: skip
_COUNTED = ("link", "joint", "frame", "visual", "collision", "sensor", "model", "light", "plugin", "waypoint")


@dataclass(slots=True)
class Includes:
    """Reads files, each once, and counts what the whole model consists of.

    Attributes:
        path: the file that was asked for.
        warnings: what is left out, one sentence each.
    """

    path: Path
    warnings: list[str] = field(default_factory=list)
    _roots: dict[Path, Element] = field(default_factory=dict)
    _sizes: dict[Path, int] = field(default_factory=dict)
    _places: dict[tuple[str, Path], Path | FileRefusedError] = field(default_factory=dict)
    _warned: set[str] = field(default_factory=set)
    _includes: int = 0
    _parts: int = 0
    _stack: list[Path] = field(default_factory=list)

    def root(self, path: Path) -> Element:
        """The element ``sdf`` of a file, whose parts are counted each time.

        Raises:
            AssetError: it is not an SDF file, or all files together have too many parts.
            OSError: it cannot be opened.
        """
        if path not in self._roots:
            self._roots[path] = read_root(path)
            tags = Counter(element.tag for element in self._roots[path].iter() if isinstance(element.tag, str))
            self._sizes[path] = sum(tags[tag] for tag in _COUNTED)
            left_out = [f"{tags[tag]} <{tag}>" for tag in _LEFT_OUT if tags[tag]]
            if left_out:
                self.warn(f"elements of {path.name} that MORSE does not have are left out: {', '.join(left_out)}")
        self._parts += self._sizes[path]
        check_parts(self.path, self._parts, "links, joints, shapes and other parts", _MOST_PARTS)
        return self._roots[path]

    def warn(self, text: str) -> None:
        """Add a warning, once."""
        if text not in self._warned:
            self._warned.add(text)
            self.warnings.append(text)

    def world(self, element: Element, path: Path, version: tuple[int, ...]) -> Scope:
        """The content of an element ``world`` of the file that was asked for; see `scope`."""
        self._stack.append(path.resolve())
        scope = self.scope(element, path, version)
        self._apply_state(scope, element.find("state"))
        return scope

    def _apply_state(self, scope: Scope, state: Element | None) -> None:
        """Put the models of a world where they stood when Gazebo saved it, as Gazebo Classic does.

        Gazebo writes the poses at which models were inserted into their elements, and where they have been moved to
        into the state.
        """
        for saved in () if state is None else state:
            if saved.tag in ("insertions", "deletions") and len(saved):
                self.warn(f"the <{saved.tag}> of <state> are left out")
            model = scope.models.get(_name(saved)) if saved.tag == "model" else None
            if model is None:
                continue
            try:
                if saved.find("pose") is not None:
                    model.pose, model.base, model.placement = pose_of(saved.find("pose")), "", ""
                if vector(saved, "scale", (1.0, 1.0, 1.0)) != (1.0, 1.0, 1.0):
                    self.warn(f"the scale of the model '{model.name:.60}' in <state> is left out")
            except ValueMistakeError as error:
                self.warn(f"the model '{model.name:.60}' in <state>: {error}")

    # -- scopes ------------------------------------------------------------------------------

    def scope(self, element: Element, path: Path, version: tuple[int, ...], depth: int = 0) -> Scope:
        """The content of an element ``model`` or ``world``.

        Raises:
            AssetError: models are nested too deeply, include each other, or are too many.
        """
        if depth > _DEEPEST:
            raise AssetError(self.path, f"its models are nested more than {_DEEPEST} deep, at '{_name(element)}'")
        scope = Scope(
            _name(element),
            path,
            static=boolean(element, "static"),
            self_collide=boolean(element, "self_collide"),
            canonical=element.get("canonical_link", ""),
            placement=element.get("placement_frame", ""),
        )
        scope.pose, scope.base = self._pose(element, f"the model '{scope.name}'")
        kinds = {"link": scope.links, "joint": scope.joints, "frame": scope.frames}
        for child in element:
            if child.tag in kinds:
                part, parts = self._part(child, path, version), kinds[child.tag]
                part.name = self._unique(part.name, parts, f"the model '{scope.name}' has two elements <{child.tag}>")
                parts[part.name] = part
            elif child.tag == "model":
                self._add(scope, self.scope(child, path, version, depth + 1))
            elif child.tag == "include":
                self._include(scope, child, path, depth)
            elif child.tag == "light":
                self._add_light(scope, child)
            elif child.tag == "actor":
                scope.actors.append((child, path))
        scope.plugins += [(child, path) for child in element.findall("plugin")]
        return scope

    def _part(self, element: Element, path: Path, version: tuple[int, ...]) -> Part:
        part = Part(_name(element), element, path, version, attached=element.get("attached_to", ""))
        part.pose, part.base = self._pose(element, f"<{element.tag} name='{part.name}'>")
        return part

    def _pose(self, element: Element, what: str) -> tuple[Matrix, str]:
        pose = element.find("pose")
        base = "" if pose is None else pose.get("relative_to") or ""
        try:
            return pose_of(pose), base
        except ValueMistakeError as error:
            self.warn(f"{what}: {error}; it stands at the origin of its frame")
            return pose_of(None), base

    def _unique(self, name: str, names: Container[str], what: str) -> str:
        unique = free_name(name, names.__contains__)
        if unique != name:
            self.warn(f"{what} '{name:.60}'; one is called '{unique:.60}'")
        return unique

    def _add(self, scope: Scope, model: Scope) -> None:
        model.name = self._unique(model.name, scope.models, f"'{scope.name}' has two models")
        scope.models[model.name] = model

    # -- include -----------------------------------------------------------------------------

    def _include(self, scope: Scope, element: Element, path: Path, depth: int) -> None:
        uri = text_of(element, "uri")
        self._includes += 1
        if self._includes > _MOST_INCLUDES:
            raise AssetError(self.path, f"it includes more than {_MOST_INCLUDES} models, the last one is '{uri:.80}'")
        try:
            root, file = self._file(uri, path)
        except (FileRefusedError, OSError) as error:
            reason = str(error) if isinstance(error, FileRefusedError) else error.strerror
            self.warn(
                str(error) if isinstance(error, NotDownloadedError) else f"the model '{uri:.120}' is left out: {reason}"
            )
            return
        except AssetError as error:
            if error.path == self.path:
                raise
            self.warn(f"the model '{uri:.120}' is left out: {error.message}")
            return
        for light in root.findall("light"):
            self._add_light(scope, light)
        scope.actors += [(actor, file) for actor in root.findall("actor")]
        child = root.find("model")
        if child is None:
            return
        self._stack.append(file)
        model = self.scope(child, file, version_of(root), depth + 1)
        self._stack.pop()
        model.name = text_of(element, "name", model.name)
        if element.find("pose") is not None:
            model.pose, model.base = self._pose(element, f"the include '{uri:.80}'")
            model.placement = text_of(element, "placement_frame", "")
        if element.find("placement_frame") is not None:
            model.placement = text_of(element, "placement_frame")
        model.static = boolean(element, "static", model.static)
        model.plugins += [(child, path) for child in element.findall("plugin")]
        merges = (element.get("merge") or "").lower() in ("true", "1")
        if merges and not depth:
            self.warn(f"the model '{uri:.120}' stays a model: a world has no links of its own that it could merge with")
        if merges and depth:
            self._merge(scope, model)
        else:
            self._add(scope, model)

    def _place(self, uri: str, path: Path) -> Path:
        key = (uri, path)
        if key not in self._places:
            try:
                self._places[key] = Path(find_model(uri, path)).resolve()
            except FileRefusedError as error:
                self._places[key] = error
        place = self._places[key]
        if isinstance(place, FileRefusedError):
            raise place
        return place

    def _file(self, uri: str, path: Path) -> tuple[Element, Path]:
        """The content of an included file, and the file."""
        try:
            file = self._place(uri, path)
        except FileRefusedError:
            usual = usual_model(uri)
            if usual is None:
                raise
            return usual, path
        if file in self._stack:
            raise AssetError(self.path, f"{file.name} includes itself, by '{uri:.80}'")
        if len(self._stack) >= _DEEPEST:
            raise AssetError(self.path, f"its includes are nested more than {_DEEPEST} deep, at '{uri:.80}'")
        return self.root(file), file

    def _add_light(self, scope: Scope, element: Element) -> None:
        pose, base = self._pose(element, f"the light '{_name(element)}'")
        frame = Part(f"light {len(scope.lights)}", element, self.path, (1, 12), pose=pose, base=base)
        scope.lights.append((element, frame))

    def _merge(self, scope: Scope, model: Scope) -> None:
        """Move the parts of a model into the scope that includes it; its frame gets a name of its own."""
        home = f"_merged__{model.name}__model__"
        pose = model.pose
        if model.placement:
            pose = pose @ model.pose_of(model.placement).inverted()
        frame = Part(home, Element("frame"), model.path, (1, 12), pose=pose, base=model.base)
        scope.frames[self._unique(home, scope.frames, f"'{scope.name}' has two frames")] = frame
        for kind in ("links", "joints", "frames"):
            target = getattr(scope, kind)
            for name, part in getattr(model, kind).items():
                unique = self._unique(name, target, f"'{scope.name}' has two {kind}")
                target[unique] = replace(
                    part,
                    name=unique,
                    home=home if part.home == MODEL else part.home,
                    base=home if part.base == MODEL else part.base,
                    attached=home if part.attached == MODEL else part.attached,
                )
        for child in model.models.values():
            child.base = child.base if child.base not in ("", MODEL) else home
            self._add(scope, child)
        scope.plugins += model.plugins
        scope.lights += [(light, replace(frame, base=frame.base or home)) for light, frame in model.lights]


def _name(element: Element) -> str:
    return (element.get("name") or "").strip()[:200] or str(element.tag)
