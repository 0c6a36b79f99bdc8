// The tiles in which a triangle may be visible.
#pragma once
#include "drawing.h"

static inline int32_t tiles_across(const Camera *k) { return (k->width + TILE - 1) / TILE; }
static inline int32_t tiles_of(const Camera *k) { return tiles_across(k) * ((k->height + TILE - 1) / TILE); }

// Whether a triangle does not touch a tile.
static int misses(const Seen *s, float x, float y) {
    EACH(i, 3) {
        const float *e = s->e[i];
        if (e[0] * (e[0] > 0 ? x + TILE : x) + e[1] * (e[1] > 0 ? y + TILE : y) + e[2] < 0) return 1;
    }
    return 0;
}

// Counts a triangle in its tiles; with `firsts` of the camera, lists it there as well.
static inline void add_to_tiles(const Frame *f, const Camera *k, int64_t number, int32_t *share,
                                const int64_t *firsts) {
    const Bounds *b = f->bounds + number;
    const int x0 = b->x0 / TILE, y0 = b->y0 / TILE, x1 = b->x1 / TILE, y1 = b->y1 / TILE, across = tiles_across(k);
    const int large = x1 - x0 + y1 - y0 > 1;
    for (int y = y0; y <= y1; y++)
        for (int x = x0; x <= x1; x++) {
            if (large && misses(f->seen + number, (float)(x * TILE), (float)(y * TILE))) continue;
            const int tile = y * across + x, at = share[tile]++;
            if (firsts) f->members[firsts[tile] + at] = (int32_t)number;
        }
}
