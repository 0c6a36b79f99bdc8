// Texture sampling.
#pragma once
#include <string.h>

#include "draw_looks.h"
#include "simd.h"

// Larger texture coordinates have no accurate fraction.
#define FARTHEST_TEXEL 8e6f
#define SQUARED_TEXEL (1 / (1023.0f * 1023.0f))

// Texels contain the square roots of linear light, 10 bits each, and 2 bits of alpha in the highest bits. Colours are
// read at their places, without a shift: green is 2**20 times as large, blue 2**40 times.
#define GREEN_SCALE (1.0f / (1 << 20))
#define BLUE_SCALE (GREEN_SCALE * GREEN_SCALE)

static inline F8 squared_of(I8 t, int at) {
    const F8 c = to_float(t & (1023 << at));
    return c * c;
}

static inline V3 add_texels(V3 total, I8 t, F8 share) {
    return (V3){total.x + squared_of(t, 0) * share, total.y + squared_of(t, 10) * share,
                total.z + squared_of(t, 20) * share};
}

static inline int64_t pair_at(const Frame *f, int32_t at) {
    int64_t pair;
    memcpy(&pair, f->texels + at, sizeof pair);
    return pair;
}

// Two texels each: rows are one texel longer than a texture, so that neighbours are next to each other.
static inline V3 add_pairs(const Frame *f, V3 total, I8 at, F8 left, F8 right) {
    int32_t index[LANES];
    memcpy(index, &at, sizeof index);
    const L4 low = {pair_at(f, index[0]), pair_at(f, index[1]), pair_at(f, index[2]), pair_at(f, index[3])};
    const L4 high = {pair_at(f, index[4]), pair_at(f, index[5]), pair_at(f, index[6]), pair_at(f, index[7])};
    total = add_texels(total, __builtin_shufflevector((I8)low, (I8)high, 0, 2, 4, 6, 8, 10, 12, 14), left);
    return add_texels(total, __builtin_shufflevector((I8)low, (I8)high, 1, 3, 5, 7, 9, 11, 13, 15), right);
}

static inline V3 bilinear(const Frame *f, V3 total, I8 first, I8 width, I8 height, F8 u, F8 v, F8 share) {
    const F8 x = within(u * to_float(width) - 0.5f, -FARTHEST_TEXEL, FARTHEST_TEXEL);
    const F8 y = within(v * to_float(height) - 0.5f, -FARTHEST_TEXEL, FARTHEST_TEXEL);
    const F8 fx = whole(x), fy = whole(y), ax = x - fx, ay = y - fy;
    const I8 ix = to_int(fx), iy = to_int(fy), stride = width + 1, column = first + (ix & (width - 1));
    const F8 top = ay * share, bottom = share - top, tr = top * ax, br = bottom * ax;
    total = add_pairs(f, total, column + (iy & (height - 1)) * stride, bottom - br, br);
    return add_pairs(f, total, column + ((iy + 1) & (height - 1)) * stride, top - tr, tr);
}

// The textures of eight samples; of the first one only, if all are the same.
typedef struct {
    const Texture *of[LANES];
    I8 width, height, last;  // the size in texels, and the last level
    int same;
} Textures;

// The size of a texture of OpenGL, relative to the number of its texels here.
static inline float share_of(const Texture *t) {
    float share;
    memcpy(&share, &t->spare, sizeof share);
    return t->spare ? share : 1;
}

static inline Textures textures_of(const Frame *f, I8 who) {
    Textures t;
    t.same = !any(who != splat_int(who[0]));
    const Texture *one = t.of[0] = f->textures + (who[0] < 0 ? 0 : who[0]);
    t.width = splat_int(one->width), t.height = splat_int(one->height), t.last = splat_int(one->levels - 1);
    if (t.same) return t;
    EACH_LANE(j) t.of[j] = f->textures + (who[j] < 0 ? 0 : who[j]);
    EACH_LANE(j) t.width[j] = t.of[j]->width, t.height[j] = t.of[j]->height, t.last[j] = t.of[j]->levels - 1;
    return t;
}

// The first texels of levels.
static inline I8 first_of(const Textures *t, I8 level) {
    if (t->same && !any(level != splat_int(level[0]))) return splat_int(t->of[0]->first[level[0]]);
    I8 first;
    EACH_LANE(j) first[j] = t->of[t->same ? 0 : j]->first[level[j]];
    return first;
}

// The centres of eight footprints in texture coordinates, and their longer sides.
typedef struct {
    F8 u, v, du, dv;
} Across;

// A level of the textures, with a number of samples along the longer sides of the footprints; `each` is its reciprocal.
static __attribute__((noinline)) V3 add_level(const Frame *f, const Textures *t, V3 total, I8 level, const Across *a,
                                              F8 looks, F8 each, F8 weight) {
    const I8 one_texel = splat_int(1), first = first_of(t, level);
    const I8 wide = greater_int(t->width >> level, one_texel), high = greater_int(t->height >> level, one_texel);
    const F8 share = weight * each;
    for (int n = 0; any(looks > splat((float)n)); n++) {
        const F8 s = ((float)n + 0.5f) * each - 0.5f;
        total = bilinear(f, total, first, wide, high, a->u + s * a->du, a->v + s * a->dv,
                         pick(looks > splat((float)n), share, splat(0)));
    }
    return total;
}

// One sample of a level of the textures.
static inline V3 look_up_level(const Frame *f, const Textures *t, V3 total, I8 level, const Looks *l, F8 weight) {
    const I8 one_texel = splat_int(1);
    return bilinear(f, total, first_of(t, level), greater_int(t->width >> level, one_texel),
                    greater_int(t->height >> level, one_texel), l->u, l->v, weight);
}

// Trilinear, as OpenGL does it without anisotropic filters.
static __attribute__((noinline)) V3 trilinear(const Frame *f, const Textures *t, const Looks *l, F8 longer) {
    const F8 one = splat(1);
    const I8 bits = bits_of(greater(root(longer), one)), level = (bits >> 23) - 127, last = level >= t->last;
    const F8 size = from_bits((bits & 0x7fffff) | 0x3f800000);
    // the logarithm of the size, nearly
    const F8 blend = pick(last, splat(0), (size - 1) * (1.3465f - 0.3465f * (size - 1)));
    const I8 low = pick_int(last, t->last, level), high = pick_int(last, t->last, level + 1);
    const V3 total = look_up_level(f, t, grey(0), low, l, (1 - blend) * SQUARED_TEXEL);
    return any(blend > splat(0)) ? look_up_level(f, t, total, high, l, blend * SQUARED_TEXEL) : total;
}

// Trilinear, with up to four samples along the longer side of a pixel's footprint: multiplies the colours of eight
// samples.
static inline void add_textures(const Frame *f, Looks *l) {
    // with a texture in one sample, all eight have one
    if (l->texture[0] < 0) return;
    const Textures t = textures_of(f, l->texture);
    const F8 w = to_float(t.width), h = to_float(t.height), one = splat(1), zero = splat(0);
    const F8 ux = l->ux * w, vx = l->vx * h, uy = l->uy * w, vy = l->vy * h;
    // squares of the sides of the footprints
    const F8 px = lesser(ux * ux + vx * vx, splat(1e8f)), py = lesser(uy * uy + vy * vy, splat(1e8f));
    const F8 longer = greater(px, py);
    if (f->classic) {
        F8 shares;
        shares = splat(share_of(t.of[0]));
        if (!t.same) EACH_LANE(j) shares[j] = share_of(t.of[j]);
        const V3 total = trilinear(f, &t, l, longer * shares * shares);
        l->r *= total.x, l->g *= total.y * GREEN_SCALE, l->b *= total.z * BLUE_SCALE;
        return;
    }
    const F8 shorter = greater(lesser(px, py), one);
    const F8 du = pick(px < py, l->uy, l->ux), dv = pick(px < py, l->vy, l->vx);
    // the ratio of the sides, rounded down from 0.6, and its reciprocal, without divisions
    const I8 two = longer > shorter * (1.6f * 1.6f), three = longer > shorter * (2.6f * 2.6f),
             four = longer > shorter * (3.6f * 3.6f);
    const F8 looks = 1 - to_float(two + three + four);
    const F8 each = pick(four, splat(0.25f), pick(three, splat(1.0f / 3), pick(two, splat(0.5f), one)));
    F8 size = greater(root(longer) * each, one);
    const I8 bits = bits_of(size);
    I8 level = (bits >> 23) - 127;
    const I8 last = level >= t.last;
    level = pick_int(last, t.last, level);
    size = from_bits((bits & 0x7fffff) | 0x3f800000);
    // levels are blended only in the middle half between two levels: elsewhere one is enough
    const F8 blend = pick(last, zero, within(2 * size - 2.5f, 0, 1));
    const Across across = {l->u, l->v, du, dv};
    V3 total = grey(0);
    if (any(blend < one)) total = add_level(f, &t, total, level, &across, looks, each, (1 - blend) * SQUARED_TEXEL);
    // its texels are twice as large: half as many samples
    if (any(blend > zero))
        total = add_level(f, &t, total, pick_int(last, level, level + 1), &across, pick(three, splat(2), one),
                          pick(three, splat(0.5f), one), blend * SQUARED_TEXEL);
    l->r *= total.x, l->g *= total.y * GREEN_SCALE, l->b *= total.z * BLUE_SCALE;
}
