// The samples of a tile in which a triangle is the nearest surface.
//
// Both functions compute the same numbers in the same order: the result does not depend on the choice between them.
#pragma once
#include "draw_holes.h"
#include "drawing.h"
#include "simd.h"

// Maximum number of groups of lanes for the bounding box of a small triangle.
#define FEW_GROUPS 6
// Bound of the rounding error of a plane, relative to the sum of its terms.
#define ROUNDING (1.0f / (1 << 20))

typedef struct {
    float inverse[MOST_SAMPLES][TILE * TILE];  // 1 / depth
    int32_t shown[MOST_SAMPLES][TILE * TILE];  // index of the triangle, -1 for none
    F8 dx, dy;                 // the positions of the lanes of a group: the samples of a pixel, or 4 x 2
    I8 lane_x, lane_y;         // pixels of the lanes
    I8 used;                   // the lanes in use
    int32_t group_x, group_y;  // logarithms of the pixels of a group
    int32_t left, top, samples;
    float nearest;  // 1 / depth of the near plane
} __attribute__((aligned(32))) Tile;

// Pixels of a triangle in a tile, inclusive.
typedef struct {
    int x0, y0, x1, y1;
} Box;

static const F8 STEPS = {0, 1, 2, 3, 4, 5, 6, 7};
static const I8 WHOLE_STEPS = {0, 1, 2, 3, 4, 5, 6, 7};

static inline void show(const Frame *f, const Seen *s, int32_t number, Tile *t, int sample, int x, int y, float fx,
                        float fy, float w, int holes) {
    const int32_t at = (y - t->top) * TILE + x;
    if (!(w > t->inverse[sample][at])) return;
    if (holes && !opaque(f, s, fx, fy, t->left + x + sample, y + 2 * sample)) return;
    t->inverse[sample][at] = w, t->shown[sample][at] = number;
}

static inline F8 plane(const float *p, F8 x, F8 y) { return p[0] * x + (p[1] * y + p[2]); }

// For small triangles: a group of lanes for each pixel, or with one sample for 4 x 2 pixels.
static inline void cover_few(const Frame *f, const Seen *s, int32_t number, Box b, Tile *t, int holes) {
    const F8 zero = splat(0), nearest = splat(t->nearest);
    for (int y = b.y0; y <= b.y1; y += 1 << t->group_y) {
        const F8 fy = (float)y + 0.5f + t->dy;
        for (int x = b.x0; x <= b.x1; x += 1 << t->group_x) {
            const F8 fx = (float)(x & (LANES - 1)) + ((float)(t->left + (x & ~(LANES - 1))) + 0.5f + t->dx);
            const F8 w = plane(s->w, fx, fy);
            const I8 in = t->used & (t->lane_x <= b.x1 - x) & (t->lane_y <= b.y1 - y) & (w < nearest) &
                          (plane(s->e[0], fx, fy) >= zero) & (plane(s->e[1], fx, fy) >= zero) &
                          (plane(s->e[2], fx, fy) >= zero);
            if (!any(in)) continue;
            EACH_LANE(j) if (in[j]) {
                const int px = x + t->lane_x[j], py = y + t->lane_y[j];
                show(f, s, number, t, t->samples > 1 ? j : 0, px, py, fx[j], fy[j], w[j], holes);
            }
        }
    }
}

// The first and the last pixel that a triangle may cover in each of eight rows from `y` on.
static inline void reach(const float e[3][3], const float *least, Box b, int left, int y, I8 *first, I8 *last) {
    const F8 fy = STEPS + ((float)y + 0.5f);
    F8 low = splat((float)b.x0), high = splat((float)b.x1);
    EACH(i, 3) {
        const F8 rest = least[i] - (e[i][1] * fy + e[i][2]), x = rest * (1 / e[i][0]) - ((float)left + 0.5f);
        if (e[i][0] == 0) high = pick(rest > splat(0), splat(-1), high);
        if (e[i][0] > 0) low = greater(x, low);
        if (e[i][0] < 0) high = lesser(x + 0.25f, high);
    }
    // clamped, so that the conversion is defined; rows outside the tile are empty
    *first = to_int(lesser(low, splat(TILE))), *last = to_int(greater(high, splat(-1)));
}

// The minimum edge values at the centre of a pixel for which the triangle covers a sample.
static inline void least_of(const Frame *f, const Tile *t, const float e[3][3], int samples, float *least) {
    EACH(i, 3) {
        float most = 0;
        EACH(n, samples) {
            const float by = e[i][0] * f->samples[2 * n] + e[i][1] * f->samples[2 * n + 1];
            most = by > most ? by : most;
        }
        const float x = fabsf(e[i][0]) * (float)(t->left + TILE), y = fabsf(e[i][1]) * (float)(t->top + TILE);
        least[i] = -most - (x + y + fabsf(e[i][2])) * ROUNDING;
    }
}

// Eight pixels in lanes, row by row.
static inline void cover_many(const Frame *f, const Seen *s, int32_t number, Box b, Tile *t, const int samples) {
    const F8 zero = splat(0), nearest = splat(t->nearest);
    const I8 who = splat_int(number);
    const float w0 = s->w[0], w1 = s->w[1], w2 = s->w[2];
    const int left = t->left, top = t->top;
    float e[3][3], least[3];
    I8 first, last;
    EACH(i, 3) EACH(n, 3) e[i][n] = s->e[i][n];
    least_of(f, t, e, samples, least);
    for (int y = b.y0; y <= b.y1; y++) {
        const int row = (y - b.y0) & (LANES - 1);
        if (!row) reach(e, least, b, left, y, &first, &last);
        const int x0 = first[row], x1 = last[row];
        if (x0 > x1) continue;
        EACH(n, samples) {
            const float sx = f->samples[2 * n], fy = (float)y + 0.5f + f->samples[2 * n + 1];
            const float r0 = e[0][1] * fy + e[0][2], r1 = e[1][1] * fy + e[1][2], r2 = e[2][1] * fy + e[2][2];
            const float rw = w1 * fy + w2;
            for (int x = x0 & ~(LANES - 1); x <= x1; x += LANES) {
                F8 *inverse = (F8 *)(t->inverse[n] + (y - top) * TILE + x);
                I8 *shown = (I8 *)(t->shown[n] + (y - top) * TILE + x);
                const F8 fx = STEPS + ((float)(left + x) + 0.5f + sx), w = w0 * fx + rw, old = *inverse;
                const I8 at = WHOLE_STEPS + x, before = *shown;
                NO_MASKED_STORE;
                const I8 mine = (at >= x0) & (at <= x1) & (w > old) & (w < nearest) & (e[0][0] * fx + r0 >= zero) &
                                (e[1][0] * fx + r1 >= zero) & (e[2][0] * fx + r2 >= zero);
                *inverse = pick(mine, w, old), *shown = pick_int(mine, who, before);
            }
        }
    }
}

// Writes a triangle into the samples where it is the nearest.
static inline void cover(const Frame *f, int32_t number, Tile *t) {
    const Seen *s = f->seen + number;
    const int right = t->left + TILE - 1, bottom = t->top + TILE - 1;
    const int holes = f->materials[s->material].flags & (MASKED | DITHERED);
    const Box b = {(s->x0 > t->left ? s->x0 : t->left) - t->left, s->y0 > t->top ? s->y0 : t->top,
                   (s->x1 < right ? s->x1 : right) - t->left, s->y1 < bottom ? s->y1 : bottom};
    const int across = ((b.x1 - b.x0) >> t->group_x) + 1, down = ((b.y1 - b.y0) >> t->group_y) + 1;
    if (holes || across * down <= FEW_GROUPS)
        cover_few(f, s, number, b, t, holes);
    else if (t->samples == 1)
        cover_many(f, s, number, b, t, 1);
    else
        cover_many(f, s, number, b, t, t->samples);
}

// Empties a tile.
static inline void clear(const Frame *f, Tile *t, int left, int top, int samples, float near, float far) {
    t->left = left, t->top = top, t->samples = samples, t->nearest = 1 / near;
    t->dx = t->dy = splat(0), t->lane_x = t->lane_y = t->used = splat_int(0), t->group_x = t->group_y = 0;
    EACH(n, samples) t->dx[n] = f->samples[2 * n], t->dy[n] = f->samples[2 * n + 1], t->used[n] = -1;
    if (samples == 1) {
        t->group_x = 2, t->group_y = 1, t->used = splat_int(-1);
        t->lane_x = WHOLE_STEPS & 3, t->lane_y = WHOLE_STEPS >> 2;
        t->dx = to_float(t->lane_x) + f->samples[0], t->dy = to_float(t->lane_y) + f->samples[1];
    }
    EACH(n, samples) EACH(i, TILE * TILE) t->inverse[n][i] = 1 / far, t->shown[n][i] = -1;
}
