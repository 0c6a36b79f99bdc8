"""Conversion of a scene to the description that pages fetch."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

import numpy as np

from morse.scene import is_shown, slot_materials
from morse.scene.water import water_level
from morse.scene.wrapping import shown_mesh
from morse.viewer import description as d
from morse.viewer.frames import rigid_frames

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from morse.scene import Camera, CollisionShape, Display, Light, Material, Mist, Scene
    from morse.viewer.asset_store import AssetStore
    from morse.viewer.snapshot import MovingNode


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
                kind=kinds.get(id(node), ""),
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
