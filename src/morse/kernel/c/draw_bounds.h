// The bounds of the texels in the blocks of a shadow map: most points are lit, or in the shadow, as their whole block
// is.
//
// The bounds of a block are two parallel planes, because the surfaces that the sun shines on are not perpendicular to
// its light.
#pragma once
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "drawing.h"
#include "simd.h"

// Side of a block, and of the texels whose bounds it has: all that are read for a point in the block.
#define SIDE (1 << SHADOW_SHIFT)
#define READ (SIDE + 3)
// Largest difference of neighbours on a surface, m.
#define STEEPEST 10.0f
// Smaller texels have no surface: all points are lit, without rounding errors.
#define LOWEST -1e20f
// Bound of rounding errors, relative to the terms.
#define ROUNDED 1e-6f

static inline int32_t lower_of(int32_t a, int32_t b) { return a < b ? a : b; }

// The slope between two texels; 0 if it is that of an edge, not of a surface.
static inline float slope(float from, float to) {
    const float s = to - from;
    return s > -STEEPEST && s < STEEPEST ? s : 0;
}

// Whether the texels from some columns and rows to before others show no surface.
static inline int is_blank(const float *texels, int32_t width, int32_t x, int32_t y, int32_t right, int32_t bottom) {
    I8 found = splat_int(0);
    for (int32_t row = y; row < bottom; row++)
        for (int32_t from = x; from < right; from += LANES) {
            F8 t;
            memcpy(&t, texels + (int64_t)row * width + lower_of(from, right - LANES), sizeof t);
            found |= t > splat(LOWEST);
        }
    return !any(found);
}

// Whether nothing casts a shadow on the points for which a block with these bounds is read.
static inline int is_lit_block(const ShadowBlock *b) { return b->high <= LOWEST; }

// The bounds of a block whose texels begin at a column and a row.
static inline ShadowBlock bound(const float *texels, int32_t width, int32_t height, int32_t x, int32_t y) {
    const int32_t right = lower_of(x + READ, width), bottom = lower_of(y + READ, height);
    const float first = texels[(int64_t)y * width + x];
    if (is_blank(texels, width, x, y, right, bottom)) return (ShadowBlock){0, 0, first, first};
    const float *middle =
        texels + (int64_t)lower_of(y + SIDE / 2, bottom - 2) * width + lower_of(x + SIDE / 2, right - 2);
    const float across = slope(middle[0], middle[1]), down = slope(middle[0], middle[width]);
    const F8 ramp = (F8){0, 1, 2, 3, 4, 5, 6, 7} * across;
    F8 low = splat(INFINITY), high = splat(-INFINITY), most = splat(0);
    for (int32_t row = y; row < bottom; row++) {
        // the last columns are read twice if the block is narrow or its width is no multiple of the lanes
        for (int32_t from = x; from < right; from += LANES) {
            const int32_t column = lower_of(from, right - LANES);
            F8 t;
            memcpy(&t, texels + (int64_t)row * width + column, sizeof t);
            most = greater(most, pick(t > splat(LOWEST), greater(t, -t), splat(0)));
            t -= ramp + ((float)(column - x) * across + (float)(row - y) * down);
            low = lesser(t, low), high = greater(t, high);
        }
    }
    float l = low[0], h = high[0], m = most[0];
    for (int j = 1; j < LANES; j++) {
        l = low[j] < l ? low[j] : l, h = high[j] > h ? high[j] : h, m = most[j] > m ? most[j] : m;
    }
    // the planes bound all texels that are read for a point, which are up to three columns and rows farther
    const float margin = m * ROUNDED + READ * ROUNDED * (fabsf(across) + fabsf(down));
    const float up = (across > 0 ? across : 0) + (down > 0 ? down : 0), fall = across + down - up;
    return (ShadowBlock){across, down, l + 3 * fall - margin, h + 3 * up + margin};
}

// The blocks for which a texel of a rectangle is read: x0, y0, x1, y1, one past the end.
typedef struct {
    int32_t x0, y0, x1, y1;
} Blocks;

static inline Blocks blocks_of(const int32_t *rectangle) {
    const int32_t x = rectangle[0], y = rectangle[1];
    if (x >= rectangle[2] || y >= rectangle[3]) return (Blocks){0, 0, 0, 0};
    return (Blocks){(x > READ ? x - READ + 1 : 0) / SIDE, (y > READ ? y - READ + 1 : 0) / SIDE,
                    (rectangle[2] + SIDE - 1) / SIDE, (rectangle[3] + SIDE - 1) / SIDE};
}

static inline int64_t blocks_across(int32_t width) { return (width + SIDE - 1) / SIDE; }
