"""Shading; the twin of ``c/draw_pixels.c``, ``draw_surface.h`` and ``draw_texture.h``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.drawing.arrays import ENCODED, SAMPLES, SHADELESS
from tests.kernel.twins.light import code, dot, light_of_code, lit, mixed, sky_in, tone, unit, within
from tests.kernel.twins.normals import along, normals_at

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.kernel.drawing.arrays import Drawing, Light, Poses
    from tests.kernel.twins.project import Projected

    Floats = NDArray[np.float32]

_ONE = np.float32(1)
#: see ``ALIKE``, ``APART`` and ``ONE_LIGHT``
_ALIKE, _APART = np.float32(0.95), np.float32(0.125)
_LIGHT_SHIFT = 16
_SQUARED_TEXEL = np.float32(1) / np.float32(1046529.0)
_ONE_LIGHT = np.float32(4095.0 * (1 << _LIGHT_SHIFT))


def paint(
    drawing: Drawing,
    camera: NDArray[np.void],
    poses: Poses,
    light: Light,
    projected: Projected,
    visible: NDArray[np.int32],
) -> NDArray[np.uint8]:
    """(N, 4) the colours of pixels that show triangles (samples, N)."""
    samples, pixels = visible.shape
    total = np.full((pixels, 3), 1 << (_LIGHT_SHIFT - 1), np.int32)
    column = (np.arange(pixels) % int(camera["width"])).astype(np.float32)
    row = (np.arange(pixels) // int(camera["width"])).astype(np.float32)
    kinds = _kinds(drawing, poses, projected, visible, column, row)
    for sample in range(samples):
        new = kinds[sample] == sample
        share = (kinds[:, new] == sample).sum(axis=0).astype(np.float32) / np.float32(samples)
        x, y = _place(samples, sample, column[new], row[new])
        color = _colors(drawing, camera, poses, light, projected, visible[sample, new], x, y)
        total[new] += (within(color, 0, 1) * (share * _ONE_LIGHT)[:, None]).astype(np.int32)
    codes = ENCODED[total >> _LIGHT_SHIFT]
    return np.concatenate([codes, np.full((pixels, 1), 255, np.uint8)], axis=1)


def _place(samples: int, sample: int, column: Floats, row: Floats) -> tuple[Floats, Floats]:
    """The position of a sample of each pixel in the image."""
    shift = np.array(SAMPLES[samples][sample], np.float32)
    return column + np.float32(0.5) + shift[0], row + np.float32(0.5) + shift[1]


def _kinds(
    drawing: Drawing, poses: Poses, projected: Projected, visible: NDArray[np.int32], column: Floats, row: Floats
) -> NDArray[np.intp]:
    """(samples, N) the first sample of the pixel with which each sample is shaded."""
    samples = len(visible)
    kinds = np.zeros(visible.shape, np.intp)
    flat = [_Flat(drawing, poses, projected, visible[n], *_place(samples, n, column, row)) for n in range(samples)]
    for sample in range(1, samples):
        free = np.ones(visible.shape[1], bool)
        kinds[sample] = sample
        for other in range(sample):
            is_same = free & (visible[other] == visible[sample])
            kinds[sample, is_same] = kinds[other, is_same]
            free &= ~is_same
        for other in range(sample):
            is_same = free & (kinds[other] == other) & flat[other].is_like(flat[sample])
            kinds[sample, is_same] = other
            free &= ~is_same
    return kinds


class _Flat:
    """The planes of surfaces at samples (N,)."""

    def __init__(
        self, d: Drawing, poses: Poses, projected: Projected, who: NDArray[np.int32], x: Floats, y: Floats
    ) -> None:
        count = len(who)
        self.material, self.textured = np.full(count, -1), np.zeros(count, bool)
        self.inverse = np.zeros(count, np.float32)
        self.normal = [np.zeros(count, np.float32) for _ in range(3)]
        self.whole, self.uv = np.ones(count, np.float32), np.zeros((2, count), np.float32)
        self.across, self.down = np.zeros((2, 3, count), np.float32)
        solid = np.flatnonzero(who >= 0)
        if not len(solid):
            return
        number, w, e = who[solid], projected.w[who[solid]], projected.e[who[solid]]
        x, y = x[solid], y[solid]
        self.material[solid] = projected.material[number]
        self.textured[solid] = d.materials["texture"][projected.material[number]] >= 0
        self.inverse[solid] = w[:, 0] * x + w[:, 1] * y + w[:, 2]
        for part, values in zip(self.normal, normals_at(d, poses, projected, number, x, y), strict=True):
            part[solid] = values
        uv = projected.vertices(d, number)["uv"]
        ones = np.ones_like(uv[..., 0])
        for b, values in enumerate((uv[..., 0], uv[..., 1], ones)):
            p = [along(e, values, a) for a in range(3)]
            self.across[b, solid], self.down[b, solid] = p[0], p[1]
            at = p[0] * x + p[1] * y + p[2]
            if b == 2:
                self.whole[solid] = at
            else:
                self.uv[b, solid] = at
        self.uv = self.uv / self.whole

    def is_like(self, other: _Flat) -> NDArray[np.bool_]:
        """(N,) whether samples of a material are nearly on one plane, and the texture continues."""
        cosine = dot(self.normal, other.normal)
        most = dot(self.normal, self.normal) * dot(other.normal, other.normal)
        near = np.abs(self.inverse - other.inverse) < _APART * self.inverse
        same = (self.material == other.material) & (self.material >= 0)
        plane = same & near & (cosine > 0) & (cosine * cosine > _ALIKE * _ALIKE * most)
        return np.asarray(plane & (~self.textured | (self._continues(other, 0) & self._continues(other, 1))))

    def _continues(self, other: _Flat, axis: int) -> NDArray[np.bool_]:
        at = self.uv[axis]
        change = [np.abs(p[axis] - at * p[2]) for p in (self.across, self.down)]
        return np.asarray(np.abs(other.uv[axis] - at) * np.abs(self.whole) <= change[0] + change[1])


def _colors(
    d: Drawing,
    k: NDArray[np.void],
    poses: Poses,
    light: Light,
    projected: Projected,
    who: NDArray[np.int32],
    x: Floats,
    y: Floats,
) -> Floats:
    """(N, 3) linear light of samples that show triangles ``who``, -1 for the sky."""
    none = who < 0
    r, sky = k["axes"], light.sky
    cx, cy = (x - k["cx"]) * (_ONE / k["fx"]), (y - k["cy"]) * (_ONE / k["fy"])
    direction = unit([r[i] * cx + r[3 + i] * cy + r[6 + i] for i in range(3)])
    coded = sky[17] > 0
    sky_color = [part * k["exposure"] for part in sky_in(sky, direction)]
    if not coded:
        sky_color = tone(sky_color)
    result = np.stack(sky_color, axis=1)
    solid = np.flatnonzero(~none)
    if not len(solid):
        return result
    x, y, number = x[solid], y[solid], who[solid]
    e, w = projected.e[number], projected.w[number]
    material = d.materials[projected.material[number]]
    v = projected.vertices(d, number)
    inverse = w[:, 0] * x + w[:, 1] * y + w[:, 2]
    normal = unit(normals_at(d, poses, projected, number, x, y))
    base = [material["color"][:, i].copy() for i in range(3)]
    textured = np.flatnonzero(material["texture"] >= 0)
    if len(textured):
        factor = _texture(d, material["texture"][textured], e[textured], v["uv"][textured], x[textured], y[textured])
        for i in range(3):
            base[i][textured] = base[i][textured] * factor[i]
    eye = k["eye"]
    cx, cy, depth = cx[solid], cy[solid], _ONE / inverse
    ray = [r[i] * cx + r[3 + i] * cy + r[6 + i] for i in range(3)]
    place = [eye[i] + ray[i] * depth for i in range(3)]
    toward = [direction[i][solid] * np.float32(-1) for i in range(3)]
    shown = code if coded else np.asarray
    own = [shown(part) for part in base]
    color = lit(light, place, normal, toward, own, material["metallic"], material["roughness"])
    color = [color[i] + shown(material["emission"][:, i]) for i in range(3)]
    if sky[16] > 0:
        t = within((depth - sky[15]) * (_ONE / sky[16]), 0, 1)
        color = mixed(color, [shown(sky[i : i + 1]) for i in range(3)], t * t * (np.float32(3) - np.float32(2) * t))
    plain = material["flags"] & SHADELESS != 0
    color = [part * k["exposure"] for part in color]
    color = [light_of_code(within(part, 0, 1)) for part in color] if coded else tone(color)
    result[solid] = np.where(plain[:, None], np.stack(base, axis=1), np.stack(color, axis=1))
    return result


def _texture(d: Drawing, numbers: NDArray[np.int32], e: Floats, uv: Floats, x: Floats, y: Floats) -> list[Floats]:
    """Three colours (N,) of textures at points of triangles."""
    t = d.textures[numbers]
    whole = [e[:, 0, a] + e[:, 1, a] + e[:, 2, a] for a in range(3)]
    inverse = _ONE / (whole[0] * x + whole[1] * y + whole[2])
    at, across, down = [], [], []
    for b in range(2):
        p = [along(e, uv[:, :, b], a) for a in range(3)]
        value = (p[0] * x + p[1] * y + p[2]) * inverse
        at.append(value)
        across.append((p[0] - value * whole[0]) * inverse)
        down.append((p[1] - value * whole[1]) * inverse)
    w, h = t["width"].astype(np.float32), t["height"].astype(np.float32)
    ux, vx, uy, vy = across[0] * w, across[1] * h, down[0] * w, down[1] * h
    px, py = (_lesser(a * a + b * b, np.float32(1e8)) for a, b in ((ux, vx), (uy, vy)))
    # the squares of both sides; the ratio of the sides, rounded down from 0.6, and its reciprocal
    longer, shorter = np.where(px > py, px, py), _lesser(px, py)
    shorter = np.where(shorter > _ONE, shorter, _ONE)
    du, dv = np.where(px < py, down[0], across[0]), np.where(px < py, down[1], across[1])
    above = [longer > shorter * _squared(limit) for limit in (1.6, 2.6, 3.6)]
    looks = _ONE + sum(part.astype(np.float32) for part in above)
    each = np.select(above[::-1], [np.float32(0.25), np.float32(1.0 / 3), np.float32(0.5)], _ONE)
    size = np.sqrt(longer) * each
    size = np.where(size > _ONE, size, _ONE).astype(np.float32)
    bits = size.view(np.int32)
    level, most = (bits >> 23) - 127, t["levels"] - 1
    last = level >= most
    level = np.where(last, most, level)
    fraction = ((bits & 0x7FFFFF) | 0x3F800000).view(np.float32)
    blend = np.where(last, np.float32(0), within(np.float32(2) * fraction - np.float32(2.5), 0, 1))
    after = np.where(last, level, level + 1)
    rows = np.arange(len(t))
    total = [np.zeros(len(t), np.float32) for _ in range(3)]
    # the texels of the second level are twice as large: half as many samples
    half = np.where(above[1], np.float32(0.5), _ONE)
    for which, number, part, weight in ((level, looks, each, _ONE - blend), (after, _ONE / half, half, blend)):
        wide, high = np.maximum(t["width"] >> which, 1), np.maximum(t["height"] >> which, 1)
        share = weight * _SQUARED_TEXEL * part
        for n in range(4):
            s = (np.float32(n) + np.float32(0.5)) * part - np.float32(0.5)
            coverage = np.where(number > n, share, np.float32(0))
            _bilinear(d.texels, t["first"][rows, which], wide, high, at[0] + s * du, at[1] + s * dv, coverage, total)
    return total


def _squared(a: float) -> np.float32:
    return np.float32(a) * np.float32(a)


def _lesser(a: Floats, b: np.float32 | Floats) -> Floats:
    return np.where(a < b, a, b).astype(np.float32)


def _bilinear(
    texels: NDArray[np.int32],
    first: NDArray[np.int32],
    width: NDArray[np.int32],
    height: NDArray[np.int32],
    u: Floats,
    v: Floats,
    share: Floats,
    total: list[Floats],
) -> None:
    x = within(u * width.astype(np.float32) - np.float32(0.5), -8e6, 8e6)
    y = within(v * height.astype(np.float32) - np.float32(0.5), -8e6, 8e6)
    fx, fy = np.floor(x), np.floor(y)
    ax, ay = x - fx, y - fy
    ix, iy = fx.astype(np.int32), fy.astype(np.int32)
    # rows end with a copy of their first texel
    x0, stride = ix & (width - 1), width + 1
    low, high = first + (iy & (height - 1)) * stride, first + ((iy + 1) & (height - 1)) * stride
    top = ay * share
    bottom = share - top
    tr, br = top * ax, bottom * ax
    weights = (bottom - br, br, top - tr, tr)
    for at, weight in zip((low + x0, low + x0 + 1, high + x0, high + x0 + 1), weights, strict=True):
        texel = texels[at]
        for i in range(3):
            c = ((texel >> (10 * i)) & 1023).astype(np.float32)
            total[i] += c * c * weight
