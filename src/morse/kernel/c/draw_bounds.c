// Sets the bounds of the blocks of a shadow map.
#include "draw_bounds.h"

#include "export.h"

MORSE_EXPORT void morse_draw_bounds(const float *texels, int32_t width, int32_t height, ShadowBlock *bounds);

// There is a block of full size.
void morse_draw_bounds(const float *texels, int32_t width, int32_t height, ShadowBlock *bounds) {
    const int64_t across = blocks_across(width);
    for (int32_t y = 0; y * SIDE < height; y++)
        for (int32_t x = 0; x < across; x++) bounds[y * across + x] = bound(texels, width, height, x * SIDE, y * SIDE);
}
