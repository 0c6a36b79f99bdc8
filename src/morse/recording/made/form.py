"""The form in which the description of an object is written to a file."""

# the annotations are evaluated, so that damaged descriptions are refused
from typing import Any, get_type_hints

import msgspec

from morse.mathutils.rotations import Rotation9
from morse.scene import Articulation, BodySettings, Bone, Camera, Inertial, Light, NodeKind, ShapeKind
from morse.scene.articulation import JointDynamics
from morse.scene.component import RealismModel
from morse.scene.scene import Settings

Triple = tuple[float, float, float]
Sixteen = tuple[
    float, float, float, float,
    float, float, float, float,
    float, float, float, float,
    float, float, float, float,
]  # fmt: skip

_HINTS = get_type_hints(Bone, localns={"Rotation9": Rotation9, "JointDynamics": JointDynamics})
#: `morse.scene.Bone`, with annotations that exist at run time
BoneForm: Any = msgspec.defstruct("BoneForm", [(name, _HINTS[name]) for name in Bone.__dataclass_fields__])


class ImageForm(msgspec.Struct, forbid_unknown_fields=True):
    """See `morse.scene.Image`; ``data`` is the digest of the file."""

    name: str
    mime: str
    data: str


class MaterialForm(msgspec.Struct, forbid_unknown_fields=True):
    """See `morse.scene.Material`; ``image`` is an index, or -1."""

    name: str
    color: tuple[float, float, float, float]
    metallic: float
    roughness: float
    emission: Triple
    specular: float
    image: int
    shadeless: bool
    double_sided: bool


class MeshForm(msgspec.Struct, forbid_unknown_fields=True):
    """See `morse.scene.Mesh`; ``materials`` are indices, or -1; ``data`` is the digest of the arrays."""

    name: str
    materials: list[int]
    data: str


class ShapeForm(msgspec.Struct, forbid_unknown_fields=True):
    """See `morse.scene.CollisionShape`; ``data`` is the digest of the arrays."""

    kind: ShapeKind
    size: tuple[float, ...]
    position: Triple
    rotation: Rotation9
    data: str


class NodeForm(msgspec.Struct, forbid_unknown_fields=True, omit_defaults=True):
    """See `morse.scene.Node`; ``parent``, ``mesh`` and ``materials`` are indices, or -1."""

    name: str
    kind: NodeKind
    parent: int
    location: Triple
    rotation_euler: Triple
    scale: Triple
    body: BodySettings
    parent_inverse: Sixteen | None = None
    mesh: int = -1
    materials: list[int] = msgspec.field(default_factory=list)
    light: Light | None = None
    camera: Camera | None = None
    properties: dict[str, Any] = msgspec.field(default_factory=dict)
    debug: tuple[str, ...] = ()
    visible: bool = True
    color: tuple[float, float, float, float] | None = None
    source_name: str | None = None
    shapes: list[ShapeForm] | None = None
    bones: tuple[BoneForm, ...] = ()
    bone: str = ""
    inertial: Inertial | None = None
    articulation: Articulation | None = None


class FieldForm(msgspec.Struct, forbid_unknown_fields=True):
    """A data field of a component, as a panel shows it; ``value`` is that of the declaration."""

    name: str
    type: str
    doc: str
    unit: str
    low: float | None
    high: float | None
    value: Any


class PanelForm(msgspec.Struct, forbid_unknown_fields=True):
    """What the panel of a component shows, for a class that another machine may not have."""

    title: str
    doc: str
    fields: list[FieldForm]


class ComponentForm(msgspec.Struct, forbid_unknown_fields=True):
    """See `morse.scene.ComponentDeclaration`; nodes are indices.

    Attributes:
        classes: class paths: of its class, and of the classes from which that is derived.
        modifiers: class paths and options.
        wheels: names of the nodes of the wheels of a robot; None for a component without wheels.
        realism: see `morse.scene.component.RealismModel`.
        panel: of a component whose class is not one of MORSE.
    """

    node: int
    robot: int
    kind: str
    classes: list[str]
    frequency: float | None
    level: str | None
    modifiers: list[tuple[str, dict[str, Any]]]
    wheels: list[str] | None
    realism: RealismModel | None
    panel: PanelForm | None = None


class DescriptionForm(msgspec.Struct, forbid_unknown_fields=True):
    """The description of an object with all its parts."""

    nodes: list[NodeForm]
    components: list[ComponentForm]
    meshes: list[MeshForm]
    materials: list[MaterialForm]
    images: list[ImageForm]


class SceneForm(msgspec.Struct, forbid_unknown_fields=True):
    """What a scene has besides its nodes and components; see `morse.scene.Scene`.

    Attributes:
        zones: name of the node and type of each zone.
    """

    environment: str
    settings: Settings
    properties: dict[str, Any]
    zones: list[tuple[str, str]]
