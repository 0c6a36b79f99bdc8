"""The shapes of an MJCF model as nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.assets import solids
from morse.assets.mjcf.heights import height_mesh
from morse.assets.mjcf.model import GeomData
from morse.assets.mjcf.skins import pieces_of
from morse.assets.polygons import with_texture_coordinates
from morse.mathutils import Quaternion, Vector
from morse.mathutils.portable import linear_color
from morse.scene import BodySettings, Bounds, CollisionShape, Material, Mesh, Node, NodeKind, PhysicsType, ShapeKind
from morse.scene.mjcf import DEFAULT_CONTACT

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.assets.mjcf.model import FlexData, ModelData, SurfaceData
    from morse.assets.mjcf.skins import Skin
    from morse.assets.mjcf.textures import TextureImages
    from morse.mathutils import Matrix

#: the viewers of MuJoCo hide shapes of this group and of higher groups
_HIDDEN = 3
#: half size of the plate that is shown for a plane: along its sides if it has no limit, and its half thickness, m
_ENDLESS, _PLATE = 50.0, 0.05


def hide_collision_shapes(model: ModelData) -> None:
    """Hide the shapes of a group that only collides, if each of their bodies shows a mesh of a group that does not.

    Many files contain both, and rely on programs that show only one of them.
    """
    bodies_of: dict[int, set[int]] = {}
    solid_groups: set[int] = set()
    shown_groups: set[int] = set()
    visible: set[int] = set()
    for number, body in enumerate(model.bodies[1:], 1):
        for geom in (model.geoms[index] for index in body.geoms):
            (solid_groups if any(geom.masks) else shown_groups).add(geom.group)
            bodies_of.setdefault(geom.group, set()).add(number)
            if geom.kind == "mesh" and not any(geom.masks) and geom.group < _HIDDEN and geom.color[3] > 0.0:
                visible.add(number)
    invisible = {group for group in solid_groups - shown_groups if bodies_of[group] <= visible}
    for geom in model.geoms:
        if geom.group in invisible and any(geom.masks):
            geom.group = _HIDDEN


def shape_node(geom: GeomData, name: str, images: TextureImages) -> Node:
    """Return the node of a shape; it is solid if the shape collides with anything."""
    node = _plain_node(geom, name)
    surface = geom.surface
    if surface is None or not node.visible:
        return node
    image = images.image(surface.texture) if surface.texture >= 0 else None
    node.materials = [
        Material(
            name,
            linear_color(geom.color),
            # without the reflections that metal needs, MuJoCo does not draw it either
            roughness=surface.roughness if surface.roughness >= 0.0 else 1.0 - 0.8 * min(surface.shininess, 1.0),
            specular=min(surface.specular, 1.0),
            emission=linear_color([min(surface.emission * part, 1.0) for part in geom.color])[:3],
            image=image,
        )
    ]
    if image is not None and node.mesh is not None and node.mesh.uvs is None:
        repeat = (1.0, 1.0) if images.is_cube(surface.texture) else surface.repeat
        is_uniform = surface.uniform and not images.is_cube(surface.texture)
        node.mesh = with_texture_coordinates(node.mesh, repeat, node.scale if is_uniform else None)
    return node


def _plain_node(geom: GeomData, name: str) -> Node:
    node = Node(name, NodeKind.MESH, source_name=name, location=list(geom.position))
    node.rotation_euler = list(Quaternion(geom.quaternion).to_euler())
    node.visible = geom.group < _HIDDEN and geom.color[3] > 0.0
    node.materials = [Material(name, linear_color(geom.color))]
    is_solid = any(geom.masks)
    if is_solid:
        node.body = BodySettings(type=PhysicsType.STATIC)
    else:
        node.shapes = []
    if geom.mesh is not None:
        vertices, triangles = geom.mesh
        node.mesh = Mesh(name, vertices, triangles, np.zeros(len(triangles), dtype=np.int32), geom.uvs)
        node.body.bounds = Bounds.CONVEX_HULL
        return node
    if geom.heights is not None:
        node.mesh = height_mesh(name, geom.size, geom.heights)
        if is_solid:
            node.shapes = [CollisionShape(ShapeKind.HEIGHT_FIELD, geom.size, heights=geom.heights)]
        return node
    kind, size = (ShapeKind.BOX, plane_box(geom.size)) if geom.kind == "plane" else (ShapeKind(geom.kind), geom.size)
    node.mesh, scale = solids.primitive(kind, size)
    node.scale = list(scale)
    if is_solid:
        node.shapes = [CollisionShape(kind, size)]
    if geom.kind == "plane":
        # the top of a plate
        axes = Quaternion(geom.quaternion).to_matrix()
        node.location = [place - scale[2] * row[2] for place, row in zip(geom.position, axes, strict=True)]
    return node


#: corners of the cross-section of a rope, in radii, and the three squares of which it consists
_OCTAHEDRON = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], np.float64)
_SQUARES = ((0, 2, 1, 3), (2, 4, 3, 5), (4, 0, 5, 1))


def flex_node(flex: FlexData, name: str, place: Matrix, images: TextureImages) -> Node:
    """Return the node of a deformable body, whose children are its vertices.

    Args:
        place: 4x4, the frame of its parent in the world of the file.
    """
    triangles, points = flex.triangles, flex.points
    follows = np.arange(len(points), dtype=np.int32)
    offsets = np.zeros((1, 3))
    if triangles.shape[1] == 2:
        # three bands along a rope, so that it is seen from all sides
        offsets = flex.radius * _OCTAHEDRON
        follows = np.repeat(follows, 6)
        ends = 6 * triangles
        quads = [
            np.stack([ends[:, 0] + one, ends[:, 0] + other, ends[:, 1] + other, ends[:, 1] + one], axis=1)
            for square in _SQUARES
            for one, other in zip(square, (*square[1:], square[0]), strict=True)
        ]
        corners = np.concatenate(quads)
        triangles = np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]]).astype(np.int32)
    centre = points.mean(axis=0)
    inverse = place.inverted()
    vertices = (points[:, None] - centre + offsets).reshape(-1, 3).astype(np.float32)
    geom = _piece(name, flex.color, flex.group, (vertices, triangles), flex.surface, flex.uvs)
    node = shape_node(geom, name, images)
    node.location = list(inverse @ Vector(centre.tolist()))
    # it has the axes of the world
    node.rotation_euler = list(inverse.to_3x3().to_euler())
    assert node.mesh is not None
    node.mesh.follows, node.mesh.normals = follows, _smooth(vertices, triangles)
    for number, point in enumerate(points - centre):
        node.attach(Node(f"{name}_{number}", location=point.tolist()))
    return node


def _smooth(vertices: NDArray[np.float32], triangles: NDArray[np.int32]) -> NDArray[np.float32]:
    """Return the normals (T, 3, 3) of the corners of triangles: the means around the vertices."""
    corners = vertices[triangles].astype(np.float64)
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros((len(vertices), 3))
    for corner in range(3):
        np.add.at(normals, triangles[:, corner], faces)
    normals /= np.maximum(np.sqrt((normals**2).sum(axis=1, keepdims=True)), 1e-30)
    smooth: NDArray[np.float32] = normals[triangles].astype(np.float32)
    return smooth


def plane_box(size: tuple[float, ...]) -> tuple[float, float, float]:
    """Return the half sizes of the plate that is shown for a plane; a size of 0 is no limit."""
    return size[0] or _ENDLESS, size[1] or _ENDLESS, _PLATE


def add_skins(model: ModelData, skins: Sequence[Skin]) -> list[str]:
    """Add the pieces of skins to the shapes of the bodies; return what is left out, one sentence each."""
    numbers = {body.name: index for index, body in enumerate(model.bodies)}
    lost = []
    for skin in skins:
        unknown = next((bone.body for bone in skin.bones if bone.body not in numbers), None)
        if unknown is not None:
            lost.append(f"the skin '{skin.name:.60}' is left out: there is no body '{unknown:.60}'")
            continue
        color, surface = model.materials.get(skin.material, ((0.5, 0.5, 0.5, 1.0), None))
        for bone, vertices, triangles, uvs in pieces_of(skin):
            if surface is None or surface.texture < 0:
                uvs = None
            name = f"{skin.name}_{bone.body}"
            geom = _piece(name, skin.color or color, skin.group, (vertices, triangles), surface, uvs)
            model.bodies[numbers[bone.body]].geoms.append(len(model.geoms))
            model.geoms.append(geom)
    return lost


def _piece(
    name: str,
    color: tuple[float, ...],
    group: int,
    mesh: tuple[NDArray[np.float32], NDArray[np.int32]],
    surface: SurfaceData | None,
    uvs: NDArray[np.float32] | None,
) -> GeomData:
    place, turn = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
    return GeomData(name, "mesh", (), place, turn, color, group, DEFAULT_CONTACT, (0, 0), mesh, None, surface, uvs)
