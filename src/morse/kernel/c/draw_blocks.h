// The samples of a tile, in blocks of 8 x 4 pixels.
//
// Most blocks show a single triangle. Such a block has no samples, only the number of the triangle: its depths follow
// from the plane of the triangle when another triangle comes near.
#pragma once
#include <math.h>

#include "draw_holes.h"
#include "drawing.h"
#include "simd.h"

// Rows of pixels of a block, which is LANES wide; a tile has COLUMNS columns of LANES blocks.
#define BLOCK_ROWS 4
#define COLUMNS (TILE / LANES)
// The triangle of a block with several triangles.
#define MANY (-2)
// Largest distance of a sample from the centre of its pixel, along an axis.
#define SPREAD 0.4f
// Bound of the rounding error of a plane, relative to the sum of its terms.
#define ROUNDING (1.0f / (1 << 20))

typedef struct {
    F8 inverse[COLUMNS * LANES][MOST_SAMPLES][BLOCK_ROWS];  // 1 / depth
    I8 shown[COLUMNS * LANES][MOST_SAMPLES][BLOCK_ROWS];    // index of the triangle, -1 for none
    F8 dx, dy;                                              // the positions of the samples of a pixel
    I8 used;                                                // the lanes of samples
    // of each column, with one number for each block: arrays, because lanes of vectors are accessed by copies of them
    int32_t flat[COLUMNS][LANES] __attribute__((aligned(32)));  // the only triangle, -1 for none, or MANY
    float low[COLUMNS][LANES] __attribute__((aligned(32)));     // bounds of 1 / depth of all samples
    float high[COLUMNS][LANES] __attribute__((aligned(32)));
    int32_t left, top, samples;
    float spread, nearest, empty[3];  // 1 / depth of the near plane, and the plane without a surface
} Tile;

// Pixels of a tile, inclusive.
typedef struct {
    int x0, y0, x1, y1;
} Box;

// Positions of the outermost samples of some pixels.
typedef struct {
    float x0, y0, x1, y1;
} Extent;

static const F8 STEPS = {0, 1, 2, 3, 4, 5, 6, 7};
#define SIGNS INT32_MIN

static const I8 WHOLE_STEPS = {0, 1, 2, 3, 4, 5, 6, 7};

static inline Extent extent_of(const Tile *t, Box b) {
    const float by = t->spread, x = (float)t->left + 0.5f, y = (float)t->top + 0.5f;
    return (Extent){x + (float)b.x0 - by, y + (float)b.y0 - by, x + (float)b.x1 + by, y + (float)b.y1 + by};
}

// Bound of the rounding error of a plane in a tile.
static inline float error_of(const Tile *t, const float *p) {
    return (fabsf(p[0]) * (float)(t->left + TILE) + fabsf(p[1]) * (float)(t->top + TILE) + fabsf(p[2])) * ROUNDING;
}

static inline float largest(const float *p, Extent x) {
    return p[0] * (p[0] > 0 ? x.x1 : x.x0) + p[1] * (p[1] > 0 ? x.y1 : x.y0) + p[2];
}

static inline float smallest(const float *p, Extent x) {
    return p[0] * (p[0] > 0 ? x.x0 : x.x1) + p[1] * (p[1] > 0 ? x.y0 : x.y1) + p[2];
}

static inline const float *surface_of(const Frame *f, const Tile *t, int32_t who) {
    return who < 0 ? t->empty : f->seen[who].w;
}

// 1 / depth of eight samples in a row of a plane.
static inline F8 row_of(const float *w, F8 x, float y) { return w[0] * x + (w[1] * y + w[2]); }

// The part of an edge that is the same for a row. Never -0, so that the sign of the whole decides.
static inline float above(const float *e, float y) { return e[1] * y + e[2] + 0.0f; }

// Whether a triangle replaces another one, or none, in a sample.
static inline int is_nearer(float inverse, int32_t who, float old, int32_t before) {
    return inverse > old || (inverse == old && who < before);
}

// The same for eight samples; `old` is positive. The bits of positive numbers are in the order of the numbers, and
// those of negative ones are negative.
static inline I8 nearer(F8 inverse, I8 who, F8 old, I8 before) {
    return bits_of(inverse) > bits_of(old) + (who < before);
}

// Whether a plane is behind everything that a block shows in some of its pixels.
static inline int hidden(const Frame *f, const Tile *t, int column, int row, const float *w, float error, Extent x) {
    const int32_t flat = t->flat[column][row];
    if (largest(w, x) + error < t->low[column][row]) return 1;
    if (flat == MANY) return 0;
    const float *u = surface_of(f, t, flat), apart[3] = {w[0] - u[0], w[1] - u[1], w[2] - u[2]};
    return largest(apart, x) < -2 * (error + error_of(t, u));
}

// Gives a block its samples.
static inline void expand(const Frame *f, Tile *t, int column, int row) {
    const int32_t who = t->flat[column][row];
    if (who == MANY) return;
    const float *w = surface_of(f, t, who);
    const int block = column * LANES + row;
    EACH(n, t->samples) {
        const F8 x = STEPS + ((float)(t->left + column * LANES) + 0.5f + f->samples[2 * n]);
        EACH(r, BLOCK_ROWS) {
            const float y = (float)(t->top + row * BLOCK_ROWS + r) + 0.5f + f->samples[2 * n + 1];
            t->inverse[block][n][r] = row_of(w, x, y), t->shown[block][n][r] = splat_int(who);
        }
    }
    t->flat[column][row] = MANY;
}

// Gives samples in which a surface has holes a negative depth.
static inline F8 without_holes(const Frame *f, const Seen *s, F8 z, F8 old, F8 x, float y, int px, int py) {
    EACH_LANE(j) if (z[j] >= old[j] && !opaque(f, s, x[j], y, px + j, py)) z[j] = -1;
    return z;
}

// The rows of a block in which a triangle may cover a sample between two columns of pixels, a bit for each.
static inline unsigned rows_of(const Tile *t, const float e[3][3], const float *errors, int row, Box b) {
    const Extent x = extent_of(t, b);
    const F8 y = STEPS + ((float)(t->top + row * BLOCK_ROWS) + 0.5f);
    I8 out = splat_int(0);
    EACH(i, 3) {
        const float at = e[i][0] * (e[i][0] > 0 ? x.x1 : x.x0) + fabsf(e[i][1]) * t->spread;
        out |= bits_of(e[i][1] * y + (at + e[i][2] + errors[i]));
    }
    return ~lanes_of(out);
}

// The same as `cover_block` below for one sample for each pixel, its centre, and surfaces without holes: all rows at a
// time, because the processor would predict their number wrongly.
static inline void cover_block_centres(const Frame *f, const Seen *s, int32_t number, Tile *t, int column, int row,
                                       const Box *b, const int inside) {
    const F8 nearest = splat(t->nearest), x = STEPS + ((float)(t->left + column * LANES) + 0.5f), wx = s->w[0] * x;
    const I8 who = splat_int(number), at = WHOLE_STEPS + column * LANES, beside = (at - b->x0) | (b->x1 - at);
    const int top = t->top + row * BLOCK_ROWS, block = column * LANES + row;
    const F8 x0 = s->e[0][0] * x, x1 = s->e[1][0] * x, x2 = s->e[2][0] * x;
    float base[3][BLOCK_ROWS], depth[BLOCK_ROWS];
    EACH(r, BLOCK_ROWS) {
        const float y = (float)(top + r) + 0.5f;
        EACH(i, 3) base[i][r] = above(s->e[i], y);
        depth[r] = s->w[1] * y + s->w[2];
        // no sample is inside the edges of the other rows
        const int py = row * BLOCK_ROWS + r;
        if (!inside && (py < b->y0 || py > b->y1)) base[0][r] = -INFINITY;
    }
    expand(f, t, column, row);
    F8 *inverse = t->inverse[block][0];
    I8 *shown = t->shown[block][0];
    EACH(r, BLOCK_ROWS) {
        F8 z = wx + depth[r];
        if (!inside) {
            const I8 out = beside | bits_of(x0 + base[0][r]) | bits_of(x1 + base[1][r]) | bits_of(x2 + base[2][r]) |
                           ~bits_of(z - nearest);
            z = from_bits(bits_of(z) | (out & SIGNS));
        }
        const F8 old = inverse[r];
        const I8 before = shown[r], mine = nearer(z, who, old, before);
        NO_MASKED_STORE;
        inverse[r] = pick(mine, z, old), shown[r] = pick_int(mine, who, before);
    }
}

// Writes a triangle into the samples of a block where it is the nearest; `inside` if it contains all of them.
//
// The signs of all conditions are collected in the sign of 1 / depth, which is positive for visible surfaces: compilers
// narrow masks of several comparisons, and widen the result again.
static inline void cover_block(const Frame *f, const Seen *s, int32_t number, Tile *t, int column, int row,
                               const Box *b, const float *errors, const int samples, const int inside,
                               const int holes) {
    if (samples == 1 && !holes) {
        cover_block_centres(f, s, number, t, column, row, b, inside);
        return;
    }
    const F8 nearest = splat(t->nearest);
    const I8 who = splat_int(number), at = WHOLE_STEPS + column * LANES, beside = (at - b->x0) | (b->x1 - at);
    const int left = t->left + column * LANES, top = t->top + row * BLOCK_ROWS, block = column * LANES + row;
    float w[3], e[3][3];
    EACH(n, 3) w[n] = s->w[n];
    EACH(i, 3) EACH(n, 3) e[i][n] = s->e[i][n];
    unsigned rows = (1u << BLOCK_ROWS) - 1;
    if (!inside) {
        const int first = b->y0 - row * BLOCK_ROWS, last = b->y1 - row * BLOCK_ROWS, end = column * LANES + LANES - 1;
        if (first > 0) rows &= rows << first;
        if (last < BLOCK_ROWS - 1) rows &= (2u << last) - 1;
        const Box part = {b->x0 > column * LANES ? b->x0 : column * LANES, b->y0, b->x1 < end ? b->x1 : end, b->y1};
        // with one sample, the test takes as long as the rows that it saves
        if (samples > 1) rows &= rows_of(t, e, errors, row, part);
        if (!rows) return;
    }
    expand(f, t, column, row);
    EACH(n, samples) {
        const F8 x = STEPS + ((float)left + 0.5f + f->samples[2 * n]), wx = w[0] * x;
        const F8 x0 = e[0][0] * x, x1 = e[1][0] * x, x2 = e[2][0] * x;
        const float down = f->samples[2 * n + 1];
        for (unsigned more = rows; more; more &= more - 1) {
            const int r = __builtin_ctz(more);
            const float y = (float)(top + r) + 0.5f + down;
            F8 *inverse = &t->inverse[block][n][r];
            I8 *shown = &t->shown[block][n][r];
            F8 z = wx + (w[1] * y + w[2]);
            if (!inside) {
                const F8 y0 = x0 + above(e[0], y), y1 = x1 + above(e[1], y), y2 = x2 + above(e[2], y);
                const I8 out = beside | bits_of(y0) | bits_of(y1) | bits_of(y2) | ~bits_of(z - nearest);
                z = from_bits(bits_of(z) | (out & SIGNS));
            }
            const F8 old = *inverse;
            if (holes) z = without_holes(f, s, z, old, x, y, left + n, top + r + 2 * n);
            const I8 before = *shown, mine = nearer(z, who, old, before);
            NO_MASKED_STORE;
            *inverse = pick(mine, z, old), *shown = pick_int(mine, who, before);
        }
    }
}

// Empties a tile.
static inline void clear(const Frame *f, Tile *t, int left, int top, int samples, float near, float far) {
    t->left = left, t->top = top, t->samples = samples, t->nearest = 1 / near, t->spread = samples > 1 ? SPREAD : 0;
    t->empty[0] = t->empty[1] = 0, t->empty[2] = 1 / far;
    EACH(c, COLUMNS) * (I8 *)t->flat[c] = splat_int(-1), *(F8 *)t->low[c] = *(F8 *)t->high[c] = splat(1 / far);
    t->dx = t->dy = splat(0), t->used = splat_int(0);
    EACH(n, samples) t->dx[n] = f->samples[2 * n], t->dy[n] = f->samples[2 * n + 1], t->used[n] = -1;
}
