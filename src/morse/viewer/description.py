"""The description of a world that a page fetches once: everything that does not change with the ticks."""

from __future__ import annotations

from msgspec import Struct

from morse.scene.scene import Overlay, PanelPlace  # noqa: TC001 (msgspec reads it)

# What a page knows of the components: their data, properties and services.


class FieldDescription(Struct, frozen=True):
    """A data field of a component with its limits ``low`` and ``high``; values beyond ``reached`` have no effect."""

    name: str
    type: str = ""
    doc: str = ""
    unit: str = ""
    low: float | None = None
    high: float | None = None
    reached: tuple[float, float] | None = None


class PropertyDescription(Struct, frozen=True):
    """A property of a component with its present value; ``choices`` are its allowed values, if they are few."""

    name: str
    type: str = ""
    doc: str = ""
    value: object = None
    choices: list[object] | None = None
    unit: str = ""
    low: float | None = None
    high: float | None = None


class SettingDescription(Struct, frozen=True):
    """A method of the builder by which a component is set up.

    Attributes:
        method: ``frequency``, ``level``, ``alter``, ``add_stream``, …
        name: the first argument, of methods that may be called for several; empty for others.
        doc: what it does.
        arguments: the others by name; that with an empty name is the first one.
        later: whether it counts from the next start of the scene on only.
    """

    method: str
    name: str = ""
    doc: str = ""
    arguments: list[PropertyDescription] = []
    later: bool = False


class ArgumentDescription(Struct, frozen=True):
    """An argument of a service; ``default`` is in Python notation, None if the argument is required."""

    name: str
    type: str = ""
    default: str | None = None


class ServiceDescription(Struct, frozen=True):
    """A service of a component."""

    name: str
    doc: str = ""
    arguments: list[ArgumentDescription] = []
    asynchronous: bool = False


class ComponentDescription(Struct, frozen=True):
    """A robot, sensor or actuator.

    Attributes:
        name: fully qualified; also the name of its node in the scene.
        kind: ``robot``, ``external_robot``, ``sensor`` or ``actuator``.
        robot: the name of its robot.
        title: name of its class, for display.
        frequency: Hz.
        pictured: whether it has a picture to show: an image, or what its method ``shown`` makes of its data.
    """

    name: str
    kind: str
    robot: str
    title: str = ""
    doc: str = ""
    frequency: float = 0.0
    level: str = ""
    active: bool = True
    pictured: bool = False
    data: list[FieldDescription] = []
    properties: list[PropertyDescription] = []
    services: list[ServiceDescription] = []


Vector3 = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


class MeshDescription(Struct, frozen=True):
    """Location of a geometry: `morse.viewer.site.PackedMesh` at an offset (bytes) of a file."""

    url: str
    offset: int
    vertices: int
    indices: int
    textured: bool
    groups: tuple[tuple[int, int, int], ...]


class MaterialDescription(Struct, frozen=True):
    """Like `morse.scene.Material`; ``image`` is the address of its texture."""

    name: str
    color: tuple[float, float, float, float]
    metallic: float
    roughness: float
    emission: Vector3
    image: str | None
    shadeless: bool
    double_sided: bool


class LightDescription(Struct, frozen=True):
    """As `morse.scene.Light`."""

    type: str
    color: Vector3
    energy: float
    distance: float
    spot_size: float
    casts_shadow: bool


class CameraDescription(Struct, frozen=True):
    """As `morse.scene.Camera`."""

    focal_length: float
    clip_start: float
    clip_end: float


class ShapeDescription(Struct, frozen=True):
    """As `morse.scene.CollisionShape`."""

    kind: str
    size: tuple[float, ...]
    position: Vector3
    rotation: tuple[float, ...]
    vertices: list[Vector3] = []


class NodeDescription(Struct, frozen=True):
    """A node.

    Attributes:
        parent: index of its parent in the list of nodes, or -1.
        position: in the rigid frame of the parent, metres.
        quaternion: w, x, y, z, in the rigid frame of the parent.
        frame: frame of its poses in the snapshots, ``world`` or ``parent``; empty if it has none.
        stretch: row-major 3x3 matrix for the vertices of the mesh, or None.
        mesh: index, or -1.
        materials: indices, by slot.
        follows: of a deformable body, the node that each vertex of its mesh follows; else None.
        kind: kind of the component that the node belongs to: ``robot``, ``sensor``, ...; empty if none.
        placed_by: name of the component that places it when the simulation starts, or in each tick; empty if none.
    """

    name: str
    parent: int = -1
    position: Vector3 = (0.0, 0.0, 0.0)
    quaternion: Quaternion = (1.0, 0.0, 0.0, 0.0)
    frame: str = ""
    stretch: tuple[float, ...] | None = None
    mesh: int = -1
    materials: tuple[int, ...] = ()
    color: tuple[float, float, float, float] | None = None
    visible: bool = True
    light: LightDescription | None = None
    camera: CameraDescription | None = None
    shapes: list[ShapeDescription] = []
    follows: list[int] | None = None
    kind: str = ""
    placed_by: str = ""


class MistDescription(Struct, frozen=True):
    """As `morse.scene.Mist`."""

    intensity: float
    start: float
    depth: float
    falloff: str


class CurveDescription(Struct, frozen=True):
    """A field of a component in a diagram."""

    component: str
    field: str


class DisplayDescription(Struct, frozen=True):
    """As `morse.scene.Display`."""

    rays: tuple[str, ...]
    images: tuple[str, ...]
    plots: list[list[CurveDescription]]
    follow: str
    select: str
    overlays: tuple[Overlay, ...]
    panels: tuple[PanelPlace, ...] | None


class ViewDescription(Struct, frozen=True):
    """The view settings of the script: see `morse.scene.ViewSettings`; ``water`` is the height of its surface, m."""

    camera_location: Vector3
    camera_rotation: Vector3
    camera_clip: tuple[float, float]
    camera_speed: float
    camera_focal_length: float
    horizon_color: Vector3 | None
    ambient_color: Vector3 | None
    daylight: float
    mist: MistDescription | None
    water: float | None
    show_physics: bool
    show_framerate: bool
    wireframe: bool
    display: DisplayDescription


class SceneDescription(Struct, frozen=True):
    """A world.

    Attributes:
        moving: indices of the moving nodes, in the order of the poses.
        key: identifies the world, so that the page can store the camera pose for each.
    """

    revision: int
    key: str
    environment: str
    nodes: list[NodeDescription]
    meshes: list[MeshDescription]
    materials: list[MaterialDescription]
    moving: list[int]
    view: ViewDescription
