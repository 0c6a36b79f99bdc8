// The bounds of the texels in the blocks of a shadow map: most points are lit, or in the shadow, as their whole block
// is.
//
// The bounds of a block are two parallel planes, because the surfaces that the sun shines on are not perpendicular to
// its light.
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "drawing.h"
#include "export.h"
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

static const I8 WHOLE_STEPS = {0, 1, 2, 3, 4, 5, 6, 7};

MORSE_EXPORT void morse_draw_bounds(const float *texels, int32_t width, int32_t height, ShadowBlock *bounds,
                                    const int32_t (*rectangles)[4], int32_t count);

static inline int32_t least(int32_t a, int32_t b) { return a < b ? a : b; }

// The slope between two texels; 0 if it is that of an edge, not of a surface.
static inline float slope(float from, float to) {
    const float s = to - from;
    return s > -STEEPEST && s < STEEPEST ? s : 0;
}

// The bounds of a block whose texels begin at a column and a row.
static inline ShadowBlock bound(const float *texels, int32_t width, int32_t height, int32_t x, int32_t y) {
    const int32_t right = least(x + READ, width), bottom = least(y + READ, height);
    const float *middle = texels + (int64_t)least(y + SIDE / 2, bottom - 2) * width + least(x + SIDE / 2, right - 2);
    const float across = slope(middle[0], middle[1]), down = slope(middle[0], middle[width]);
    const F8 ramp = to_float(WHOLE_STEPS) * across;
    F8 low = splat(INFINITY), high = splat(-INFINITY), most = splat(0);
    for (int32_t row = y; row < bottom; row++) {
        // the last columns are read twice if the block is narrow or its width is no multiple of the lanes
        for (int32_t from = x; from < right; from += LANES) {
            const int32_t first = least(from, right - LANES);
            F8 t;
            memcpy(&t, texels + (int64_t)row * width + first, sizeof t);
            most = greater(most, pick(t > splat(LOWEST), greater(t, -t), splat(0)));
            t -= ramp + ((float)(first - x) * across + (float)(row - y) * down);
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

// Sets the bounds of all blocks for which a texel of a rectangle is read: x0, y0, x1, y1, one past the end.
static void bound_all(const float *texels, int32_t width, int32_t height, ShadowBlock *bounds,
                      const int32_t *rectangle) {
    const int32_t x0 = rectangle[0], y0 = rectangle[1], x1 = rectangle[2], y1 = rectangle[3];
    const int32_t across = (width + SIDE - 1) / SIDE;
    if (x0 >= x1 || y0 >= y1) return;
    for (int32_t y = (y0 > READ ? y0 - READ + 1 : 0) / SIDE; y * SIDE < y1; y++)
        for (int32_t x = (x0 > READ ? x0 - READ + 1 : 0) / SIDE; x * SIDE < x1; x++)
            bounds[(int64_t)y * across + x] = bound(texels, width, height, x * SIDE, y * SIDE);
}

// The same for rectangles that lie in the map. A map without a block of full size has no bounds that could be read.
void morse_draw_bounds(const float *texels, int32_t width, int32_t height, ShadowBlock *bounds,
                       const int32_t (*rectangles)[4], int32_t count) {
    if (width < READ || height < READ) return;
    EACH(i, count) bound_all(texels, width, height, bounds, rectangles[i]);
}
