"""Random triangles, lamps and cameras, as arrays."""

import numpy as np
from kernel_worlds import rotations

from morse.kernel.drawing.arrays import CAMERA, LAMP, MATERIAL, MIRRORED, SOLID, TEXTURE, VERTEX, Drawing, Light, Poses


def pyramid(rng, size):
    """A texture with all its levels."""
    texels, firsts, at = [], [], 0
    width, height = size
    while True:
        firsts.append(at)
        level = rng.integers(0, 2**32, (height, width), dtype=np.uint32).view(np.int32)
        texels.append(np.concatenate([level, level[:, :1]], axis=1).ravel())
        at += (width + 1) * height
        if (width, height) == (1, 1):
            break
        width, height = max(width // 2, 1), max(height // 2, 1)
    row = np.zeros(1, TEXTURE)
    row["width"], row["height"], row["levels"] = *size, len(firsts)
    row["first"][0, : len(firsts)] = firsts
    return np.concatenate(texels), row


def _levels(rng, spheres):
    """Some clusters are drawn at all distances, some only near the cameras, or far from them."""
    errors = np.array([(0, np.inf), (0, 0.04), (0.03, np.inf)])[rng.integers(0, 3, len(spheres))]
    return np.column_stack([spheres, errors]).astype(np.float32)


class RandomDrawing:
    """Some clusters of triangles, each instantiated a few times."""

    def __init__(self, seed, clusters=3, triangles=12, instances=5):
        self.rng = rng = np.random.default_rng(seed)
        count = clusters * triangles
        vertices = np.zeros(3 * count, VERTEX)
        vertices["p"] = rng.normal(size=(3 * count, 3)) * 0.8
        vertices["n"] = rng.normal(size=(3 * count, 3))
        vertices["uv"] = rng.normal(size=(3 * count, 2)) * 2
        corners = rng.integers(0, 3 * triangles, (count, 3))
        texels, textures = pyramid(rng, (8, 4))
        materials = np.zeros(6, MATERIAL)
        materials["color"] = rng.uniform(0, 1, (6, 4))
        materials["emission"] = rng.uniform(0, 0.1, (6, 3))
        materials["metallic"], materials["roughness"] = rng.uniform(0, 1, (2, 6))
        materials["texture"] = [-1, -1, -1, 0, 0, 0]
        # shadeless, two-sided, one-sided, with holes, translucent
        materials["flags"] = [0, 3, 2, 2, 2 | 4, 2 | 8]
        first = np.arange(clusters)
        numbers = np.column_stack([first * 3 * triangles, np.full(clusters, 3 * triangles), first * triangles,
                                   np.full(clusters, triangles)])  # fmt: skip
        points = vertices["p"].reshape(clusters, -1, 3)
        spheres = np.column_stack([np.zeros((clusters, 3)), np.linalg.norm(points, axis=2).max(axis=1) * 1.01])
        parts = np.column_stack([rng.integers(0, clusters, instances), np.arange(instances), np.arange(instances) * 2,
                                 rng.integers(0, 2, (instances, 2)) @ [MIRRORED, SOLID]])  # fmt: skip
        self.drawing = Drawing(
            vertices,
            np.column_stack([corners, rng.integers(0, 2, count)]).astype(np.int32),
            numbers.astype(np.int32),
            spheres.astype(np.float32),
            parts.astype(np.int32),
            rng.integers(0, 6, 2 * instances).astype(np.int32),
            materials,
            texels,
            textures,
            rng.integers(0, 3, count).astype(np.uint8),
            (spheres[:, 3] * rng.uniform(1, 2, clusters)).astype(np.float32),
            _levels(rng, spheres),
        )
        turns = rotations(rng, instances)
        turns[parts[:, 3] & MIRRORED != 0] *= -1
        models = np.concatenate([turns, rng.normal(size=(instances, 3, 1))], axis=2)
        self.poses = Poses(models.reshape(-1, 12).astype(np.float32), turns.reshape(-1, 9).astype(np.float32))

    def light(self, shadow=True, near=False):
        rng = self.rng
        lamps = np.zeros(4, LAMP)
        lamps["kind"] = [0, 1, 2, 3]
        lamps["place"] = rng.normal(size=(4, 3)) * 3
        lamps["towards"] = rng.normal(size=(4, 3))
        lamps["towards"] /= np.linalg.norm(lamps["towards"], axis=1)[:, None]
        lamps["color"], lamps["ground"] = rng.uniform(0, 2, (2, 4, 3))
        lamps["decay"], lamps["outer"], lamps["inner"] = 0.3, [1, 0, 0.5, 0], [0, 0, 0.9, 0]
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        sun = np.zeros(16, np.float32)
        sun[:12] = np.column_stack([axes * [[10], [10], [1]], [30, 25, 0]]).ravel()
        sun[12] = 0.1
        sky = rng.uniform(0, 1, 20).astype(np.float32)
        sky[15:18] = 2.0, 3.0, float(sky[19] < 0.3)
        made = np.full((50, 60), -1e30, np.float32) if shadow else None
        if not near:
            return Light(lamps, sky, sun, made)
        finer = sun.copy()
        finer[:8], finer[12] = sun[:8] * 2.5, sun[12] / 2.5
        lamp = np.zeros(16, np.float32)
        to = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        matrix = np.array([[20, 0, 18], [0, 20, 22], [0, 0, 1]]) @ to
        lamp[:12] = np.column_stack([matrix, matrix @ (to[2] * 3)]).ravel()
        lamp[12] = 0.05
        depths = -rng.uniform(1, 5, (45, 37)).astype(np.float32)
        return Light(lamps, sky, sun, made, finer, np.full((70, 55), -1e30, np.float32), lamp, depths)

    def cameras(self, sizes=((40, 33), (64, 20)), near=0.1, far=8.0, color=True):
        rows = np.zeros(len(sizes), CAMERA)
        for row, (width, height) in zip(rows, sizes, strict=True):
            row["fx"] = row["fy"] = width * self.rng.uniform(0.4, 1.5)
            row["cx"], row["cy"] = width / 2, height / 2
            row["near"], row["far"], row["width"], row["height"] = near, far, width, height
            row["axes"] = rotations(self.rng, 1)[0].ravel()
            row["eye"] = -3 * row["axes"][6:9] + self.rng.normal(size=3) * 0.3
            row["color"] = row["normals"] = color
            row["tolerance"] = 0.02
            row["exposure"] = self.rng.uniform(0.5, 2.0)
        return rows
