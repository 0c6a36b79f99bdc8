// Texture sampling.
#pragma once
#include <string.h>

#include "draw_looks.h"
#include "simd.h"

// Larger texture coordinates have no accurate fraction.
#define FARTHEST_TEXEL 8e6f
#define SQUARED_TEXEL (1 / (1023.0f * 1023.0f))

// Texels contain the square roots of linear light, 10 bits each, and 2 bits of alpha in the highest bits.
static inline void add_texels(I8 t, F8 share, F8 *total) {
    EACH(i, 3) {
        const F8 c = to_float((t >> (10 * i)) & 1023);
        total[i] += c * c * share;
    }
}

static inline int64_t pair_at(const Frame *f, int32_t at) {
    int64_t pair;
    memcpy(&pair, f->texels + at, sizeof pair);
    return pair;
}

// Two texels each: rows are one texel longer than a texture, so that neighbours are next to each other.
static inline void add_pairs(const Frame *f, I8 at, F8 left, F8 right, F8 *total) {
    int32_t index[LANES];
    memcpy(index, &at, sizeof index);
    const L4 low = {pair_at(f, index[0]), pair_at(f, index[1]), pair_at(f, index[2]), pair_at(f, index[3])};
    const L4 high = {pair_at(f, index[4]), pair_at(f, index[5]), pair_at(f, index[6]), pair_at(f, index[7])};
    add_texels(__builtin_shufflevector((I8)low, (I8)high, 0, 2, 4, 6, 8, 10, 12, 14), left, total);
    add_texels(__builtin_shufflevector((I8)low, (I8)high, 1, 3, 5, 7, 9, 11, 13, 15), right, total);
}

static inline void bilinear(const Frame *f, I8 first, I8 width, I8 height, F8 u, F8 v, F8 share, F8 *total) {
    const F8 x = within(u * to_float(width) - 0.5f, -FARTHEST_TEXEL, FARTHEST_TEXEL);
    const F8 y = within(v * to_float(height) - 0.5f, -FARTHEST_TEXEL, FARTHEST_TEXEL);
    const F8 fx = whole(x), fy = whole(y), ax = x - fx, ay = y - fy;
    const I8 ix = to_int(fx), iy = to_int(fy), stride = width + 1, column = first + (ix & (width - 1));
    const F8 top = ay * share, bottom = share - top, tr = top * ax, br = bottom * ax;
    add_pairs(f, column + (iy & (height - 1)) * stride, bottom - br, br, total);
    add_pairs(f, column + ((iy + 1) & (height - 1)) * stride, top - tr, tr, total);
}

// The textures of eight samples.
typedef struct {
    const Texture *of[LANES];
    I8 width, height, last;  // the size in texels, and the last level
    int same;
} Textures;

static inline Textures textures_of(const Frame *f, I8 who) {
    Textures t;
    t.same = !any(who != splat_int(who[0]));
    EACH_LANE(j) t.of[j] = f->textures + (who[j] < 0 ? 0 : who[j]);
    const Texture *one = t.of[0];
    t.width = splat_int(one->width), t.height = splat_int(one->height), t.last = splat_int(one->levels - 1);
    if (!t.same)
        EACH_LANE(j) t.width[j] = t.of[j]->width, t.height[j] = t.of[j]->height, t.last[j] = t.of[j]->levels - 1;
    return t;
}

// The first texels of levels.
static inline I8 first_of(const Textures *t, I8 level) {
    if (t->same && !any(level != splat_int(level[0]))) return splat_int(t->of[0]->first[level[0]]);
    I8 first;
    EACH_LANE(j) first[j] = t->of[j]->first[level[j]];
    return first;
}

// The centres of eight footprints in texture coordinates, and their longer sides.
typedef struct {
    F8 u, v, du, dv;
} Across;

// Adds a level of the textures, with a number of samples along the longer sides of the footprints.
static __attribute__((noinline)) void add_level(const Frame *f, const Textures *t, I8 level, const Across *a, F8 looks,
                                                F8 weight, F8 *total) {
    const I8 one_texel = splat_int(1), first = first_of(t, level);
    const I8 wide = greater_int(t->width >> level, one_texel), high = greater_int(t->height >> level, one_texel);
    const F8 each = 1 / looks, share = weight * each;
    for (int n = 0; any(looks > splat((float)n)); n++) {
        const F8 s = ((float)n + 0.5f) * each - 0.5f;
        bilinear(f, first, wide, high, a->u + s * a->du, a->v + s * a->dv,
                 pick(looks > splat((float)n), share, splat(0)), total);
    }
}

// Trilinear, with up to four samples along the longer side of a pixel's footprint: multiplies the colours of eight
// samples.
static inline void add_textures(const Frame *f, Looks *l) {
    // with a texture in one sample, all eight have one
    if (l->texture[0] < 0) return;
    const Textures t = textures_of(f, l->texture);
    const F8 w = to_float(t.width), h = to_float(t.height), one = splat(1), zero = splat(0);
    const F8 ux = l->ux * w, vx = l->vx * h, uy = l->uy * w, vy = l->vy * h;
    const F8 px = lesser(ux * ux + vx * vx, splat(1e8f)), py = lesser(uy * uy + vy * vy, splat(1e8f));
    const F8 longer = root(greater(px, py)), shorter = root(lesser(px, py));
    const F8 du = pick(px < py, l->uy, l->ux), dv = pick(px < py, l->vy, l->vx);
    const F8 looks = within(whole(longer / greater(shorter, one) + 0.4f), 1, 4);
    F8 size = greater(longer / looks, one), total[3] = {zero, zero, zero};
    const I8 bits = bits_of(size);
    I8 level = (bits >> 23) - 127;
    const I8 last = level >= t.last;
    level = pick_int(last, t.last, level);
    size = from_bits((bits & 0x7fffff) | 0x3f800000);
    // levels are blended only in the middle half between two levels: elsewhere one is enough
    const F8 blend = pick(last, zero, within(2 * size - 2.5f, 0, 1));
    const Across across = {l->u, l->v, du, dv};
    if (any(blend < one)) add_level(f, &t, level, &across, looks, (1 - blend) * SQUARED_TEXEL, total);
    // its texels are twice as large
    const F8 fewer = whole((looks + 1) * 0.5f);
    if (any(blend > zero))
        add_level(f, &t, pick_int(last, level, level + 1), &across, fewer, blend * SQUARED_TEXEL, total);
    l->r *= total[0], l->g *= total[1], l->b *= total[2];
}
