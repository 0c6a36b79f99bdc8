"""Analytic meshes, counter-clockwise when viewed from outside, and solids to test the resulting shapes."""

import math

import mujoco
import numpy as np

from morse.scene.body import ShapeKind


def rotation(roll, pitch, yaw):
    """Rz @ Ry @ Rx."""
    (a, b, c), (s, t, u) = np.cos([roll, pitch, yaw]), np.sin([roll, pitch, yaw])
    return (
        np.array([[c, -u, 0], [u, c, 0], [0, 0, 1]])
        @ np.array([[b, 0, t], [0, 1, 0], [-t, 0, b]])
        @ np.array([[1, 0, 0], [0, a, -s], [0, s, a]])
    )


def cells(filled, xs, ys, zs):
    """The surface of the filled cells (X, Y, Z) of a grid whose lines lie at xs, ys and zs."""
    filled = np.pad(np.asarray(filled, bool), 1)
    lines = [np.asarray(line, float) for line in (xs, ys, zs)]
    index, vertices, triangles = {}, [], []

    def corner(at):
        if at not in index:
            index[at] = len(vertices)
            vertices.append([lines[k][at[k]] for k in range(3)])
        return index[at]

    for cell in np.argwhere(filled):
        for axis in range(3):
            for side in (0, 1):
                beyond = cell.copy()
                beyond[axis] += 1 if side else -1
                if filled[tuple(beyond)]:
                    continue
                u, v = (axis + 1) % 3, (axis + 2) % 3
                ring = []
                for du, dv in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    at = cell - 1
                    at[axis] += side
                    at[u] += du
                    at[v] += dv
                    ring.append(corner(tuple(at.tolist())))
                a, b, c, d = ring if side else ring[::-1]
                triangles += [(a, b, c), (a, c, d)]
    return np.array(vertices, float).reshape(-1, 3), np.array(triangles, int).reshape(-1, 3)


def box(half, centre=(0, 0, 0), turn=None, cuts=1):
    """A box of cuts x cuts quads per side."""
    x, y, z = half
    vertices, triangles = cells(np.ones((cuts, cuts, cuts)), *(np.linspace(-h, h, cuts + 1) for h in (x, y, z)))
    return vertices @ (np.eye(3) if turn is None else turn).T + np.asarray(centre), triangles


def icosphere(radius, rounds, centre=(0, 0, 0)):
    """A repeatedly subdivided icosahedron, on the sphere."""
    g = (1 + math.sqrt(5)) / 2
    vertices = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g),
                (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]  # fmt: skip
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
             (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11),
             (6, 2, 10), (8, 6, 7), (9, 8, 1)]  # fmt: skip
    vertices = [np.array(v) / np.linalg.norm(v) for v in vertices]
    for _ in range(rounds):
        middle, finer = {}, []

        def between(a, b, middle=middle):
            key = (min(a, b), max(a, b))
            if key not in middle:
                middle[key] = len(vertices)
                m = vertices[a] + vertices[b]
                vertices.append(m / np.linalg.norm(m))
            return middle[key]

        for a, b, c in faces:
            d, e, f = between(a, b), between(b, c), between(c, a)
            finer += [(a, d, f), (b, e, d), (c, f, e), (d, e, f)]
        faces = finer
    return np.array(vertices) * radius + np.asarray(centre), np.array(faces)


def prism(polygon, low, high):
    """A convex polygon (N, 2), counter-clockwise, extruded along Z."""
    count = len(polygon)
    flat = np.asarray(polygon, float)
    vertices = np.vstack([np.column_stack([flat, np.full(count, low)]), np.column_stack([flat, np.full(count, high)])])
    triangles = [(0, i + 1, i) for i in range(1, count - 1)]
    triangles += [(count, count + i, count + i + 1) for i in range(1, count - 1)]
    for i in range(count):
        j = (i + 1) % count
        triangles += [(i, j, count + j), (i, count + j, count + i)]
    return vertices, np.array(triangles)


def cylinder(radius, half, sides, centre=(0, 0, 0), turn=None):
    """A prism with many sides, along Z before its rotation."""
    around = np.arange(sides) * (2 * math.pi / sides)
    vertices, triangles = prism(radius * np.column_stack([np.cos(around), np.sin(around)]), -half, half)
    return vertices @ (np.eye(3) if turn is None else turn).T + np.asarray(centre), triangles


def joined(*meshes):
    """Several meshes as one."""
    vertices, triangles, count = [], [], 0
    for points, faces in meshes:
        vertices.append(points)
        triangles.append(np.asarray(faces) + count)
        count += len(points)
    return np.vstack(vertices), np.vstack(triangles)


def loose(mesh):
    """The same mesh without shared vertices, as in STL files."""
    vertices, triangles = mesh
    return vertices[triangles].reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)


def seen_from_inside(mesh):
    """The same surface with the opposite orientation."""
    vertices, triangles = mesh
    return vertices, triangles[:, ::-1]


class Solid:
    """Parts in the format of the physics engine."""

    PROBE = 1e-4

    def __init__(self, parts):
        spec = mujoco.MjSpec()
        for number, part in enumerate(parts):
            shape = part.to_shape()
            if shape.kind is ShapeKind.CONVEX:
                spec.add_mesh(
                    name=str(number),
                    uservert=np.asarray(shape.vertices, np.float32).ravel(),
                    inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX,
                )
                spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=str(number))
                continue
            quaternion = np.zeros(4)
            mujoco.mju_mat2Quat(quaternion, np.array(shape.rotation, float))
            kind = getattr(mujoco.mjtGeom, f"mjGEOM_{shape.kind.name}")
            size = np.zeros(3)
            size[: len(shape.size)] = shape.size
            spec.worldbody.add_geom(type=kind, size=size, pos=shape.position, quat=quaternion)
        body = spec.worldbody.add_body(mocap=True)
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[self.PROBE, 0, 0])
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)

    def clearance(self, point, farthest=100.0):
        """Distance from a point to the solid, m; 0 or negative inside."""
        self.data.mocap_pos[0] = point
        mujoco.mj_kinematics(self.model, self.data)
        probe = self.model.ngeom - 1
        return self.PROBE + min(
            mujoco.mj_geomDistance(self.model, self.data, probe, geom, farthest, None) for geom in range(probe)
        )

    def is_solid(self, point):
        """True inside."""
        return self.clearance(point) < self.PROBE / 2
