"""Packs the description of an object as plain data; each mesh and image is a block of bytes of its own."""

from __future__ import annotations

import hashlib
from dataclasses import asdict, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from morse.core.classes.classpath import load_class
from morse.core.declarations import fields_of_component
from morse.core.exceptions import MorseError
from morse.core.rows.marks import known_data
from morse.recording.made import form
from morse.scene.scene import Settings

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from morse.core.object import Object
    from morse.core.values import RosMessage
    from morse.scene import CollisionShape, ComponentDeclaration, Image, Material, Mesh, Node, Scene

_encoder = msgspec.msgpack.Encoder()
#: arrays of a mesh and of a shape, by the type of their items
MESH_ARRAYS = {
    "vertices": "<f4",
    "triangles": "<i4",
    "material_index": "<i4",
    "uvs": "<f4",
    "normals": "<f4",
    "follows": "<i4",
}
SHAPE_ARRAYS = {"vertices": "<f8", "heights": "<f8"}
_ATOMS = (type(None), bool, int, float, str)
#: packages whose classes every installation has
OWN = tuple(f"morse.{package}." for package in ("actuators", "core", "modifiers", "plugins", "robots", "sensors"))


class Packing:
    """Packs one description.

    Args:
        roots: the nodes without a parent.
        components: the declarations of the components.
        objects: the components by name, if they exist; the panels of those with classes of a project are described.
        digests: meshes and images of earlier descriptions with their digests, by the id of the object; their blocks are
            left out, and new ones are added.

    Attributes:
        blocks: the bytes of meshes, shapes and images, by their SHA-256.
    """

    def __init__(
        self,
        roots: Sequence[Node],
        components: Sequence[ComponentDeclaration],
        digests: dict[int, tuple[object, str]] | None = None,
        objects: Mapping[str, Any] = MappingProxyType({}),
    ) -> None:
        self._objects = objects
        self.blocks: dict[str, bytes] = {}
        self._digests = {} if digests is None else digests
        nodes = [node for root in roots for node in root.walk()]
        self._places = {node: place for place, node in enumerate(nodes)}
        self._numbers: dict[int, int] = {}
        self._meshes: list[form.MeshForm] = []
        self._materials: list[form.MaterialForm] = []
        self._images: list[form.ImageForm] = []
        self._form = form.DescriptionForm(
            [self._node(node) for node in nodes],
            [self._component(component) for component in components],
            self._meshes,
            self._materials,
            self._images,
        )

    def to_bytes(self) -> bytes:
        """The description without its blocks."""
        return _encoder.encode(self._form)

    def _block(self, data: bytes) -> str:
        digest = hashlib.sha256(data).hexdigest()
        self.blocks[digest] = data
        return digest

    def _once(self, source: object, pack: Callable[[], str]) -> str:
        """The digest of an object, whose block is made for the first description of it."""
        if id(source) not in self._digests:
            # the object is kept, so that no other object gets its id
            self._digests[id(source)] = source, pack()
        return self._digests[id(source)][1]

    def _arrays(self, source: object, kinds: dict[str, str]) -> str:
        arrays: RosMessage = {}
        for name, kind in kinds.items():
            values: np.ndarray | None = getattr(source, name)
            if values is not None:
                arrays[name] = [list(values.shape), np.ascontiguousarray(values, dtype=kind).tobytes()]
        return self._block(_encoder.encode(arrays)) if arrays else ""

    def _node(self, node: Node) -> form.NodeForm:
        inverse = None if node.parent_inverse is None else [v for row in node.parent_inverse for v in row]
        return form.NodeForm(
            name=node.name,
            kind=node.kind,
            # the robot that carries a component is described elsewhere
            parent=-1 if node.parent is None else self._places.get(node.parent, -1),
            location=_triple(node.location),
            rotation_euler=_triple(node.rotation_euler),
            scale=_triple(node.scale),
            body=node.body,
            parent_inverse=inverse,  # type: ignore[arg-type]
            mesh=-1 if node.mesh is None else self._mesh(node.mesh),
            materials=[self._material(one) for one in node.materials],
            light=node.light,
            camera=node.camera,
            properties=_plain_items(node.properties),
            debug=tuple(node.debug),
            visible=node.visible,
            color=None if node.color is None else tuple(map(float, node.color)),  # type: ignore[arg-type]
            source_name=node.source_name,
            shapes=None if node.shapes is None else [self._shape(shape) for shape in node.shapes],
            bones=node.bones,
            bone=node.bone,
            inertial=node.inertial,
            # where the meshes are concerns this machine only
            articulation=node.articulation and replace(node.articulation, meshes=()),
        )

    def _mesh(self, mesh: Mesh) -> int:
        number = self._numbers.get(id(mesh))
        if number is None:
            number = self._numbers[id(mesh)] = len(self._meshes)
            slots = [self._material(one) for one in mesh.materials]
            digest = self._once(mesh, lambda: self._arrays(mesh, MESH_ARRAYS))
            self._meshes.append(form.MeshForm(mesh.name, slots, digest))
        return number

    def _shape(self, shape: CollisionShape) -> form.ShapeForm:
        size = tuple(map(float, shape.size))
        turn: Any = tuple(map(float, shape.rotation))
        return form.ShapeForm(shape.kind, size, _triple(shape.position), turn, self._arrays(shape, SHAPE_ARRAYS))

    def _material(self, material: Material | None) -> int:
        if material is None:
            return -1
        number = self._numbers.get(id(material))
        if number is None:
            number = self._numbers[id(material)] = len(self._materials)
            color: Any = tuple(map(float, material.color))
            self._materials.append(
                form.MaterialForm(
                    material.name,
                    color,
                    float(material.metallic),
                    float(material.roughness),
                    _triple(material.emission),
                    float(material.specular),
                    -1 if material.image is None else self._image(material.image),
                    bool(material.shadeless),
                    bool(material.double_sided),
                )
            )
        return number

    def _image(self, image: Image) -> int:
        number = self._numbers.get(id(image))
        if number is None:
            number = self._numbers[id(image)] = len(self._images)
            digest = self._once(image, lambda: self._block(image.data))
            self._images.append(form.ImageForm(image.name, image.mime, digest))
        return number

    def _component(self, entry: ComponentDeclaration) -> form.ComponentForm:
        return form.ComponentForm(
            self._places[entry.node],
            self._places[entry.robot],
            entry.kind,
            _classes(entry.classpath, self._objects.get(entry.name)),
            entry.frequency,
            entry.level,
            [(modifier.classpath, _plain_items(modifier.options)) for modifier in entry.modifiers],
            entry.options.get("wheels"),  # type: ignore[arg-type]
            entry.options.get("realism"),  # type: ignore[arg-type]
            _panel(component) if (component := self._objects.get(entry.name)) is not None else None,
        )


def scene_to_bytes(scene: Scene) -> bytes:
    """What a scene has besides its nodes and components.

    Raises:
        ValueError: the scene script has set a value of another type.
    """
    return _encoder.encode(
        form.SceneForm(
            scene.environment,
            msgspec.convert(_plain(asdict(scene.settings)), Settings),
            _plain_items(scene.properties),
            [(zone.node.name, zone.type) for zone in scene.zones],
        )
    )


def _panel(component: Object) -> form.PanelForm | None:
    """The panel of a component of a class that only a project has."""
    cls = type(component)
    if f"{cls.__module__}.".startswith(OWN):
        return None
    # nobody keeps them: the sensor goes on to measure when it is read
    data = known_data(component)
    fields = [
        form.FieldForm(
            name, str(field.type), field.doc, field.unit, _bound(field.low), _bound(field.high), _plain(field.default)
        )
        for name, field in fields_of_component(component).items()
        if name in data
    ]
    return form.PanelForm(str(getattr(cls, "_name", cls.__name__)), str(getattr(cls, "_short_desc", "")), fields)


def _bound(value: Any) -> float | None:
    return value if type(value) in (int, float) else None


def _classes(classpath: str, component: object) -> list[str]:
    """The class path of a component, and those of its base classes: another machine may not have all of them."""
    try:
        bases = (load_class(classpath) if component is None else type(component)).__mro__
    except MorseError:
        return [classpath]
    return list(dict.fromkeys([classpath, *(f"{base.__module__}.{base.__qualname__}" for base in bases[:-1])]))


def _triple(values: Sequence[float]) -> form.Triple:
    x, y, z = values
    return float(x), float(y), float(z)


def _plain_items(values: Any) -> RosMessage:
    """The items that a file can hold; objects of a program stay behind."""
    items = {}
    for name, value in values.items():
        plain = _plain(value)
        if isinstance(name, str) and (plain is not None or value is None):
            items[name] = plain
    return items


def _plain(value: object) -> Any:
    """A value of numbers, texts, lists and dictionaries; None for other values."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, np.ndarray) and not value.dtype.hasobject:
        return value.tolist()
    if type(value) in _ATOMS:
        return value
    if isinstance(value, (list, tuple)):
        return [_plain(one) for one in value]
    if isinstance(value, dict):
        return _plain_items(value)
    return None
