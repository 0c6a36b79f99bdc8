// Surfaces with holes and translucent surfaces.
#pragma once
#include <math.h>

#include "draw_texture.h"
#include "drawing.h"

static const uint8_t BAYER[4][4] = {{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}};

static inline int texel_of(float coordinate, int32_t size) {
    const float at = floorf(coordinate * (float)size);
    // false for NaN
    return at > -FARTHEST_TEXEL && at < FARTHEST_TEXEL ? (int)at & (size - 1) : 0;
}

// Whether a sample shows such a surface, or the surface behind it.
static __attribute__((noinline)) int opaque(const Frame *f, const Seen *s, float x, float y, int px, int py) {
    const Surface *m = f->materials + s->material;
    if (m->texture >= 0) {
        const Texture *t = f->textures + m->texture;
        const int32_t *c = f->triangles[s->triangle];
        const Vertex *v = f->vertices + f->clusters[f->parts[s->part].cluster].vertex;
        float e[3], uv[2];
        EACH(i, 3) e[i] = s->e[i][0] * x + s->e[i][1] * y + s->e[i][2];
        const float all = e[0] + e[1] + e[2];
        EACH(i, 2) uv[i] = (e[0] * v[c[0]].uv[i] + e[1] * v[c[1]].uv[i] + e[2] * v[c[2]].uv[i]) / all;
        if (f->maps) EACH(i, 2) uv[i] = uv[i] * f->maps[s->material][i] + f->maps[s->material][i + 2];
        const int32_t at = texel_of(uv[1], t->height) * (t->width + 1) + texel_of(uv[0], t->width);
        if ((uint32_t)f->texels[t->first[0] + at] >> 30 < 2) return 0;
    }
    return m->color[3] > ((float)BAYER[py & 3][px & 3] + 0.5f) / 16;
}
