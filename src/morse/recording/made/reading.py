"""Reads descriptions of objects that functions have spawned from a recording."""

from __future__ import annotations

import hashlib
import json
import logging
import math
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
import zstandard

from morse.builder.assembly.spawning import Newcomer
from morse.core.actuator import Actuator
from morse.core.classes.classpath import load_class
from morse.core.declarations import DataField, properties
from morse.core.exceptions import MorseError
from morse.core.modifier import AbstractModifier
from morse.core.object import Object
from morse.core.reports.quoting import quoted
from morse.core.sensor import Sensor
from morse.core.validation.fields import checked_value
from morse.core.validation.spec import PropertyError
from morse.mathutils import Matrix
from morse.recording.errors import RecordingError
from morse.recording.made import form
from morse.recording.made.packing import MESH_ARRAYS, OWN, SHAPE_ARRAYS
from morse.recording.made.writing import BLOCKS, OBJECTS, SCENE, TOPIC, TYPE
from morse.recording.mcap.reader import LARGEST
from morse.rosmsgs.cdr import CdrError, decode
from morse.scene import (
    Bone,
    CollisionShape,
    ComponentDeclaration,
    Image,
    Material,
    Mesh,
    ModifierDeclaration,
    Node,
    Scene,
    Zone,
)
from morse.system.packed_keys import check_keys

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Mapping

    from morse.core.values import Fields
    from morse.recording.recording import Recording


# Unpacks and checks the description of an object from a file of unknown origin.

#: property of a node with the panel of its component
PANEL = "recorded panel"


class _Recorded:
    """Has the fields that the recording describes, and does nothing."""

    def __init__(self, obj: Any, parent: object = None) -> None:
        panel: form.PanelForm = obj.node.properties[PANEL]
        self._fields = {
            one.name: DataField(one.value, one.type, one.doc, unit=one.unit, low=one.low, high=one.high)
            for one in panel.fields
        }
        super().__init__(obj, parent)  # type: ignore[call-arg]
        self._name, self._short_desc = panel.title, panel.doc
        self.local_data: Fields
        for name, field in self._fields.items():
            self.local_data.setdefault(name, field.default)

    @property
    def own_fields(self) -> Mapping[str, DataField]:
        """The described fields."""
        return self._fields

    def default_action(self) -> None:
        """Do nothing."""


class RecordedSensor(_Recorded, Sensor):
    """A sensor of a project."""


class RecordedActuator(_Recorded, Actuator):
    """An actuator of a project."""


#: class path for a panel by the class of MORSE that is the only one left
STAND_INS = {
    f"{base.__module__}.{base.__qualname__}": f"{cls.__module__}.{cls.__qualname__}"
    for base, cls in ((Sensor, RecordedSensor), (Actuator, RecordedActuator))
}


_MOST_PARTS, _MOST_SLOTS = 20_000, 4096
_LONGEST_NAME = 1000
_PICTURES = ("image/png", "image/jpeg")
_KINDS = ("robot", "external_robot", "sensor", "actuator")
#: maximum number of fields of a panel
_MOST_FIELDS = 1000
_arrays = msgspec.msgpack.Decoder(dict[str, tuple[list[int], bytes]])
_descriptions = msgspec.msgpack.Decoder(form.DescriptionForm)
_scenes = msgspec.msgpack.Decoder(form.SceneForm)
#: maximum number of ticks per second, and of physics steps per tick
_FASTEST = 100_000
#: errors of damaged data
_DAMAGED = (ValueError, TypeError, LookupError, ArithmeticError, RecursionError)


class Unpacking:
    """Creates the nodes and the declarations of one description.

    Args:
        data: from `Packing.to_bytes`.
        block: returns a block by its digest; raises LookupError for an unknown one.
        class_of: returns a class path that may be loaded, of several; None if there is none.

    Attributes:
        roots, components: of the object.
        omitted: names of components without such a class.
        replaced: names of components with a class from which their own class is derived, or without a modifier.

    Raises:
        RecordingError: the description is damaged.
    """

    def __init__(self, data: bytes, block: Callable[[str], bytes], class_of: Callable[[list[str]], str | None]) -> None:
        self._block, self._class_of = block, class_of
        self.omitted: list[str] = []
        self.replaced: list[str] = []
        try:
            check_keys(data)
            parts = _descriptions.decode(data)
            for what in ("nodes", "components", "meshes", "materials", "images"):
                count = len(getattr(parts, what))
                _check(count <= _MOST_PARTS, f"{count} {what}, expected up to {_MOST_PARTS}")
            # the page gets them with their types
            _check(all(one.mime in _PICTURES for one in parts.images), f"images that are not {' or '.join(_PICTURES)}")
            self._images = [Image(one.name, block(one.data), one.mime) for one in parts.images]
            self._materials = [self._material(one) for one in parts.materials]
            self._meshes = [self._mesh(one) for one in parts.meshes]
            self._nodes: list[Node] = []
            for one in parts.nodes:
                self._nodes.append(self._node(one))
            _check(len({node.name for node in self._nodes}) == len(self._nodes), "two nodes of one name")
            for node in self._nodes:
                follows, children = node.flex, len(node.children)
                fits = follows is None or bool(((follows >= 0) & (follows < children)).all() and children)
                _check(fits, f"a deformable body {node.name[:80]} without vertices")
            self.roots = [node for node in self._nodes if node.parent is None]
            components = [self._component(one) for one in parts.components]
            self.components = [component for component in components if component is not None]
        except _DAMAGED as error:
            raise RecordingError(f"the description of an object is damaged: {error}") from None

    def _material(self, one: form.MaterialForm) -> Material:
        _check_finite("a material", *one.color, one.metallic, one.roughness, *one.emission, one.specular)
        values = {name: getattr(one, name) for name in one.__struct_fields__}
        return Material(**{**values, "image": None if one.image < 0 else self._images[one.image]})

    def _slots(self, places: list[int]) -> list[Material | None]:
        _check(len(places) <= _MOST_SLOTS, f"{len(places)} materials")
        return [None if place < 0 else self._materials[place] for place in places]

    def _arrays(self, digest: str, kinds: dict[str, str]) -> dict[str, np.ndarray]:
        arrays = {}
        for name, (shape, data) in _arrays.decode(self._block(digest)).items() if digest else ():
            _check(all(number >= 0 for number in shape) and len(shape) <= 3, f"an array of the shape {shape}")
            arrays[name] = np.frombuffer(data, kinds[name]).reshape(shape).copy()
            _check(bool(np.isfinite(arrays[name]).all()), f"numbers in {name} that are not finite")
        return arrays

    def _mesh(self, one: form.MeshForm) -> Mesh:
        arrays = self._arrays(one.data, MESH_ARRAYS)
        vertices, triangles, slots = arrays["vertices"], arrays["triangles"], arrays["material_index"]
        count = len(triangles)
        shapes = {"vertices": (len(vertices), 3), "triangles": (count, 3), "material_index": (count,)}
        shapes |= {"uvs": (count, 3, 2), "normals": (count, 3, 3), "follows": (len(vertices),)}
        for name, values in arrays.items():
            _check(values.shape == shapes[name], f"{name} of the shape {values.shape}, expected {shapes[name]}")
        if count:
            _check(triangles.min() >= 0 and triangles.max() < len(vertices), "triangles without vertices")
            _check(slots.min() >= 0 and slots.max() < _MOST_SLOTS, "triangles without a material")
        materials = tuple(self._slots(one.materials))
        uvs, normals, follows = (arrays.get(name) for name in ("uvs", "normals", "follows"))
        return Mesh(one.name, vertices, triangles, slots, uvs, normals, materials, follows)

    def _shape(self, one: form.ShapeForm) -> CollisionShape:
        _check_finite("a shape", *one.size, *one.position, *one.rotation)
        arrays = self._arrays(one.data, SHAPE_ARRAYS)
        for name, values in arrays.items():
            fits = values.ndim == 2 and (name == "heights" or values.shape[1] == 3)
            _check(fits, f"{name} of the shape {values.shape}")
        return CollisionShape(
            one.kind, one.size, one.position, one.rotation, arrays.get("vertices"), arrays.get("heights")
        )

    def _node(self, one: form.NodeForm) -> Node:
        _check(0 < len(one.name) < _LONGEST_NAME, "a node without a name")
        _check(-1 <= one.parent < len(self._nodes), f"the parent {one.parent} of {one.name[:80]}")
        inverse = one.parent_inverse
        numbers = (*one.location, *one.rotation_euler, *one.scale, *(inverse or ()), *(one.color or ()))
        _check_finite(one.name[:80], *numbers)
        node = Node(
            name=one.name,
            kind=one.kind,
            location=list(one.location),
            rotation_euler=list(one.rotation_euler),
            scale=list(one.scale),
            mesh=None if one.mesh < 0 else self._meshes[one.mesh],
            materials=self._slots(one.materials),
            light=one.light,
            camera=one.camera,
            body=one.body,
            properties=dict(one.properties),
            debug=one.debug,
            visible=one.visible,
            color=one.color,
            source_name=one.source_name,
            shapes=None if one.shapes is None else [self._shape(shape) for shape in one.shapes],
            bones=tuple(_bone(bone, place, len(one.bones)) for place, bone in enumerate(one.bones)),
            bone=one.bone,
            inertial=one.inertial,
            # a recording says nothing about the files of this machine
            articulation=one.articulation and replace(one.articulation, meshes=()),
        )
        if one.parent >= 0:
            self._nodes[one.parent].attach(node)
        if inverse is not None:
            node.parent_inverse = Matrix(tuple(inverse[row : row + 4] for row in range(0, 16, 4)))
        return node

    def _component(self, one: form.ComponentForm) -> ComponentDeclaration | None:
        _check(one.kind in _KINDS and min(one.node, one.robot) >= 0, f"a component of the kind {one.kind[:80]!r}")
        node, robot = self._nodes[one.node], self._nodes[one.robot]
        frequency = one.frequency
        _check(frequency is None or 0.0 < frequency < math.inf, f"the frequency {frequency}")
        classpath = self._class_of(one.classes)
        if classpath is None:
            self.omitted.append(node.name)
            return None
        unlike = classpath != one.classes[0]
        if one.panel is not None and classpath in STAND_INS:
            _check(len(one.panel.fields) <= _MOST_FIELDS, f"{len(one.panel.fields)} fields")
            node.properties[PANEL], classpath = one.panel, STAND_INS[classpath]
        _check_properties(node, classpath)
        modifiers = [(self._class_of([path]), options) for path, options in one.modifiers]
        if unlike or any(path is None for path, _ in modifiers):
            self.replaced.append(node.name)
        options = {"wheels": one.wheels, "realism": one.realism}
        return ComponentDeclaration(
            node,
            one.kind,
            classpath,
            robot,
            _own(node, "frequency", frequency),
            _own(node, "abstraction_level", one.level),
            modifiers=[ModifierDeclaration(path, options) for path, options in modifiers if path is not None],
            options={name: value for name, value in options.items() if value is not None},
        )


def unpacked_scene(data: bytes, objects: Unpacking) -> Scene:
    """The scene of some objects.

    Args:
        data: from `morse.recording.made.packing.scene_to_bytes`.

    Raises:
        RecordingError: the description is damaged.
    """
    try:
        check_keys(data)
        parts = _scenes.decode(data)
        settings = parts.settings
        # what a file says starts no processes
        settings.cameras_on = 0
        _check_finite("the settings", *_numbers(asdict(settings)))
        _check(0.0 < settings.frequency <= _FASTEST, f"a frequency of {settings.frequency} Hz")
        _check(0 < settings.physics_steps <= _FASTEST, f"{settings.physics_steps} physics steps")
        nodes = {node.name: node for root in objects.roots for node in root.walk()}
        zones = [Zone(nodes[name], kind) for name, kind in parts.zones]
    except _DAMAGED as error:
        raise RecordingError(f"the description of the scene is damaged: {error}") from None
    return Scene(
        environment=parts.environment[:_LONGEST_NAME],
        roots=objects.roots,
        components=objects.components,
        zones=zones,
        settings=settings,
        properties=parts.properties,
    )


def _check_properties(node: Node, classpath: str) -> None:
    """Check the properties of a component as those of a script: its images and scans have a limit of size."""
    for prop in properties(load_class(classpath)).values():
        if prop.name in node.properties and node.properties[prop.name] != prop.default:
            try:
                checked_value(node.name[:80], prop, node.properties[prop.name], script=True)
            except PropertyError as error:
                raise ValueError(str(error)) from None


def _numbers(value: object) -> Iterator[float]:
    if isinstance(value, float):
        yield value
    elif isinstance(value, (dict, list, tuple)):
        for one in value.values() if isinstance(value, dict) else value:
            yield from _numbers(one)


def _own(node: Node, name: str, value: object) -> Any:
    """The property of a node if it equals a value: objects know by identity which properties have changed."""
    present = node.properties.get(name)
    return present if type(present) is type(value) and present == value else value


def _bone(one: Any, place: int, count: int) -> Bone:
    _check(-1 <= one.parent < place and -1 <= one.leader < count and 0 <= one.axis < 3, f"the bone {place}")
    _check_finite(f"the bone {place}", *one.position, *one.rotation, one.length, one.value)
    return Bone(**{name: getattr(one, name) for name in one.__struct_fields__})


def _check(fits: bool, what: str) -> None:
    if not fits:
        raise ValueError(f"it has {what}")


def _check_finite(what: str, *numbers: float) -> None:
    _check(all(map(math.isfinite, numbers)), f"numbers that are not finite in {what}")


logger = logging.getLogger(__name__)

#: maximum size of all meshes and images of a recording, bytes: a small file can contain as many as it wants
_MOST_BYTES = 4 * LARGEST


def _number(value: Any) -> float:
    if type(value) not in (int, float):
        raise TypeError(f"{value!r:.40} is not a number")
    return value  # type: ignore[no-any-return]


class Description:
    """The description of an object; a call creates it.

    Args:
        name: of the object.
        title: of the attachment.
        position, rotation: where it was spawned, m and rad.
    """

    def __init__(
        self, source: RecordedMade, name: str, title: str, position: tuple[float, ...], rotation: tuple[float, ...]
    ) -> None:
        self._source, self.name, self.title = source, name, title
        self.position, self.rotation = position, rotation

    def __call__(self) -> Newcomer:
        """Return the object.

        Raises:
            RecordingError: the description is damaged.
        """
        return self._source.newcomer(self)


class RecordedMade:
    """The descriptions in a recording.

    Args:
        recording: the recording.
        modules: returns the modules of the project, whose classes the descriptions may name as well.
        exact: whether an object is refused that is not complete, with the classes of all its components.
        all_kinds: whether objects are described as well whose input names a kind, which creates the same object.

    Raises:
        RecordingError: the names are damaged.
    """

    def __init__(
        self,
        recording: Recording,
        modules: Callable[[], Collection[str]],
        *,
        exact: bool = False,
        all_kinds: bool = True,
    ) -> None:
        self._recording, self._modules, self._exact = recording, modules, exact
        self._contents: dict[str, bytes] = {}
        self._size = 0
        self._warnings: set[str] = set()
        self._descriptions: dict[int, dict[str, Description]] = {}
        try:
            for one in recording.messages(recording.topic_numbers(TOPIC)):
                entry = json.loads(decode(TYPE, one.data)["data"])
                name, title = str(entry["name"]), str(entry["description"])
                place, turn = (tuple(map(_number, entry[part])) for part in ("position", "rotation"))
                if entry.get("kind") and not all_kinds:
                    continue
                description = Description(self, name, title, place, turn)
                self._descriptions.setdefault(int(entry["input"]), {})[name] = description
        except (CdrError, ValueError, LookupError, TypeError, RecursionError) as error:
            raise RecordingError(f"{recording.path}: the names of spawned objects are damaged: {error}") from None

    @staticmethod
    def describe_the_scene(recording: Recording) -> bool:
        """Whether a recording describes the scene; those of the inputs alone, and of earlier versions, do not."""
        return SCENE in recording.attachments and OBJECTS in recording.attachments

    def scene(self) -> Scene:
        """Return the scene at the launch.

        Raises:
            RecordingError: the description is damaged.
        """
        unpacking = self._unpacked(OBJECTS)
        if self._exact and (unlike := [*unpacking.omitted, *unpacking.replaced]):
            raise RecordingError(f"the class of {quoted(unlike[0])} is not a part of MORSE")
        for name in unpacking.omitted:
            self._say_once(f"{quoted(name)} is not shown: its class is not a part of MORSE")
        return unpacked_scene(self._attached(SCENE), unpacking)

    @property
    def is_empty(self) -> bool:
        """Whether there are no descriptions: recordings of earlier versions have none."""
        return not self._descriptions

    def check(self) -> None:
        """Create all objects once.

        Raises:
            RecordingError: a description is damaged, or not complete.
        """
        every = {(one.name, one.title): one for some in self._descriptions.values() for one in some.values()}
        for description in every.values():
            self.newcomer(description)

    def after(self, index: int) -> dict[str, Description]:
        """The objects that the input of this number created; -1 for those present at the beginning."""
        return self._descriptions.get(index, {})

    def known(self, index: int) -> dict[str, Description]:
        """The latest description of each name up to an input."""
        descriptions: dict[str, Description] = {}
        for number in sorted(number for number in self._descriptions if number <= index):
            descriptions |= self._descriptions[number]
        return descriptions

    def newcomer(self, description: Description) -> Newcomer:
        """Create the object of a description.

        Raises:
            RecordingError: the description is damaged.
        """
        try:
            unpacking = self._unpacked(description.title)
            if description.name not in [root.name for root in unpacking.roots]:
                raise RecordingError("its description is that of another object")
            if self._exact and (unlike := [*unpacking.omitted, *unpacking.replaced]):
                raise RecordingError(f"the class of {quoted(unlike[0])} is not a part of MORSE or of this project")
        except RecordingError as error:
            self._say_once(f"{quoted(description.name)} is not shown: {error}")
            raise
        for name in unpacking.omitted:
            self._say_once(f"{quoted(name)} is not shown: its class is not a part of MORSE or of this project")
        return Newcomer(unpacking.roots, unpacking.components)

    def _say_once(self, text: str) -> None:
        if text not in self._warnings:
            self._warnings.add(text)
            logger.warning("%s", text)

    def _unpacked(self, name: str) -> Unpacking:
        content = self._attached(name)
        try:
            return Unpacking(content, self._block, self._class_of)
        except RecordingError as error:
            raise RecordingError(f"{self._recording.path}: {error}") from None

    def _attached(self, name: str) -> bytes:
        """The content of an attachment, which is decompressed once."""
        if name not in self._contents:
            content = self._decompressed(name)
            self._size += len(content)
            if self._size > _MOST_BYTES:
                raise RecordingError(f"{self._recording.path}: the meshes are larger than {_MOST_BYTES >> 20} MiB")
            self._contents[name] = content
        return self._contents[name]

    def _decompressed(self, name: str) -> bytes:
        data = self._recording.attachment(name)
        if data is None:
            raise RecordingError(f"{self._recording.path}: the attachment {name[:80]!r} is missing")
        try:
            reader = zstandard.ZstdDecompressor(max_window_size=LARGEST).stream_reader(data)
            content = reader.read(LARGEST + 1)
        except zstandard.ZstdError as error:
            raise RecordingError(f"{self._recording.path}: {name[:80]} is damaged: {error}") from None
        if len(content) > LARGEST:
            raise RecordingError(f"{self._recording.path}: {name[:80]} is larger than {LARGEST >> 20} MiB")
        return content

    def _block(self, digest: str) -> bytes:
        name = f"{BLOCKS}{digest}"
        is_new = name not in self._contents
        block = self._attached(name)
        if is_new and hashlib.sha256(block).hexdigest() != digest:
            del self._contents[name]
            raise RecordingError(f"{self._recording.path}: the block {digest[:80]} is damaged")
        return block

    def _class_of(self, paths: list[str]) -> str | None:
        """The first class that is one of MORSE or of the project: other modules might be programs."""
        for path in paths:
            module = path.rpartition(".")[0]
            if not path.startswith(OWN) and module not in self._modules():
                continue
            try:
                cls = load_class(path)
            except (MorseError, ImportError):
                continue
            if issubclass(cls, (Object, AbstractModifier)) and not getattr(cls, "__abstractmethods__", None):
                return path
        return None
