// The samples of a tile in which a triangle is the nearest surface.
//
// All functions compute the same numbers in the same order: the result does not depend on the choice between them. Of
// several triangles at the same depth, the first in `seen` is visible: the result does not depend on their order
// either. Bounds that decide about whole blocks include the rounding errors of the samples.
#pragma once
#include "draw_blocks.h"

// Maximum number of pixels of the bounding box of a small triangle.
#define FEW_PIXELS 4
// The same in groups of 4 x 2 pixels, for one sample.
#define FEW_GROUPS 2
// Maximum number of blocks that a triangle of medium size touches.
#define FEW_BLOCKS 8

// For small triangles: the samples of a pixel in lanes.
static inline void cover_few(const Frame *f, const Seen *s, int32_t number, const Box *b, Tile *t) {
    const F8 nearest = splat(t->nearest);
    const I8 unused = ~t->used;
    float w[3], e[3][3];
    EACH(n, 3) w[n] = s->w[n];
    EACH(i, 3) EACH(n, 3) e[i][n] = s->e[i][n];
    for (int py = b->y0; py <= b->y1; py++) {
        const F8 y = (float)(t->top + py) + 0.5f + t->dy, wy = w[1] * y + w[2];
        const F8 y0 = e[0][1] * y + e[0][2] + 0.0f, y1 = e[1][1] * y + e[1][2] + 0.0f,
                 y2 = e[2][1] * y + e[2][2] + 0.0f;
        for (int px = b->x0; px <= b->x1; px++) {
            const unsigned lane = (unsigned)px % LANES, row = (unsigned)py / BLOCK_ROWS,
                           line = (unsigned)py % BLOCK_ROWS;
            const F8 x = (float)lane + ((float)(t->left + px - (int)lane) + 0.5f + t->dx), z = w[0] * x + wy;
            const I8 out = unused | ~bits_of(z - nearest) | bits_of(e[0][0] * x + y0) | bits_of(e[1][0] * x + y1) |
                           bits_of(e[2][0] * x + y2);
            unsigned in = lanes_of(~out);
            if (!in) continue;
            const unsigned column = (unsigned)px / LANES, block = column * LANES + row;
            expand(f, t, (int)column, (int)row);
            t->high[column][row] = t->nearest;
            for (; in; in &= in - 1) {
                const int n = __builtin_ctz(in);
                float *inverse = (float *)&t->inverse[block][n][line] + lane;
                int32_t *shown = (int32_t *)&t->shown[block][n][line] + lane;
                if (is_nearer(z[n], number, *inverse, *shown)) *inverse = z[n], *shown = number;
            }
        }
    }
}

// For small triangles in images with one sample for each pixel, its centre: 4 x 2 pixels in lanes.
static inline void cover_centres(const Frame *f, const Seen *s, int32_t number, const Box *b, Tile *t) {
    const F8 nearest = splat(t->nearest);
    const I8 right = WHOLE_STEPS & 3, down = WHOLE_STEPS >> 2;
    float w[3], e[3][3];
    EACH(n, 3) w[n] = s->w[n];
    EACH(i, 3) EACH(n, 3) e[i][n] = s->e[i][n];
    for (int py = b->y0; py <= b->y1; py += 2) {
        const F8 y = to_float(down) + ((float)(t->top + py) + 0.5f), wy = w[1] * y + w[2];
        const F8 y0 = e[0][1] * y + e[0][2] + 0.0f, y1 = e[1][1] * y + e[1][2] + 0.0f,
                 y2 = e[2][1] * y + e[2][2] + 0.0f;
        for (int px = b->x0; px <= b->x1; px += 4) {
            const F8 x = to_float(right) + ((float)(t->left + px) + 0.5f), z = w[0] * x + wy;
            const I8 out = (b->x1 - px - right) | (b->y1 - py - down) | ~bits_of(z - nearest) |
                           bits_of(e[0][0] * x + y0) | bits_of(e[1][0] * x + y1) | bits_of(e[2][0] * x + y2);
            for (unsigned in = lanes_of(~out); in; in &= in - 1) {
                const int j = __builtin_ctz(in);
                const unsigned qx = (unsigned)(px + (j & 3)), qy = (unsigned)(py + (j >> 2)), lane = qx % LANES;
                const unsigned column = qx / LANES, row = qy / BLOCK_ROWS, line = qy % BLOCK_ROWS;
                const unsigned block = column * LANES + row;
                if (z[j] < t->low[column][row]) continue;
                expand(f, t, (int)column, (int)row);
                t->high[column][row] = t->nearest;
                float *inverse = (float *)&t->inverse[block][0][line] + lane;
                int32_t *shown = (int32_t *)&t->shown[block][0][line] + lane;
                if (is_nearer(z[j], number, *inverse, *shown)) *inverse = z[j], *shown = number;
            }
        }
    }
}

// For triangles in a few blocks.
static inline void cover_blocks(const Frame *f, const Seen *s, int32_t number, const Box *b, Tile *t,
                                const int samples) {
    const Extent x = extent_of(t, *b);
    const float error = error_of(t, s->w), most = largest(s->w, x) + error;
    const float errors[3] = {error_of(t, s->e[0]), error_of(t, s->e[1]), error_of(t, s->e[2])};
    for (int c = b->x0 / LANES; c <= b->x1 / LANES; c++)
        for (int row = b->y0 / BLOCK_ROWS; row <= b->y1 / BLOCK_ROWS; row++) {
            if (hidden(f, t, c, row, s->w, error, x)) continue;
            cover_block(f, s, number, t, c, row, b, errors, samples, 0, 0);
            if (most > t->high[c][row]) t->high[c][row] = most;
        }
}

// A block that is neither in front of a triangle nor behind it.
static inline void cover_some(const Frame *f, const Seen *s, int32_t number, const Box *b, Tile *t, int c, int row,
                              int inside, float error, const float *errors, const int samples, const int holes) {
    const int32_t flat = t->flat[c][row];
    if (flat != MANY) {
        const Box all = {c * LANES, row * BLOCK_ROWS, c * LANES + LANES - 1, row * BLOCK_ROWS + BLOCK_ROWS - 1};
        const Extent x = extent_of(t, all);
        const float *u = surface_of(f, t, flat), apart[3] = {s->w[0] - u[0], s->w[1] - u[1], s->w[2] - u[2]};
        const float both = 2 * (error + error_of(t, u));
        if (largest(apart, x) < -both) return;
        if (inside && smallest(apart, x) > both) {
            t->flat[c][row] = number;
            t->low[c][row] = smallest(s->w, x) - error, t->high[c][row] = largest(s->w, x) + error;
            return;
        }
    }
    if (inside)
        cover_block(f, s, number, t, c, row, b, errors, samples, 1, 0);
    else
        cover_block(f, s, number, t, c, row, b, errors, samples, 0, holes);
}

// Decides about whole blocks first: a column of blocks at a time, each block in a lane.
static inline void cover_many(const Frame *f, const Seen *s, int32_t number, const Box *b, Tile *t, const int samples,
                              const int holes) {
    const I8 first_row = WHOLE_STEPS * BLOCK_ROWS;
    const float wide = (float)(LANES - 1) + 2 * t->spread, high = (float)(BLOCK_ROWS - 1) + 2 * t->spread;
    const F8 y0 = STEPS * (float)BLOCK_ROWS + ((float)t->top + 0.5f - t->spread), y1 = y0 + high;
    const float *w = s->w, error = error_of(t, w),
                errors[3] = {error_of(t, s->e[0]), error_of(t, s->e[1]), error_of(t, s->e[2])};
    for (int c = b->x0 / LANES; c <= b->x1 / LANES; c++) {
        const float x0 = (float)(t->left + c * LANES) + 0.5f - t->spread, x1 = x0 + wide;
        // the sign of a lane decides
        I8 away = (first_row + (BLOCK_ROWS - 1) - b->y0) | (b->y1 - first_row);
        I8 out = (first_row - b->y0) | (b->y1 - (BLOCK_ROWS - 1) - first_row);
        EACH(i, 3) {
            const float *e = s->e[i], error_e = errors[i];
            const F8 least = e[0] * (e[0] > 0 ? x0 : x1) + (e[1] * (e[1] > 0 ? y0 : y1) + e[2]);
            const F8 most = e[0] * (e[0] > 0 ? x1 : x0) + (e[1] * (e[1] > 0 ? y1 : y0) + e[2]);
            away |= bits_of(most + error_e), out |= bits_of(least - error_e);
        }
        const F8 least = w[0] * (w[0] > 0 ? x0 : x1) + (w[1] * (w[1] > 0 ? y0 : y1) + w[2]) - error;
        const F8 most = w[0] * (w[0] > 0 ? x1 : x0) + (w[1] * (w[1] > 0 ? y1 : y0) + w[2]) + error;
        F8 *low = (F8 *)t->low[c], *highest = (F8 *)t->high[c];
        I8 *flat = (I8 *)t->flat[c];
        away |= bits_of(most - *low), out |= ~bits_of(most - t->nearest);
        if (holes || c * LANES < b->x0 || c * LANES + LANES - 1 > b->x1) out = splat_int(-1);
        const I8 front = (~(away | out) & bits_of(*highest - least)) < 0;
        const unsigned inside = lanes_of(~out);
        const I8 old = *flat;
        const F8 old_low = *low, old_high = *highest;
        NO_MASKED_STORE;
        *flat = pick_int(front, splat_int(number), old);
        *low = pick(front, least, old_low), *highest = pick(front, most, old_high);
        for (unsigned left = lanes_of(~away) & ~lanes_of(front); left; left &= left - 1) {
            const int r = __builtin_ctz(left);
            const int all = inside >> r & 1;
            cover_some(f, s, number, b, t, c, r, all, error, errors, samples, holes);
            if (t->flat[c][r] != MANY) continue;
            if (most[r] > t->high[c][r]) t->high[c][r] = most[r];
            if (all && least[r] > t->low[c][r]) t->low[c][r] = least[r];
        }
    }
}

// Writes a triangle into the samples where it is the nearest.
static inline void cover(const Frame *f, const Camera *k, int32_t number, Tile *t) {
    const Seen *s = f->seen + number;
    const int holes = f->materials[s->material].flags & (MASKED | DITHERED), left = t->left, top = t->top;
    const Bounds *all = f->bounds + number;
    const int x1 = all->x1 - left, y1 = all->y1 - top;
    Box b = {all->x0 > left ? all->x0 - left : 0, all->y0 > top ? all->y0 - top : 0, x1 < TILE ? x1 : TILE - 1,
             y1 < TILE ? y1 : TILE - 1};
    const int few =
        !holes && (b.x1 / LANES - b.x0 / LANES + 1) * (b.y1 / BLOCK_ROWS - b.y0 / BLOCK_ROWS + 1) <= FEW_BLOCKS;
    const int wide = b.x1 - b.x0, high = b.y1 - b.y0;
    if (few && t->samples == 1) {
        if ((wide / 4 + 1) * (high / 2 + 1) <= FEW_GROUPS)
            cover_centres(f, s, number, &b, t);
        else
            cover_blocks(f, s, number, &b, t, 1);
        return;
    }
    if (few) {
        if ((wide + 1) * (high + 1) <= FEW_PIXELS)
            cover_few(f, s, number, &b, t);
        else
            cover_blocks(f, s, number, &b, t, MOST_SAMPLES);
        return;
    }
    // pixels outside the image have no effect: with them, blocks at its edge can be inside
    if (all->x1 == k->width - 1) b.x1 = TILE - 1;
    if (all->y1 == k->height - 1) b.y1 = TILE - 1;
    if (holes)
        cover_many(f, s, number, &b, t, t->samples, 1);
    else if (t->samples == 1)
        cover_many(f, s, number, &b, t, 1, 0);
    else
        cover_many(f, s, number, &b, t, MOST_SAMPLES, 0);
}
