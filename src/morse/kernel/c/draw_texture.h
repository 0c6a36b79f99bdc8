// Texture sampling.
#pragma once
#include "draw_looks.h"
#include "simd.h"

// Larger texture coordinates have no accurate fraction.
#define FARTHEST_TEXEL 8e6f

// Texels contain the square roots of linear light, 10 bits each, and 2 bits of alpha in the highest bits.
static inline void add_texels(const Frame *f, I8 at, F8 share, F8 *total) {
    I8 t;
    EACH_LANE(j) t[j] = f->texels[at[j]];
    EACH(i, 3) {
        const F8 c = to_float((t >> (10 * i)) & 1023);
        total[i] += c * c * share;
    }
}

static inline void bilinear(const Frame *f, I8 first, I8 width, I8 height, F8 u, F8 v, F8 share, F8 *total) {
    const F8 x = within(u * to_float(width) - 0.5f, -FARTHEST_TEXEL, FARTHEST_TEXEL);
    const F8 y = within(v * to_float(height) - 0.5f, -FARTHEST_TEXEL, FARTHEST_TEXEL);
    const F8 fx = whole(x), fy = whole(y), ax = x - fx, ay = y - fy;
    const I8 ix = to_int(fx), iy = to_int(fy), x0 = ix & (width - 1), x1 = (ix + 1) & (width - 1);
    const I8 low = first + (iy & (height - 1)) * width, high = first + ((iy + 1) & (height - 1)) * width;
    const F8 top = ay * share, bottom = share - top, tr = top * ax, br = bottom * ax;
    add_texels(f, low + x0, bottom - br, total), add_texels(f, low + x1, br, total);
    add_texels(f, high + x0, top - tr, total), add_texels(f, high + x1, tr, total);
}

// Trilinear, with up to four samples along the longer side of a pixel's footprint: multiplies the colours of 8 samples.
static inline void add_texture(const Frame *f, Looks *l, int i) {
    const I8 who = *(const I8 *)(l->texture + i), one_texel = splat_int(1);
    if (!any(who >= 0)) return;
    I8 width, height, levels, first, next;
    EACH_LANE(j) {
        const Texture *t = f->textures + (who[j] < 0 ? 0 : who[j]);
        width[j] = t->width, height[j] = t->height, levels[j] = t->levels;
    }
    const F8 w = to_float(width), h = to_float(height), one = splat(1), zero = splat(0);
    const F8 ux = AT(ux) * w, vx = AT(vx) * h, uy = AT(uy) * w, vy = AT(vy) * h;
    const F8 px = lesser(ux * ux + vx * vx, splat(1e8f)), py = lesser(uy * uy + vy * vy, splat(1e8f));
    const F8 longer = root(greater(px, py)), shorter = root(lesser(px, py));
    const F8 du = pick(px < py, AT(uy), AT(ux)), dv = pick(px < py, AT(vy), AT(vx));
    const F8 looks = within(whole(longer / greater(shorter, one) + 0.4f), 1, 4);
    F8 size = greater(longer / looks, one), total[3] = {zero, zero, zero};
    F8 *c[3] = {(F8 *)(l->r + i), (F8 *)(l->g + i), (F8 *)(l->b + i)};
    const I8 bits = bits_of(size);
    I8 level = (bits >> 23) - 127;
    const I8 last = level >= levels - 1;
    level = pick_int(last, levels - 1, level);
    size = from_bits((bits & 0x7fffff) | 0x3f800000);
    // levels are blended only in the middle half between two levels: elsewhere one sample is enough
    const F8 blend = pick(last, zero, within(2 * size - 2.5f, 0, 1));
    EACH_LANE(j) {
        const Texture *t = f->textures + (who[j] < 0 ? 0 : who[j]);
        first[j] = t->first[level[j]], next[j] = t->first[last[j] ? level[j] : level[j] + 1];
    }
    const I8 wide = greater_int(width >> level, one_texel), high = greater_int(height >> level, one_texel);
    // on the last level blend is 0, and the next level is never read
    const I8 less_wide = pick_int(last, wide, greater_int(width >> (level + 1), one_texel));
    const I8 less_high = pick_int(last, high, greater_int(height >> (level + 1), one_texel));
    for (int n = 0; any(looks > splat((float)n)); n++) {
        const F8 share = pick(looks > splat((float)n), 1 / (looks * (1023.0f * 1023.0f)), zero);
        const F8 s = ((float)n + 0.5f) / looks - 0.5f, u = AT(u) + s * du, v = AT(v) + s * dv;
        if (any(blend < one)) bilinear(f, first, wide, high, u, v, share * (1 - blend), total);
        if (any(blend > zero)) bilinear(f, next, less_wide, less_high, u, v, share * blend, total);
    }
    EACH(n, 3) * c[n] *= pick(who >= 0, total[n], one);
}
