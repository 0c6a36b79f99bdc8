"""Small worlds for images, built by hand."""

import math

import numpy as np

from morse.assets import solids
from morse.assets.collision import resolve_shapes
from morse.physics.world import World
from morse.rendering import Lens, Renderer
from morse.scene import BodySettings, Light, Material, Mesh, Node, NodeKind, PhysicsType, Scene

FAR = 50.0


def body(
    name, mesh, location=(0, 0, 0), *, scale=(1, 1, 1), rotation=(0, 0, 0), material=None, kind=PhysicsType.STATIC
):
    node = Node(name, kind=NodeKind.MESH, mesh=mesh, body=BodySettings(type=kind))
    node.location[:], node.scale[:], node.rotation_euler[:] = location, scale, rotation
    node.materials = [material or Material(name)]
    return node


def box(name, location, half, **more):
    return body(name, solids.cube(), location, scale=half, **more)


def ball(name, location, radius, **more):
    return body(name, solids.ico_sphere(5), location, scale=[radius] * 3, **more)


def floor(height=0.0, half=30.0, **more):
    """A thin slab with its upper side at that height."""
    return box("Floor", (0, 0, height - 0.05), (half, half, 0.05), **more)


def lamp(kind, towards, energy=1.0, location=(0, 0, 0)):
    """A lamp that shines along -Z: its +Z points ``towards`` the source of the light."""
    node = Node("Lamp", kind=NodeKind.LIGHT, light=Light(type=kind, energy=energy))
    x, y, z = np.array(towards) / np.linalg.norm(towards)
    node.rotation_euler[:] = (math.acos(z), 0.0, math.atan2(x, -y))
    node.location[:] = location
    assert np.allclose([node.world_matrix()[i][2] for i in range(3)], (x, y, z))
    return node


def triangles(points, faces, uvs=None, normals=None, index=None):
    faces = np.array(faces, np.int32).reshape(-1, 3)
    slots = np.zeros(len(faces), np.int32) if index is None else np.array(index, np.int32)
    return Mesh("Made", np.array(points, np.float32), faces, slots, uvs, normals)


class Tripod:
    """A mount for a camera that looks at a point; X to the right, Y down."""

    def __init__(self, position, target, up=(0.0, 0.0, 1.0)):
        forward = np.subtract(target, position) / np.linalg.norm(np.subtract(target, position))
        right = np.cross(forward, up)
        right /= np.linalg.norm(right)
        self.position = np.array(position, float)
        self.axes = np.column_stack([right, np.cross(forward, right), forward])

    def world_pose(self):
        return tuple(self.position), tuple(self.axes.ravel())

    def project(self, points, lens):
        """(N, 2) pixels and (N,) depths of points, by the pinhole model."""
        own = (np.atleast_2d(points) - self.position) @ self.axes
        return np.column_stack(
            [lens.fx * own[:, 0] / own[:, 2] + lens.cx, lens.fy * own[:, 1] / own[:, 2] + lens.cy]
        ), own[:, 2]


class Studio:
    """A world and its renderer."""

    def __init__(self, *nodes, **view):
        self.scene = Scene(environment="empty")
        self.scene.roots = list(nodes)
        for name, value in view.items():
            setattr(self.scene.settings.view, name, value)
        resolve_shapes(self.scene)
        self.world = World(self.scene)
        self.renderer = Renderer(self.world)

    def look(self, tripod, lens=None, **more):
        request = self.renderer.request(tripod, lens or Lens.of_focal_length(160, 120, 32.0, 0.1, FAR), **more)
        self.renderer.serve([request])
        return request.picture

    def number(self, picture, name):
        return next(i for i, node in enumerate(picture.nodes) if node.name == name)
