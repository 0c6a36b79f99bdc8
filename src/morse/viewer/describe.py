"""Conversion of a scene to the description that pages fetch."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, cast

import numpy as np

from morse.scene import PhysicsType, is_shown, slot_materials
from morse.scene.extent import shown_mesh, water_level
from morse.viewer import description as d
from morse.viewer.site import pack_mesh
from morse.viewer.snapshot import MovingNode
from morse.viewer.view_messages import Appearance

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from morse.physics import World
    from morse.scene import Camera, CollisionShape, Display, Image, Light, Material, Mesh, Mist, Node, Scene
    from morse.viewer.site import AssetStore

    Floats = NDArray[np.float64]


# The rigid frames of many nodes at once: `morse.scene.frames` in arrays.


@dataclass(frozen=True, slots=True)
class RigidFrames:
    """The frames of N nodes.

    Attributes:
        positions: (N, 3) metres, in the rigid frame of the parent.
        quaternions: (N, 4) w, x, y, z, from the rigid frame of the node to that of the parent.
        stretches: (N, 3, 3) scale, shear and mirroring of the meshes; exactly the identity if there is none.
    """

    positions: Floats
    quaternions: Floats
    stretches: Floats


def rigid_frames(nodes: Sequence[Node]) -> RigidFrames:
    """The rigid frames of nodes. The list must contain all parents, before their children."""
    index = {id(node): i for i, node in enumerate(nodes)}
    parents = np.array([-1 if node.parent is None else index[id(node.parent)] for node in nodes], dtype=int)
    world = _world_matrices(nodes, parents)
    rotations = _orthonormal(world[:, :3, :3])
    stretches = rotations.transpose(0, 2, 1) @ world[:, :3, :3]
    plain = np.abs(stretches - np.eye(3)).max(axis=(1, 2), initial=0.0) < 1e-9
    stretches[plain] = np.eye(3)
    # relative to the parent; to the world for nodes without a parent
    base = np.where((parents < 0)[:, None, None], np.eye(3), rotations[parents]).transpose(0, 2, 1)
    origins = np.where((parents < 0)[:, None], 0.0, world[parents, :3, 3])
    positions = np.einsum("nij,nj->ni", base, world[:, :3, 3] - origins)
    return RigidFrames(positions, _quaternions(base @ rotations), stretches)


def _world_matrices(nodes: Sequence[Node], parents: NDArray[np.int_]) -> Floats:
    local = _basis_matrices(nodes)
    for i, node in enumerate(nodes):
        if node.parent_inverse is not None:
            local[i] = np.array([list(row) for row in node.parent_inverse]) @ local[i]
    depths = np.zeros(len(nodes), dtype=int)
    for i, parent in enumerate(parents):
        depths[i] = depths[parent] + 1 if parent >= 0 else 0
    for depth in range(1, int(depths.max(initial=0)) + 1):
        rows = np.flatnonzero(depths == depth)
        local[rows] = local[parents[rows]] @ local[rows]
    return local


def _basis_matrices(nodes: Sequence[Node]) -> Floats:
    """(N, 4, 4) from location, rotation (``Rz @ Ry @ Rx``) and scale only."""
    angles = np.array([list(node.rotation_euler) for node in nodes], dtype=float).reshape(-1, 3)
    (cx, cy, cz), (sx, sy, sz) = np.cos(angles).T, np.sin(angles).T
    rows = [
        [cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx],
        [sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx],
        [-sy, cy * sx, cy * cx],
    ]
    scales = np.array([list(node.scale) for node in nodes], dtype=float).reshape(-1, 3)
    matrices = np.zeros((len(nodes), 4, 4))
    matrices[:, :3, :3] = np.array(rows).transpose(2, 0, 1) * scales[:, None, :]
    matrices[:, :3, 3] = np.array([list(node.location) for node in nodes], dtype=float).reshape(-1, 3)
    matrices[:, 3, 3] = 1.0
    return matrices


def _orthonormal(matrices: Floats) -> Floats:
    """Proper rotations: X along the first column, Y in the plane of the first two columns."""
    x = _unit(matrices[:, :, 0], np.array([1.0, 0.0, 0.0]))
    along = matrices[:, :, 1]
    spare = np.where(np.abs(x[:, 1:2]) < 0.9, np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]))
    y = _unit(along - x * _dot(along, x), spare)
    y = _unit(y - x * _dot(y, x), y)
    return np.stack([x, y, np.cross(x, y)], axis=2)


def _dot(a: Floats, b: Floats) -> Floats:
    products: Floats = np.einsum("ni,ni->n", a, b)
    return products[:, None]


def _unit(vectors: Floats, fallback: Floats) -> Floats:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(lengths > 1e-12, vectors / np.where(lengths > 1e-12, lengths, 1.0), fallback)


def _quaternions(rotations: Floats) -> Floats:
    """(N, 4) w, x, y, z of rotation matrices, from the largest component (Shepperd, 1978)."""
    diagonal = np.diagonal(rotations, axis1=1, axis2=2)
    squares = np.concatenate(
        [diagonal.sum(axis=1, keepdims=True), 2 * diagonal - diagonal.sum(axis=1, keepdims=True)], 1
    )
    # outer product of the quaternion with itself, times four
    products = np.zeros((len(rotations), 4, 4))
    products[:, range(4), range(4)] = 1.0 + squares
    r = rotations
    pairs = {
        (0, 1): r[:, 2, 1] - r[:, 1, 2],
        (0, 2): r[:, 0, 2] - r[:, 2, 0],
        (0, 3): r[:, 1, 0] - r[:, 0, 1],
        (1, 2): r[:, 1, 0] + r[:, 0, 1],
        (1, 3): r[:, 0, 2] + r[:, 2, 0],
        (2, 3): r[:, 2, 1] + r[:, 1, 2],
    }
    for (i, j), value in pairs.items():
        products[:, i, j] = products[:, j, i] = value
    rows: Floats = products[np.arange(len(r)), squares.argmax(axis=1)]
    rows /= np.linalg.norm(rows, axis=1, keepdims=True)
    return np.where(rows[:, :1] < 0.0, -rows, rows)


# What pages are told of the objects of a world.


def moving_nodes(world: World) -> list[MovingNode]:
    """The nodes whose poses pages get."""
    return [MovingNode(node, cast('Literal["world", "parent"]', frame)) for node, frame in world.moving_nodes()]


def pictured(world: World, images: dict[str, Image | None]) -> bool:
    """Whether an object whose appearance has changed has another texture than before.

    Args:
        images: textures by name, which are updated.
    """
    images_now = {obj.name: obj.node.image for obj in world.repainted if obj.node.image is not images.get(obj.name)}
    images.update(images_now)
    return bool(images_now)


def appearances(world: World) -> Iterator[Appearance]:
    """The objects whose appearance has changed since the last call."""
    for obj in sorted(world.repainted, key=lambda one: one.name):
        light = None if obj.node.light is None else describe_light(obj.node.light)
        yield Appearance(obj.name, obj.visible, obj.node.color, light)
    world.repainted.clear()


def describe(
    scene: Scene, moving: Sequence[MovingNode], revision: int, asset_store: AssetStore, key: str | None = None
) -> d.SceneDescription:
    """Describe a scene; its geometry and images are added to the asset_store.

    Args:
        key: identifies the world for pages; default: `world_key`.
    """
    nodes = list(scene.nodes())
    index = {id(node): i for i, node in enumerate(nodes)}
    frames = rigid_frames(nodes)
    is_stretched = (frames.stretches != np.eye(3)).any(axis=(1, 2))
    kinds = {id(component.node): component.kind for component in scene.components}
    placed = _placed(scene)
    movers = {id(mover.node): mover.frame for mover in moving}
    visible_meshes = [shown_mesh(node) for node in nodes]
    asset_store.add_meshes(mesh for mesh in visible_meshes if mesh is not None)
    meshes: dict[d.MeshDescription, int] = {}
    materials: dict[d.MaterialDescription, int] = {}
    descriptions = []
    for i, node in enumerate(nodes):
        mesh = visible_meshes[i]
        slots = [] if mesh is None else slot_materials(node, mesh)
        descriptions.append(
            d.NodeDescription(
                name=node.name,
                parent=index.get(id(node.parent), -1),
                position=tuple(frames.positions[i].tolist()),
                quaternion=tuple(frames.quaternions[i].tolist()),
                frame=movers.get(id(node), ""),
                stretch=tuple(frames.stretches[i].ravel().tolist()) if is_stretched[i] else None,
                mesh=-1 if mesh is None else meshes.setdefault(asset_store.mesh(mesh), len(meshes)),
                materials=tuple(materials.setdefault(_material(m, asset_store), len(materials)) for m in slots),
                color=node.color,
                visible=is_shown(node, node.visible),
                light=None if node.light is None else describe_light(node.light),
                camera=None if node.camera is None else _camera(node.camera),
                shapes=[_shape(shape) for shape in node.shapes or ()],
                follows=_follows(node, mesh, index),
                kind=kinds.get(id(node), ""),
                placed_by=placed.get(id(node), ""),
            )
        )
    return d.SceneDescription(
        revision=revision,
        key=world_key(scene) if key is None else key,
        environment=scene.environment,
        nodes=descriptions,
        meshes=list(meshes),
        materials=list(materials),
        moving=[index[id(mover.node)] for mover in moving],
        view=_view(scene),
    )


def _placed(scene: Scene) -> dict[int, str]:
    """The names of the components that place nodes, by the identities of the nodes.

    Nothing carries kinematic bodies: people, doors and cars get their places from their component, which reads its
    own place at the start.
    """
    placed = {id(node): component.name for component in scene.components for node in component.placed}
    owners = {id(component.node): component.name for component in scene.components}
    for node in scene.nodes():
        if node.body.type is PhysicsType.KINEMATIC:
            owner = node.parent
            while owner is not None and id(owner) not in owners:
                owner = owner.parent
            if owner is not None:
                placed[id(node)] = owners[id(owner)]
    return placed


def _follows(node: Node, mesh: Mesh | None, index: Mapping[int, int]) -> list[int] | None:
    """The nodes that the vertices of the packed mesh of a deformable body follow."""
    if node.flex is None or mesh is None:
        return None
    children = [index[id(child)] for child in node.children]
    # vertices have different places
    places = {place.tobytes(): vertex for vertex, place in enumerate(mesh.vertices + np.float32(0.0))}
    return [children[node.flex[places[place.tobytes()]]] for place in pack_mesh(mesh).positions()]


def _material(material: Material, asset_store: AssetStore) -> d.MaterialDescription:
    (r, g, b, a), (er, eg, eb) = map(float, material.color), map(float, material.emission)
    return d.MaterialDescription(
        name=material.name,
        color=(r, g, b, a),
        metallic=material.metallic,
        roughness=material.roughness,
        emission=(er, eg, eb),
        image=None if material.image is None else asset_store.image(material.image),
        shadeless=material.shadeless,
        double_sided=material.double_sided,
    )


def describe_light(light: Light) -> d.LightDescription:
    """The description of a lamp for pages."""
    return d.LightDescription(
        light.type, light.color, light.energy, light.distance, light.spot_size, light.casts_shadow
    )


def _camera(camera: Camera) -> d.CameraDescription:
    return d.CameraDescription(camera.focal_length, camera.clip_start, camera.clip_end)


def _shape(shape: CollisionShape) -> d.ShapeDescription:
    vertices = [] if shape.vertices is None else [(float(x), float(y), float(z)) for x, y, z in shape.vertices]
    return d.ShapeDescription(shape.kind.value, shape.size, shape.position, shape.rotation, vertices)


def _mist(mist: Mist | None) -> d.MistDescription | None:
    if mist is None or not mist.enabled:
        return None
    return d.MistDescription(mist.intensity, mist.start, mist.depth, mist.falloff)


def _display(display: Display) -> d.DisplayDescription:
    plots = [[d.CurveDescription(*curve) for curve in curves] for curves in display.plots]
    return d.DisplayDescription(
        display.rays, display.images, plots, display.follow, display.select, display.overlays, display.panels
    )


def _view(scene: Scene) -> d.ViewDescription:
    view = scene.settings.view
    return d.ViewDescription(
        camera_location=view.camera_location,
        camera_rotation=view.camera_rotation,
        camera_clip=view.camera_clip,
        camera_speed=view.camera_speed,
        camera_focal_length=view.camera_focal_length,
        horizon_color=view.horizon_color,
        ambient_color=view.ambient_color,
        daylight=view.daylight,
        mist=_mist(view.mist),
        water=water_level(scene),
        show_physics=view.show_physics,
        show_framerate=view.show_framerate,
        wireframe=scene.settings.fastmode or view.viewport == "WIREFRAME",
        display=_display(view.display),
    )


def world_key(scene: Scene) -> str:
    """A key that is the same whenever the same script runs."""
    view = scene.settings.view
    parts: Mapping[str, object] = {
        "environment": scene.environment,
        "robots": sorted(robot.name for robot in scene.robots()),
        "camera": (view.camera_location, view.camera_rotation),
        "display": view.display,
    }
    return hashlib.sha256(ascii(parts).encode()).hexdigest()[:16]
