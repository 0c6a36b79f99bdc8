// Shading of surfaces by lamps, as in the live view (three.js): metallic-roughness with GGX, ACES filmic tone mapping.
#pragma once
#include <string.h>

#include "draw_looks.h"
#include "drawing.h"
#include "simd.h"

// Share of light that a dielectric surface reflects at normal incidence.
#define SPECULAR 0.04f
#define PI_F 3.14159265f
// The place in Frame.sky that says whether surfaces look as in MORSE 1.4: lamps multiply codes of sRGB, nothing is
// mirrored, and no tones are mapped.
#define AS_IN_1_4 17
// Share of light that a surface returned there.
#define RETURNED 0.8f

static inline V3 sky_in(const float *sky, V3 d) {
    const F8 zero = splat(0), rise = 1 - power(greater(1 - greater(d.z, zero), splat(1e-6f)), 2.6f);
    const F8 fall = 1 - lesser(greater(-d.z, zero) * 3, splat(1));
    const F8 n = greater(dot(d, everywhere(sky + 12)), zero), n2 = n * n, n4 = n2 * n2, n8 = n4 * n4, n16 = n8 * n8;
    const F8 n32 = n16 * n16, n64 = n32 * n32, n128 = n64 * n64;
    const V3 c = mixed(mixed(everywhere(sky), everywhere(sky + 3), rise), everywhere(sky + 6), 1 - fall * fall);
    return sum(c, scaled(everywhere(sky + 9), 0.22f * n8 * n4 + 0.5f * n128 * n128 * n128 * n16));
}

// Linear light as a code of sRGB, 0 to 1.
static inline F8 code(F8 v) {
    return pick(v < 0.0031308f, 12.92f * v, 1.055f * power(greater(v, splat(1e-6f)), 1 / 2.4f) - 0.055f);
}

static inline F8 light_of_code(F8 v) {
    return pick(v < 0.04045f, v * (1 / 12.92f), power(greater((v + 0.055f) * (1 / 1.055f), splat(1e-6f)), 2.4f));
}

static inline V3 codes(V3 c) { return (V3){code(c.x), code(c.y), code(c.z)}; }
static inline V3 light_of_codes(V3 c) { return (V3){light_of_code(c.x), light_of_code(c.y), light_of_code(c.z)}; }

static inline F8 filmic(F8 v) {
    return (v * (v + 0.0245786f) - 0.000090537f) / (v * (0.983729f * v + 0.4329510f) + 0.238081f);
}

// S. Hill's fit of ACES, with the exposure of the live view.
static inline V3 tone(V3 c) {
    c = scaled(c, splat(1.5f));
    const F8 x = filmic(0.59719f * c.x + 0.35458f * c.y + 0.04823f * c.z);
    const F8 y = filmic(0.07600f * c.x + 0.90834f * c.y + 0.01566f * c.z);
    const F8 z = filmic(0.02840f * c.x + 0.13383f * c.y + 0.83777f * c.z);
    return (V3){1.60475f * x - 0.53108f * y - 0.07367f * z, -0.10208f * x + 1.10813f * y - 0.00605f * z,
                -0.00327f * x - 0.07276f * y + 1.07602f * z};
}

typedef struct {
    const float *texels, *sun;
    const ShadowBlock *bounds;
    int32_t width, height;
} ShadowMap;

// A share that differs from 1 by rounding only.
#define WHOLLY_LIT 0.9999f

// Share of the sun's light that reaches a point in a shadow map: 4 x 4 texels, weighted by a tent; `row` is the first
// one.
static inline float sunlit(const float *row, int64_t width, float au, float av, float d) {
    const F4 across = {1 - au, 1, 1, au}, depth = {d, d, d, d};
    const float down[4] = {1 - av, 1, 1, av};
    F4 lit = {0, 0, 0, 0};
    EACH(j, 4) {
        F4 texels;
        memcpy(&texels, row + j * width, sizeof texels);
        lit += (F4)((I4)across & (texels <= depth)) * down[j];
    }
    const float share = (lit[0] + lit[1] + lit[2] + lit[3]) * (1 / 9.0f);
    return share > WHOLLY_LIT ? 1 : share;
}

// The bounds of the texels that are read for eight points.
static inline void bounds_at(const ShadowMap *m, I8 column, I8 row, F8 *low, F8 *high) {
    const int32_t wide = (m->width + (1 << SHADOW_SHIFT) - 1) >> SHADOW_SHIFT, part = (1 << SHADOW_SHIFT) - 1;
    const I8 at = (row >> SHADOW_SHIFT) * wide + (column >> SHADOW_SHIFT);
    const F8 right = to_float(column & part), down = to_float(row & part);
    if (!any(at != splat_int(at[0]))) {
        const ShadowBlock *b = m->bounds + at[0];
        const F8 rise = right * b->across + down * b->down;
        *low = rise + b->low, *high = rise + b->high;
        return;
    }
    F4 rows[LANES];
    EACH_LANE(j) memcpy(rows + j, m->bounds + at[j], sizeof *rows);
    F8 a[4];
    columns_of(rows, a);
    const F8 rise = right * a[0] + down * a[1];
    *low = rise + a[2], *high = rise + a[3];
}

// Reads the shares of eight points that have no share yet; points outside the map get none.
static inline void read_map(const ShadowMap *m, F8 u, F8 v, F8 d, F8 *share) {
    const float *rows[LANES];
    const F8 fu = whole(u), fv = whole(v), au = u - fu, av = v - fv;
    I8 on = (*share < splat(0)) & (fu >= splat(1)) & (fv >= splat(1)) & (fu < splat((float)(m->width - 2))) &
            (fv < splat((float)(m->height - 2)));
    if (!any(on)) return;
    const I8 iu = to_int(pick(on, fu, splat(1))) - 1, iv = to_int(pick(on, fv, splat(1))) - 1;
    if (m->bounds) {
        F8 low, high;
        bounds_at(m, iu, iv, &low, &high);
        const I8 lit = high <= d, dark = low > d;
        *share = pick(on & lit, splat(1), pick(on & dark, splat(0), *share));
        on &= ~(lit | dark);
        if (!any(on)) return;
    }
    EACH_LANE(j) { rows[j] = m->texels + (int64_t)iv[j] * m->width + iu[j]; }
    EACH_LANE(j) if (on[j])(*share)[j] = sunlit(rows[j], m->width, au[j], av[j], d[j]);
}

static inline F8 along(const float *row, V3 p, float more) {
    return row[0] * p.x + row[1] * p.y + row[2] * p.z + (row[3] + more);
}

// Looks up the shares of eight points in a map of the sun.
static inline void look_up(const ShadowMap *m, V3 place, V3 n, F8 *share) {
    const float *s = m->sun;
    // an offset along the normal and towards the sun, so that no surface shadows itself
    const V3 p = sum(place, scaled(n, splat(s[12] * 1.3f)));
    read_map(m, along(s, p, -0.5f), along(s + 4, p, -0.5f), along(s + 8, p, s[12] * 1.5f), share);
}

// The share of a spot lamp's light that reaches eight points; its map is in perspective, so that texels grow with
// depth.
static inline F8 past_things(const Frame *f, V3 place, V3 n, F8 nl) {
    const ShadowMap m = {f->lamp_shadow, f->lamp_frame, f->lamp_bounds, f->lamp_width, f->lamp_height};
    const float *s = m.sun;
    const F8 texel = greater(along(s + 8, place, 0), splat(1e-3f)) * s[12];
    const V3 p = sum(place, scaled(n, texel * 1.3f));
    const F8 depth = greater(along(s + 8, p, 0), splat(1e-3f)), scale = 1 / depth;
    F8 share = pick(nl > splat(0), splat(-1), splat(0));
    read_map(&m, along(s, p, 0) * scale - 0.5f, along(s + 4, p, 0) * scale - 0.5f, texel * 1.5f - depth, &share);
    return pick(share < splat(0), splat(1), share);
}

// The share of the sun's light that reaches eight points: from the finer map if it covers them, else from the other.
static inline F8 in_sun(const Frame *f, V3 place, V3 n, I8 facing) {
    const ShadowMap near = {f->near_shadow, f->near_sun, f->near_bounds, f->near_width, f->near_height};
    const ShadowMap far = {f->shadow, f->sun, f->shadow_bounds, f->shadow_width, f->shadow_height};
    F8 share = pick(facing, splat(-1), splat(0));
    if (near.width) look_up(&near, place, n, &share);
    if (any(share < splat(0))) look_up(&far, place, n, &share);
    return pick(share < splat(0), splat(1), share);
}

static inline int casts_shadows(const Lamp *k) { return (int)k->kind == SUN_LAMP && k->outer > 0; }

// Sets the shares of the sun's light.
static inline void look_at_sun(const Frame *f, Looks *l) {
    I8 facing = splat_int(0);
    EACH(i, f->lamp_count) {
        const Lamp *k = f->lamps + i;
        if (casts_shadows(k)) facing |= dot(l->normal, everywhere(k->towards)) > splat(0);
    }
    l->sun = f->shadow_width && any(facing) ? in_sun(f, l->place, l->normal, facing) : splat(1);
}

// Light of all lamps that surfaces reflect to the camera.
static inline V3 lit(const Frame *f, const Looks *l, V3 v, V3 base) {
    const V3 place = l->place, n = l->normal;
    const F8 metallic = l->metallic, roughness = l->roughness;
    const F8 zero = splat(0), one = splat(1), rough = greater(roughness, splat(0.0525f)), alpha = rough * rough;
    const F8 a2 = alpha * alpha, rest = 1 - a2, toward = dot(n, v), nv = greater(toward, splat(1e-4f));
    const F8 seen = root(a2 + rest * nv * nv);
    const V3 f0 = mixed(grey(SPECULAR), base, metallic);
    V3 diffuse = grey(0), shine = diffuse;
    EACH(i, f->lamp_count) {
        const Lamp *k = f->lamps + i;
        const int kind = (int)k->kind;
        V3 light = everywhere(k->color), to = everywhere(k->towards);
        F8 fade = one;
        if (kind == HEMISPHERE_LAMP) {
            diffuse = sum(diffuse, mixed(everywhere(k->ground), light, 0.5f * dot(n, to) + 0.5f));
            continue;
        }
        if (kind != SUN_LAMP) {
            V3 way = {splat(k->place[0]) - place.x, splat(k->place[1]) - place.y, splat(k->place[2]) - place.z};
            const F8 far = root(greater(dot(way, way), splat(1e-8f)));
            way = scaled(way, 1 / far);
            if (f->sky[AS_IN_1_4] > 0) {
                const F8 t = far * (1 / k->decay);
                fade = 1 / (1 + t * t);
            } else {
                fade = power(far, -k->decay);
            }
            if (kind == SPOT_LAMP) {
                const F8 t = within((dot(way, to) - k->outer) * (1 / (k->inner - k->outer)), 0, 1);
                fade *= t * t * (3 - 2 * t);
            }
            to = way;
        }
        const F8 facing = dot(n, to), nl = greater(facing, zero);
        if (!any(nl > zero)) continue;
        if (casts_shadows(k)) fade = l->sun;
        if (kind == SPOT_LAMP && k->ground[0] > 0 && f->lamp_width) fade *= past_things(f, place, n, nl);
        light = scaled(light, fade * nl), diffuse = sum(diffuse, light);
        // the half vector is h = (to + v) / sqrt(s): nh * nh = both * both / s, vh = sqrt(s) / 2
        const F8 s = greater(2 + 2 * dot(v, to), splat(1e-6f)), both = facing + toward;
        const F8 t = s - both * both * rest, q = greater(1 - 0.5f * root(s), zero), q2 = q * q;
        const F8 shadowed = greater(nl * seen + nv * root(a2 + rest * nl * nl), splat(1e-6f));
        const V3 mirrored = product(light, mixed(f0, grey(1), q2 * q2 * q));
        shine = sum(shine, scaled(mirrored, a2 * (s * s) * (0.5f / PI_F) / (t * t * shadowed)));
    }
    if (f->sky[AS_IN_1_4] > 0) return scaled(product(base, diffuse), splat(RETURNED / PI_F));
    return sum(scaled(product(base, diffuse), (1 - metallic) * (1 / PI_F)), shine);
}
