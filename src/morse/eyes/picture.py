"""Draws pictures of a `mujoco.MjvScene` with the renderer of scenes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from morse.eyes.geoms import (
    PLANE,
    Instances,
    Look,
    instances_of,
    looks_of,
    textures_of_materials,
)
from morse.eyes.layers import layers_of, reach_of
from morse.eyes.light import ShadowMaps, Surroundings, classic, lights_of, of_scenes, without_shadows
from morse.eyes.shadows import casters_of, planes_of
from morse.eyes.store import SKY, store_of
from morse.kernel.drawing.arrays import CAMERA
from morse.kernel.drawing.composing import Composition, depths_of, objects_of
from morse.kernel.drawing.native import Kept, NativeDrawer, drawer
from morse.mathutils.rotations import cross
from morse.rendering.meshes import spheres_around

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.eyes.light import Lit, ShadowMap
    from morse.eyes.store import Prepared
    from morse.kernel.drawing.arrays import Light, Pictures, Poses
    from morse.kernel.drawing.composing import Box

#: names of the looks
LOOKS = ("classic", "morse")
#: opacity from which on a surface hides what is behind it
OPAQUE = 0.995
#: opacity of a plane from behind, in MuJoCo
_FROM_BEHIND = 0.3
#: texels along the side of a shadow map: at least, and at most
_FEWEST_TEXELS, _MOST_TEXELS = 256, 1024
#: from the camera to the border of infinite planes, in units of the far plane: without a sky, and in front of MuJoCo's
BEYOND, _BEFORE_SKY = 1.06, 0.7


class View(NamedTuple):
    """A camera of a scene.

    Attributes:
        eye: (3,) m.
        axes: (3, 3) right, down and forward, in rows.
        fx, fy: pixels; of orthographic cameras, pixels per m.
        cx, cy: pixels; the centre of the first pixel is at 0.5.
        near, far: m, along the axis.
        parallel: whether it is orthographic.
        width, height: pixels.
    """

    eye: NDArray[np.float64]
    axes: NDArray[np.float64]
    fx: float
    fy: float
    cx: float
    cy: float
    near: float
    far: float
    parallel: bool
    width: int
    height: int

    def row(self, *, color: bool) -> NDArray[np.void]:
        """(1,) `CAMERA`."""
        numbers = self.fx, self.fy, self.cx, self.cy, self.near, self.far, self.axes.ravel(), self.eye, 1.0, 0.0
        return np.array([(*numbers, self.width, self.height, 0, color, 0, 0, self.parallel)], CAMERA)

    def cut(self, box: tuple[int, int, int, int]) -> View:
        """The part of the picture from a column and a row to before others."""
        x0, y0, x1, y1 = box
        return self._replace(cx=self.cx - x0, cy=self.cy - y0, width=x1 - x0, height=y1 - y0)

    def mirrored(self, plane: NDArray[np.float64]) -> View:
        """The view from behind a mirror (normal and offset), with columns from right to left."""
        normal = plane[:3]
        eye = self.eye - 2 * (float((self.eye * normal).sum()) - plane[3]) * normal
        axes = self.axes - 2 * (self.axes * normal).sum(axis=1)[:, None] * normal
        axes[0] *= -1
        return self._replace(eye=eye, axes=axes, cx=self.width - self.cx)


def view_of(scene: Any, width: int, height: int) -> View:
    """The view of a scene, between its two cameras.

    Raises:
        ValueError: the camera is not finite, or has no size.
    """
    one, other = scene.camera[:2]
    eye, forward, up = (
        [(a + b) / 2 for a, b in zip(getattr(one, name).tolist(), getattr(other, name).tolist(), strict=True)]
        for name in ("pos", "forward", "up")
    )
    names = ("frustum_top", "frustum_bottom", "frustum_near", "frustum_far", "frustum_center", "frustum_width")
    top, bottom, near, far, centre, half = (
        (float(getattr(one, name)) + float(getattr(other, name))) / 2 for name in names
    )
    length = math.sqrt(sum(part * part for part in forward))
    finite = all(map(math.isfinite, (*eye, *forward, *up, top, bottom, near, far, centre, half)))
    if not finite or length < 1e-9 or not top > bottom or not 0 < near < far:
        raise ValueError(
            f"The camera of the scene cannot be drawn: its position is {eye}, its direction "
            f"{forward}, its frustum is from {bottom:g} to {top:g} between {near:g} and {far:g} m. Call "
            "update_scene first, with a state whose numbers are finite."
        )
    forward = [part / length for part in forward]
    along = sum(a * b for a, b in zip(up, forward, strict=True))
    up = [a - along * b for a, b in zip(up, forward, strict=True)]
    length = max(math.sqrt(sum(part * part for part in up)), 1e-9)
    up = [part / length for part in up]
    down = height / (top - bottom)
    # cameras with a size of their sensor fill any picture with it: pixels are then not square
    across = width / (2 * half) if half > 0 else down
    cx, cy = width / 2 - centre * across, top * down
    parallel = bool(one.orthographic)
    focal = 1.0 if parallel else near
    axes = np.array([cross(forward, up), [-part for part in up], forward])
    return View(np.array(eye), axes, across * focal, down * focal, cx, cy, near, far, parallel, width, height)


class Geoms(Protocol):
    """The geoms of a scene; see `morse.eyes.geoms.GeomArray`."""

    def now(self) -> NDArray[np.void]:
        """(N,) the geoms that are used."""


class Artist:
    """Draws scenes of one model; what it keeps only saves time.

    Args:
        model: `mujoco.MjModel`.
        look: one of `LOOKS`.
        texels: along the side of shadow maps.
    """

    def __init__(self, model: Any, look: str, texels: int) -> None:
        self._model, self.is_plain = model, look == "classic"
        self._store = store_of(model, plain=self.is_plain)
        self._kinds = np.array(model.tex_type, np.int32)
        self._kinds_of_flexes = np.array(getattr(model, "flex_dim", ()), np.int32)
        self._skies = np.flatnonzero(self._kinds == SKY)
        finest = max(int(model.vis.quality.shadowsize), 1)
        #: texels along the side of shadow maps, and of those of MuJoCo
        self.texels = min(max(texels, _FEWEST_TEXELS), _MOST_TEXELS, finest), finest
        self._maps = ShadowMaps(*self.texels)
        self.linewidth = float(getattr(model.vis.global_, "linewidth", 1.0))
        self._look = Look(plain=self.is_plain, of_materials=textures_of_materials(model))
        self._of: bytes | None = None
        self._instances: Instances | None = None
        self._drawer: NativeDrawer | None = None
        #: the last opaque parts, and what they depend on
        self._solid: tuple[Instances, bytes, NDArray[np.int32]] | None = None
        #: what the last depths and ids depend on, and these: the picture of colours has them, too
        self._surface: tuple[object, NDArray[np.float32], NDArray[np.int32]] | None = None
        #: the last pictures of cameras that stand
        self._kept: dict[object, tuple[object, Kept]] = {}

    def depths(self, scene: Any, geoms: Geoms, view: View) -> NDArray[np.float32]:
        """The depth (H, W), m, of all geoms as opaque ones."""
        depths, _, _ = self._surfaces(scene, geoms, view)
        # the background is at the far plane
        return depths_of(depths.reshape(view.height, view.width), view.far)

    def objects(self, scene: Any, geoms: Geoms, view: View) -> NDArray[np.int32]:
        """The ids (H, W, 2), id and type of the objects, of all geoms as opaque ones."""
        _, shown, instances = self._surfaces(scene, geoms, view)
        return objects_of(shown.reshape(view.height, view.width), instances.ids)

    def segments(self, scene: Any, geoms: Geoms, view: View) -> NDArray[np.int32]:
        """The numbers ``segid`` of geoms (H, W), -1 for none."""
        _, shown, instances = self._surfaces(scene, geoms, view)
        table = np.append(geoms.now()["segid"][instances.geoms], -1).astype(np.int32)
        return np.asarray(table[shown.reshape(view.height, view.width)])

    def _surfaces(
        self, scene: Any, geoms: Geoms, view: View
    ) -> tuple[NDArray[np.float32], NDArray[np.int32], Instances]:
        """The depths (H W,), 0 for none, and the instances (H W,), -1 for none."""
        g = geoms.now()
        instances, draw = self._arranged(g, scene)
        key = self._key(scene, g, view)
        if self._surface is None or self._surface[0] != key:
            away = turned_away(g, view)
            poses = instances.poses(g[None], (view,), BEYOND * view.far, self.linewidth)
            parts = instances.parts
            if away.any():
                parts = parts[~away[instances.geoms][instances.owner]]
            draw.arrange(parts, maps=instances.maps)
            kept = self._memories("surfaces", instances, parts)
            pictures = draw.draw(view.row(color=False), poses, of_scenes([], [], NOTHING), 1, kept)
            self._surface = key, pictures.depth, pictures.ids
        return *self._surface[1:], instances

    def colors(self, scene: Any, geoms: Geoms, view: View) -> NDArray[np.uint8]:
        """The colours (H, W, 3) of a scene; geoms that are not finite are not drawn."""
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            return self._colors(scene, geoms.now(), view)

    def _colors(self, scene: Any, g: NDArray[np.void], view: View) -> NDArray[np.uint8]:
        instances, draw = self._arranged(g, scene)
        reach = self.reach(scene.flags, view)
        poses = instances.poses(g[None], (view,), reach, self.linewidth)
        opacity, behind = opacity_of(g, view, instances)
        clear = opacity < OPAQUE
        solid = self._opaque(instances, clear)
        lights, around = lights_of(scene), self.around(instances, g, scene.flags, reach)
        if not scene.flags[SHADOW]:
            lights = without_shadows(lights)
        maps = self._shadows(g, instances, draw, lights, poses, view)
        make = classic if self.is_plain else of_scenes
        light = make(lights, maps, around)

        def drawn(parts: NDArray[np.int32], own: View, light: Light = light, name: object = None) -> Pictures:
            draw.arrange(parts)
            kept = () if name is None else self._memories(name, instances, parts)
            return draw.draw(own.row(color=True), poses, light, 5, kept)

        first = drawn(solid, view, name="picture")
        # in depths and ids, planes reach to the far plane
        if not clear.any() and not (len(instances.infinite) and reach < view.far):
            self._surface = self._key(scene, g, view), first.depth, first.ids
        layers = (
            layers_of(g, np.flatnonzero(clear & (opacity > 0.0)), opacity, view, self.linewidth) if clear.any() else []
        )
        picture = Composition(first, view.width, view.height, exact=bool(layers))
        mirrors = (g["reflectance"] > 0) & (g["type"] == PLANE) & ~clear & ~behind
        if scene.flags[REFLECTION] and mirrors.any():
            dim = make(without_shadows(lights), [None] * len(lights), NOTHING)
            for number in np.flatnonzero(mirrors):
                chosen = instances.geoms == number
                box = picture.extent(chosen)
                if box is not None:
                    # a mirror shows neither itself nor planes from behind
                    mirrored = view.mirrored(_plane_of(g[number]))
                    unseen = from_behind(g, mirrored.eye)
                    unseen[number] = True
                    others = solid[~unseen[instances.geoms[solid[:, 1]]]]
                    if not len(others):
                        continue
                    image = drawn(others, mirrored.cut(mirrored_box(box, view)), dim, ("mirror", int(number)))
                    picture.reflect(image, box, chosen, float(g["reflectance"][number]))
        for numbers, box in layers:
            chosen = np.isin(instances.geoms, numbers)
            image = drawn(np.concatenate([instances.parts[chosen[instances.owner]], solid]), view.cut(box))
            # MuJoCo draws translucent surfaces twice
            picture.cover(image, box, chosen, 1 - (1 - float(opacity[numbers[0]])) ** 2)
        return picture.codes()

    def _memories(self, name: object, instances: Instances, parts: NDArray[np.int32]) -> tuple[Kept, ...]:
        """What is kept of the last picture of a purpose; nothing if it may differ in more than poses and lights."""
        if instances.prepared.moving:
            return ()
        key = instances.maps.tobytes(), parts.tobytes()
        kept = self._kept.get(name)
        if kept is None or kept[0] != key:
            kept = self._kept[name] = key, Kept()
        return (kept[1],)

    def _opaque(self, instances: Instances, clear: NDArray[np.bool_]) -> NDArray[np.int32]:
        """The parts of the geoms that are not clear."""
        key = clear.tobytes()
        if self._solid is None or self._solid[0] is not instances or self._solid[1] != key:
            self._solid = instances, key, instances.parts[~clear[instances.geoms][instances.owner]]
        return self._solid[2]

    def _key(self, scene: Any, g: NDArray[np.void], view: View) -> tuple[object, ...]:
        """All that depths and ids of geoms depend on whose instances are those of the present picture."""
        vertices = (scene.skinvert.tobytes(), scene.flexface.tobytes()) if self._of_moving() else ()
        numbers = (*view.eye, *view.axes.ravel(), view.fx, view.fy, view.cx, view.cy, view.near, view.far)
        return (self._of, g["pos"].tobytes(), g["mat"].tobytes(), numbers, view.width, view.height, *vertices)

    def _of_moving(self) -> bool:
        return self._instances is not None and bool(self._instances.prepared.moving)

    def instances_of(self, g: NDArray[np.void], scene: Any) -> Instances:
        """The instances of the geoms of a scene."""
        faces = scene.flexfacenum if len(self._kinds_of_flexes) else ()
        return instances_of(g, self._store, self._kinds, self._look, faces)

    def _arranged(self, g: NDArray[np.void], scene: Any) -> tuple[Instances, NativeDrawer]:
        """The instances of the geoms of a scene, which change seldom, and what draws them."""
        looks = looks_of(g)
        if self._instances is not None and looks != self._of and self._instances.resize(g):
            self._of = looks
        if self._instances is None or looks != self._of:
            instances = self.instances_of(g, scene)
            if self._drawer is None or self._instances is None or self._instances.prepared is not instances.prepared:
                self._drawer = drawer_of(instances.prepared)
            slots = np.arange(len(instances.materials), dtype=np.int32)
            self._drawer.arrange(instances.parts, slots, instances.materials, instances.maps)
            self._of, self._instances = looks, instances
            self._kept.clear()
        assert self._drawer is not None
        if self._instances.prepared.moving:
            self._move(scene)
        return self._instances, self._drawer

    def _move(self, scene: Any) -> None:
        """Take over the vertices of skins and flexes."""
        assert self._drawer is not None
        assert self._instances is not None
        drawing, prepared = self._drawer.drawing, self._instances.prepared
        begin = len(drawing.clusters)
        for key, (place, numbers) in prepared.moving.items():
            points, normals, uvs = _skin(scene, self._model, key[1]) if key[0] == "skin" else _flex(scene, key[1])
            vertices = drawing.vertices[place]
            vertices["p"], vertices["n"], vertices["uv"] = points[numbers], normals[numbers], uvs[numbers]
            shape = prepared.shapes[key]
            own = slice(shape.first, shape.first + shape.size)
            firsts = drawing.clusters[own, 0] - place.start
            if len(firsts):
                drawing.spheres[own] = spheres_around(np.nan_to_num(vertices["p"], posinf=0.0, neginf=0.0), firsts)
                drawing.guards[own], drawing.levels[own, :4] = drawing.spheres[own, 3], drawing.spheres[own]
            begin = min(begin, shape.first)
        self._drawer.reshape(begin)

    def _shadows(
        self,
        g: NDArray[np.void],
        instances: Instances,
        draw: NativeDrawer,
        lights: list[Lit],
        poses: Poses,
        view: View,
    ) -> list[ShadowMap | None]:
        """The shadow maps of lights."""
        maps: list[ShadowMap | None] = [None] * len(lights)
        casting, planes = instances.casting, instances.planes
        if not casting.any() or not any(light.casts for light in lights):
            return maps
        parts, owner = instances.parts, instances.geoms[instances.owner]
        seen, makes = seen_of(g[None, ~planes], (view,)), casters_of(g[None], instances, (view,))
        for number, n in enumerate(n for n, light in enumerate(lights) if light.casts):
            light = lights[n]
            casters = makes(light.place[None], light.towards[None], light.directional)
            scale = self.scale_of_maps(directional=light.directional)
            chosen = parts[casters.casting[0][owner]]
            maps[n] = self._maps.map_of(number, light, draw, chosen, poses, seen, casters, scale)
        return maps

    def scale_of_maps(self, *, directional: bool) -> float:
        """See `ShadowMaps.map_of`."""
        settings = self._model.vis.map
        return (
            float(settings.shadowclip) * float(self._model.stat.extent) if directional else float(settings.shadowscale)
        )

    def reach(self, flags: Any, view: View) -> float:
        """From the camera to the border of infinite planes in pictures of colours, m."""
        sky = self.is_plain and len(self._skies) and flags[_SKYBOX]
        return (_BEFORE_SKY if sky else BEYOND) * view.far

    def around(self, instances: Instances, g: NDArray[np.void], flags: Any, reach: float) -> Surroundings:
        """What a scene has besides geoms and lights."""
        model = self._model
        rgba, settings, extent = model.vis.rgba, model.vis.map, float(model.stat.extent)
        sky = -1
        if len(self._skies) and flags[_SKYBOX]:
            sky = int(instances.prepared.textures[self._skies[0]])
        plane = None
        if flags[_HAZE] and sky >= 0 and len(instances.infinite):
            plane = _plane_of(g[instances.infinite[0]])
        fog = None
        if flags[_FOG]:
            fog = (np.array(rgba.fog[:3], float), settings.fogstart * extent, settings.fogend * extent)
        return Surroundings(sky, np.array(rgba.haze[:3], float), float(settings.haze), reach, plane, fog)


def from_behind(g: NDArray[np.void], eye: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(..., G) which geoms are planes that are seen from behind, from eyes (..., 3)."""
    way = (eye[..., None, :] - g["pos"]) * g["mat"].reshape(*g.shape, 3, 3)[..., 2]
    return np.asarray((g["type"] == PLANE) & (way.sum(axis=-1) < 0))


def opacity_of(g: NDArray[np.void], view: View, instances: Instances) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """(G,) the opacity of geoms, and which are planes from behind."""
    opacity, behind = np.array(instances.opacity), from_behind(g, view.eye)
    opacity[behind] *= _FROM_BEHIND
    opacity[turned_away(g, view)] = 0.0
    return opacity, behind


def turned_away(g: NDArray[np.void], view: View) -> NDArray[np.bool_]:
    """(G,) which geoms are planes that the rays of an orthographic camera meet from behind: they are not drawn."""
    if not view.parallel:
        return np.zeros(len(g), np.bool_)
    facing = (g["mat"].reshape(-1, 3, 3)[:, :, 2] * view.axes[2]).sum(axis=1)
    return np.asarray((g["type"] == PLANE) & (facing > -1e-6) & ~from_behind(g, view.eye))


def drawer_of(prepared: Prepared) -> NativeDrawer:
    """A renderer of shapes, which shares memory with others unless the shapes move."""
    if not prepared.moving:
        return drawer(prepared.drawing, prepared.drawer)
    names = ("vertices", "spheres", "guards", "levels", "closed")
    own = prepared.drawing._replace(**{name: getattr(prepared.drawing, name).copy() for name in names})
    for key in prepared.moving:
        shape = prepared.shapes[key]
        first, last = own.clusters[shape.first], own.clusters[shape.first + shape.size - 1]
        own.closed[first[2] : last[2] + last[3]] = 0
    return drawer(own)


def _skin(scene: Any, model: Any, number: int) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    """(V, 3) vertices, (V, 3) normals and (V, 2) texture coordinates of a skin."""
    first, count = int(scene.skinvertadr[number]), int(scene.skinvertnum[number])
    part = slice(first, first + count)
    start = int(model.skin_texcoordadr[number])
    uvs = np.zeros((count, 2), np.float32)
    if start >= 0:
        uvs = model.skin_texcoord.reshape(-1, 2)[start : start + count]
    return scene.skinvert.reshape(-1, 3)[part], scene.skinnormal.reshape(-1, 3)[part], uvs


def _flex(scene: Any, number: int) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    """The same of the corners of the triangles of a flex; triangles that are not used are at one point."""
    first, count = int(scene.flexfaceadr[number]), int(scene.flexfacenum[number])
    part, used = slice(first, first + count), int(scene.flexfaceused[number])
    points = scene.flexface.reshape(-1, 3, 3)[part].copy()
    points[used:] = points[:1, :1] if len(points) else 0.0
    normals = scene.flexnormal.reshape(-1, 3, 3)[part]
    uvs = scene.flextexcoord.reshape(-1, 3, 2)[part]
    return points.reshape(-1, 3), normals.reshape(-1, 3), uvs.reshape(-1, 2)


# rendering flags (`mujoco.mjtRndFlag`)
SHADOW, _WIREFRAME, REFLECTION, _ADDITIVE, _SKYBOX, _FOG, _HAZE = range(7)
NOTHING = Surroundings(-1, np.ones(3), 0.3, 1.0, None, None)


def seen_of(g: NDArray[np.void], views: Sequence[View]) -> NDArray[np.float64]:
    """(N, 8, 3) the corners of the part of N views in which geoms (N, G) may be, with what is right behind them, m."""
    reach = reach_of(g)
    eyes, axes = np.array([view.eye for view in views]), np.array([view.axes for view in views])
    near, far = np.array([(view.near, view.far) for view in views]).T
    depth = ((g["pos"] - eyes[:, None]) * axes[:, None, 2]).sum(axis=-1)
    least, most = near, far
    if g.size:
        least = np.minimum(np.maximum((depth - reach).min(axis=1), near), 0.99 * far)
        most = np.minimum(np.maximum((depth + reach).max(axis=1) * 1.5, 1.01 * least), far)
    sides = [
        (
            (-view.cx / view.fx, (view.width - view.cx) / view.fx),
            (-view.cy / view.fy, (view.height - view.cy) / view.fy),
        )
        for view in views
    ]
    x, y = np.array(sides).swapaxes(0, 1)[..., None]
    right, down, forward = axes.swapaxes(0, 1)[:, :, None]
    aside = (x[:, :, None] * right[:, None] + y[:, None] * down[:, None]).reshape(-1, 4, 3)
    parallel = np.array([view.parallel for view in views])
    ends = [
        np.where(parallel, 1.0, depth)[:, None, None] * aside + depth[:, None, None] * forward
        for depth in (least, most)
    ]
    return np.asarray(eyes[:, None] + np.concatenate(ends, axis=1), np.float64)


def _plane_of(geom: np.void) -> NDArray[np.float64]:
    """(4,) the normal and the offset of a plane."""
    return np.asarray(planes_of(np.array([geom]))[0], np.float64)


def mirrored_box(box: Box, view: View) -> Box:
    """The pixels of a part in a picture whose columns are from right to left."""
    return view.width - box[2], box[1], view.width - box[0], box[3]
