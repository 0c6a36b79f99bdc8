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

// The lines of a block, and their number in groups of lanes: samples at the same place of the pixels of a row.
#define GROUPS ((MOST_SAMPLES * BLOCK_ROWS + LANES - 1) / LANES)
typedef union {
    F8 groups[GROUPS];
    float each[GROUPS * LANES];
} Lines;

typedef struct {
    F8 inverse[COLUMNS * LANES][MOST_SAMPLES][BLOCK_ROWS];  // see `depth_at`
    I8 shown[COLUMNS * LANES][MOST_SAMPLES][BLOCK_ROWS];    // index of the triangle, -1 for none
    F8 dx, dy;                                              // the positions of the samples of a pixel
    I8 used;                                                // the lanes of samples
    F8 x[COLUMNS][MOST_SAMPLES];                            // the positions of the lines of a block, for each column
    Lines right;                                            // their samples from the centres of the pixels
    Lines y[LANES];                                         // and for each row of blocks
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
// The centres of the rows of a block, for the lines of two samples.
static const F8 ROWS = {0.5f, 1.5f, 2.5f, 3.5f, 0.5f, 1.5f, 2.5f, 3.5f};
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
    Lines depth;
    EACH(g, GROUPS) depth.groups[g] = w[1] * t->y[row].groups[g] + w[2];
    EACH(n, t->samples) {
        const F8 x = w[0] * t->x[column][n];
        EACH(r, BLOCK_ROWS) {
            t->inverse[block][n][r] = x + depth.each[n * BLOCK_ROWS + r], t->shown[block][n][r] = splat_int(who);
        }
    }
    t->flat[column][row] = MANY;
}

// Gives samples in which a surface has holes a negative depth.
static inline F8 without_holes(const Frame *f, const Seen *s, F8 z, F8 old, F8 x, float y, int px, int py) {
    EACH_LANE(j) if (z[j] >= old[j] && !opaque(f, s, x[j], y, px + j, py)) z[j] = -1;
    return z;
}

// Eight lines between two columns of pixels: the sign of a lane is set if no sample is inside of an edge. `above` is
// the part of the edge that is the same for a line, `right` the distance of the samples from the centres of their
// pixels.
static inline I8 misses_edge(const float *e, float error, float x0, float x1, F8 above, F8 right) {
    return bits_of(above + (e[0] * right + (e[0] * (e[0] > 0 ? x1 : x0) + error)));
}

// The same as `cover_lines` below for one sample for each pixel, its centre, and surfaces without holes: all rows at a
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
// The lines of a block are the samples at the same place of the pixels of a row, in the order of Tile.inverse. What is
// the same for all samples of a line is computed for eight lines at a time; lines without a sample inside are left out.
//
// The signs of all conditions are collected in the sign of 1 / depth, which is positive for visible surfaces: compilers
// narrow masks of several comparisons, and widen the result again.
static ALWAYS_INLINE void cover_lines(const Frame *f, const Seen *s, int32_t number, Tile *t, int column, int row,
                                      const Box *b, const float *errors, const int samples, const int inside,
                                      const int holes) {
    const int left = t->left + column * LANES, top = t->top + row * BLOCK_ROWS, block = column * LANES + row;
    float w[3], e[3][3];
    EACH(n, 3) w[n] = s->w[n];
    EACH(i, 3) EACH(n, 3) e[i][n] = s->e[i][n];
    Lines depth, base[3];
    const Lines *y = t->y + row;
    unsigned lines = (1u << samples * BLOCK_ROWS) - 1;
    if (!inside) {
        const int first = column * LANES, last = first + LANES - 1;
        const float x0 = (float)(t->left + (b->x0 > first ? b->x0 : first)) + 0.5f,
                    x1 = (float)(t->left + (b->x1 < last ? b->x1 : last)) + 0.5f;
        const float y0 = (float)(t->top + b->y0), y1 = (float)(t->top + b->y1 + 1);
        unsigned out = 0;
        EACH(g, GROUPS) {
            // the positions of samples are inside of their pixels
            I8 away = bits_of(y->groups[g] - y0) | bits_of(y1 - y->groups[g]);
            EACH(i, 3) {
                base[i].groups[g] = e[i][1] * y->groups[g] + e[i][2] + 0.0f;
                away |= misses_edge(e[i], errors[i], x0, x1, base[i].groups[g], t->right.groups[g]);
            }
            out |= lanes_of(away) << g * LANES;
        }
        lines &= ~out;
        if (!lines) return;
    }
    EACH(g, GROUPS) depth.groups[g] = w[1] * y->groups[g] + w[2];
    expand(f, t, column, row);
    const F8 nearest = splat(t->nearest);
    const I8 who = splat_int(number), at = WHOLE_STEPS + column * LANES;
    const I8 beside = inside ? splat_int(0) : (at - b->x0) | (b->x1 - at);
    for (; lines; lines &= lines - 1) {
        const int line = __builtin_ctz(lines), n = line / BLOCK_ROWS, r = line % BLOCK_ROWS;
        F8 *inverse = (F8 *)t->inverse[block] + line;
        I8 *shown = (I8 *)t->shown[block] + line;
        const F8 x = t->x[column][n];
        F8 z = w[0] * x + depth.each[line];
        if (!inside) {
            const I8 out = beside | bits_of(e[0][0] * x + base[0].each[line]) |
                           bits_of(e[1][0] * x + base[1].each[line]) | bits_of(e[2][0] * x + base[2].each[line]) |
                           (z >= nearest);
            z = pick(out < 0, splat(-1), z);
        }
        const F8 old = *inverse;
        if (holes) z = without_holes(f, s, z, old, x, y->each[line], left + n, top + r + 2 * n);
        const I8 before = *shown, mine = nearer(z, who, old, before);
        NO_MASKED_STORE;
        *inverse = pick(mine, z, old), *shown = pick_int(mine, who, before);
    }
}

// The loops are compiled once for each case: without this, compilers test the case for each line.
static __attribute__((noinline)) void cover_lines_in(const Frame *f, const Seen *s, int32_t number, Tile *t, int column,
                                                     int row, const Box *b, const float *errors) {
    cover_lines(f, s, number, t, column, row, b, errors, MOST_SAMPLES, 0, 0);
}

static __attribute__((noinline)) void cover_all_lines(const Frame *f, const Seen *s, int32_t number, Tile *t,
                                                      int column, int row) {
    cover_lines(f, s, number, t, column, row, NULL, NULL, MOST_SAMPLES, 1, 0);
}

static __attribute__((noinline)) void cover_lines_with_holes(const Frame *f, const Seen *s, int32_t number, Tile *t,
                                                             int column, int row, const Box *b, const float *errors) {
    cover_lines(f, s, number, t, column, row, b, errors, t->samples, 0, 1);
}

static inline void cover_block(const Frame *f, const Seen *s, int32_t number, Tile *t, int column, int row,
                               const Box *b, const float *errors, const int samples, const int inside,
                               const int holes) {
    if (holes)
        cover_lines_with_holes(f, s, number, t, column, row, b, errors);
    else if (samples == 1)
        cover_block_centres(f, s, number, t, column, row, b, inside);
    else if (inside)
        cover_all_lines(f, s, number, t, column, row);
    else
        cover_lines_in(f, s, number, t, column, row, b, errors);
}

// Empties a tile.
static inline void clear(const Frame *f, const Camera *k, Tile *t, int left, int top, int samples) {
    const float least = k->parallel ? reach_of(k) - k->far : 1 / k->far;
    t->left = left, t->top = top, t->samples = samples;
    t->nearest = k->parallel ? reach_of(k) - k->near : 1 / k->near, t->spread = samples > 1 ? SPREAD : 0;
    t->empty[0] = t->empty[1] = 0, t->empty[2] = least;
    EACH(c, COLUMNS) * (I8 *)t->flat[c] = splat_int(-1), *(F8 *)t->low[c] = *(F8 *)t->high[c] = splat(least);
    t->dx = t->dy = splat(0), t->used = splat_int(0);
    EACH(c, COLUMNS) EACH(n, samples) { t->x[c][n] = STEPS + ((float)(left + c * LANES) + 0.5f + f->samples[2 * n]); }
    Lines down;
    EACH(line, GROUPS * LANES) {
        const int n = line / BLOCK_ROWS;
        t->right.each[line] = n < samples ? f->samples[2 * n] : 0;
        down.each[line] = n < samples ? f->samples[2 * n + 1] : 0;
    }
    EACH(row, LANES) EACH(g, GROUPS) {
        t->y[row].groups[g] = ((float)(top + row * BLOCK_ROWS) + ROWS) + down.groups[g];
    }
    EACH(n, samples) t->dx[n] = f->samples[2 * n], t->dy[n] = f->samples[2 * n + 1], t->used[n] = -1;
}
