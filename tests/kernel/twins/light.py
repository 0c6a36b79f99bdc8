"""Shading of surfaces by lamps; the twin of ``c/draw_light.h``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.kernel.drawing.arrays import HEMISPHERE, SPOT, SUN

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.kernel.drawing.arrays import Light

    #: of float32
    Floats = np.ndarray
    #: three arrays (N,), or three numbers
    Vectors = Sequence[Any]

f = np.float32


def within(a: Floats, low: float, high: float) -> Floats:
    """Clip to two numbers; NaN becomes the upper one."""
    below = np.where(a < f(high), a, f(high))
    return np.where(below > f(low), below, f(low)).astype(np.float32)


def dot(a: Vectors, b: Vectors) -> Floats:
    """(N,) products."""
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def unit(a: Vectors) -> list[Floats]:
    """Normalise vectors."""
    square = dot(a, a)
    factor = f(1) / np.sqrt(np.where(square > f(1e-30), square, f(1e-30)))
    return [part * factor for part in a]


def mixed(a: Vectors, b: Vectors, t: Floats) -> list[Floats]:
    """Interpolate from a to b."""
    return [p + (q - p) * t for p, q in zip(a, b, strict=True)]


def power(base: Floats, exponent: np.float32) -> Floats:
    """Positive bases to the power of an exponent."""
    bits = np.asarray(base, np.float32).view(np.int32)
    high = (bits - np.int32(0x3F3504F3)) >> 23
    m = (bits - high * np.int32(8388608)).view(np.float32)
    t = (m - f(1)) / (m + f(1))
    s = t * t
    series = f(1) + s * (f(0.33333333) + s * (f(0.2) + s * f(0.14285714)))
    log2 = f(2.88539008) * t * series + high.astype(np.float32)
    p = within(log2 * exponent, -100, 100)
    n = np.floor(p)
    r = (p - n) * f(0.69314718)
    two = ((n.astype(np.int32) + 127) * 8388608).astype(np.int32).view(np.float32)
    rest = f(1) + r * (f(0.5) + r * (f(0.16666667) + r * (f(0.041666667) + r * f(0.0083333333))))
    base_two: Floats = (f(1) + r * rest) * two
    return base_two


def sky_in(sky: Floats, d: Vectors) -> list[Floats]:
    """The light of the sky in unit directions."""
    up, down = np.where(d[2] > 0, d[2], f(0)), np.where(-d[2] > 0, -d[2], f(0)) * f(3)
    remaining = f(1) - up
    rise = f(1) - power(np.where(remaining > f(1e-6), remaining, f(1e-6)), f(2.6))
    fall = f(1) - np.where(down < f(1), down, f(1))
    n = dot(d, [sky[12], sky[13], sky[14]])
    n = np.where(n > 0, n, f(0))
    n2 = n * n
    n4 = n2 * n2
    n8 = n4 * n4
    n16 = n8 * n8
    n32 = n16 * n16
    n64 = n32 * n32
    n128 = n64 * n64
    c = mixed(mixed(list(sky[0:3]), list(sky[3:6]), rise), list(sky[6:9]), f(1) - fall * fall)
    glow = f(0.22) * n8 * n4 + f(0.5) * n128 * n128 * n128 * n16
    return [part + glare * glow for part, glare in zip(c, sky[9:12], strict=True)]


def code(v: Floats) -> Floats:
    """Linear light as a code of sRGB, 0 to 1."""
    above: Floats = f(1.055) * power(np.where(v > f(1e-6), v, f(1e-6)), f(1 / np.float32(2.4))) - f(0.055)
    return np.where(v < f(0.0031308), f(12.92) * v, above).astype(np.float32)


def light_of_code(v: Floats) -> Floats:
    """The linear light of a code of sRGB, 0 to 1."""
    part = (v + f(0.055)) * f(1 / np.float32(1.055))
    above = power(np.where(part > f(1e-6), part, f(1e-6)), f(2.4))
    return np.where(v < f(0.04045), v * f(1 / np.float32(12.92)), above).astype(np.float32)


def _filmic(v: Floats) -> Floats:
    value: Floats = (v * (v + f(0.0245786)) - f(0.000090537)) / (v * (f(0.983729) * v + f(0.4329510)) + f(0.238081))
    return value


def tone(c: Vectors) -> list[Floats]:
    """ACES filmic tone mapping."""
    r, g, b = (part * f(1.5) for part in c)
    x = _filmic(f(0.59719) * r + f(0.35458) * g + f(0.04823) * b)
    y = _filmic(f(0.07600) * r + f(0.90834) * g + f(0.01566) * b)
    z = _filmic(f(0.02840) * r + f(0.13383) * g + f(0.83777) * b)
    return [
        f(1.60475) * x - f(0.53108) * y - f(0.07367) * z,
        f(-0.10208) * x + f(1.10813) * y - f(0.00605) * z,
        f(-0.00327) * x - f(0.07276) * y + f(1.07602) * z,
    ]


def _in_sun(light: Light, place: Vectors, n: Vectors, nl: Floats) -> Floats:
    """The share of the sun's light that reaches points: from the finer map if it covers them, else from the other."""
    share = np.where(nl > 0, f(-1), f(0))
    for sun, shadow in ((light.near_sun, light.near_shadow), (light.sun, light.shadow)):
        if sun is not None and shadow is not None:
            share = np.where(share < 0, _looked_up(sun, shadow, place, n), share)
    return np.where(share < 0, f(1), share).astype(np.float32)


def _looked_up(s: Floats, shadow: Floats, place: Vectors, n: Vectors) -> Floats:
    """The shares from one map of the sun; -1 outside the map."""
    p = [a + b * (s[12] * f(1.3)) for a, b in zip(place, n, strict=True)]
    return _read(shadow, _along(s, p, f(-0.5)), _along(s[4:], p, f(-0.5)), _along(s[8:], p, s[12] * f(1.5)))


def _past_things(light: Light, place: Vectors, n: Vectors, nl: Floats) -> Floats:
    """The share of a spot lamp's light that reaches points; its map is in perspective: texels grow with depth."""
    s, shadow = light.lamp_frame, light.lamp_shadow
    assert s is not None
    assert shadow is not None
    ahead = _along(s[8:], place, f(0))
    nearest: Floats = np.where(ahead > f(1e-3), ahead, f(1e-3))
    texel = nearest * s[12]
    p = [a + b * (texel * f(1.3)) for a, b in zip(place, n, strict=True)]
    ahead = _along(s[8:], p, f(0))
    depth: Floats = np.where(ahead > f(1e-3), ahead, f(1e-3))
    scale = f(1) / depth
    u, v = _along(s, p, f(0)) * scale - f(0.5), _along(s[4:], p, f(0)) * scale - f(0.5)
    share = np.where(nl > 0, _read(shadow, u, v, texel * f(1.5) - depth), f(0))
    return np.where(share < 0, f(1), share).astype(np.float32)


def _along(row: Floats, p: Vectors, more: np.float32) -> Floats:
    return np.asarray(row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + (row[3] + more))


def _read(shadow: Floats, u: Floats, v: Floats, d: Floats) -> Floats:
    """The shares at columns and rows of a map; -1 outside the map."""
    fu, fv = np.floor(u), np.floor(v)
    au, av = u - fu, v - fv
    height, width = shadow.shape
    inside = (fu >= 1) & (fv >= 1) & (fu < width - 2) & (fv < height - 2)
    column = np.where(inside, fu, 1).astype(np.int64) - 1
    row = np.where(inside, fv, 1).astype(np.int64) - 1
    across: Vectors = [f(1) - au, f(1), f(1), au]
    down: Vectors = [f(1) - av, f(1), f(1), av]
    lit: list[Floats] = [np.zeros_like(u) for _ in range(4)]
    for j in range(4):
        for i in range(4):
            near = shadow[np.minimum(row + j, height - 1), np.minimum(column + i, width - 1)]
            lit[i] = lit[i] + np.where(near <= d, across[i], f(0)) * down[j]
    share = (lit[0] + lit[1] + lit[2] + lit[3]) * f(1 / 9.0)
    share = np.where(share > f(0.9999), f(1), share)
    return np.where(inside, share, f(-1)).astype(np.float32)


def lit(
    light: Light, place: Vectors, n: Vectors, v: Vectors, base: Vectors, metallic: Floats, roughness: Floats
) -> list[Floats]:
    """Light of all lamps that surfaces reflect to the camera."""
    rough = np.where(roughness > f(0.0525), roughness, f(0.0525))
    alpha = rough * rough
    a2 = alpha * alpha
    rest, toward = f(1) - a2, dot(n, v)
    nv = np.where(toward > f(1e-4), toward, f(1e-4))
    visibility = np.sqrt(a2 + rest * nv * nv)
    f0 = mixed([f(0.04)] * 3, base, metallic)
    diffuse = [np.zeros_like(a2) for _ in range(3)]
    shine = [np.zeros_like(a2) for _ in range(3)]
    for k in light.lamps:
        color, to = list(k["color"]), list(k["towards"])
        if k["kind"] == HEMISPHERE:
            facing = f(0.5) * dot(n, to) + f(0.5)
            diffuse = [a + b for a, b in zip(diffuse, mixed(list(k["ground"]), color, facing), strict=True)]
            continue
        fade: Floats = np.ones_like(a2)
        if k["kind"] != SUN:
            way = [k["place"][i] - place[i] for i in range(3)]
            square = dot(way, way)
            far = np.sqrt(np.where(square > f(1e-8), square, f(1e-8)))
            inverse = f(1) / far
            way = [part * inverse for part in way]
            if light.sky[17] > 0:
                ratio = far * (f(1) / k["decay"])
                fade = f(1) / (f(1) + ratio * ratio)
            else:
                fade = power(far, -k["decay"])
            if k["kind"] == SPOT:
                t = within((dot(way, to) - k["outer"]) * (f(1) / (k["inner"] - k["outer"])), 0, 1)
                fade = fade * (t * t * (f(3) - f(2) * t))
            to = way
        facing = dot(n, to)
        nl = np.where(facing > 0, facing, f(0))
        if k["kind"] == SUN and k["outer"] > 0 and light.shadow is not None:
            fade = _in_sun(light, place, n, nl)
        if k["kind"] == SPOT and k["ground"][0] > 0 and light.lamp_shadow is not None:
            fade = fade * _past_things(light, place, n, nl)
        strength = fade * nl
        shone = [part * strength for part in color]
        diffuse = [a + b for a, b in zip(diffuse, shone, strict=True)]
        square = f(2) + f(2) * dot(v, to)
        square = np.where(square > f(1e-6), square, f(1e-6))
        both = facing + toward
        t = square - both * both * rest
        q = f(1) - f(0.5) * np.sqrt(square)
        q = np.where(q > 0, q, f(0))
        q2 = q * q
        shadowed = nl * visibility + nv * np.sqrt(a2 + rest * nl * nl)
        shadowed = np.where(shadowed > f(1e-6), shadowed, f(1e-6))
        factor = a2 * (square * square) * (f(0.5) / f(3.14159265)) / (t * t * shadowed)
        for i, mirrored in enumerate(mixed(f0, [f(1)] * 3, q2 * q2 * q)):
            shine[i] = shine[i] + shone[i] * mirrored * factor
    if light.sky[17] > 0:
        return [base[i] * diffuse[i] * f(np.float32(0.8) / np.float32(3.14159265)) for i in range(3)]
    matt = (f(1) - metallic) * f(1 / np.float32(3.14159265))
    return [base[i] * diffuse[i] * matt + shine[i] for i in range(3)]
