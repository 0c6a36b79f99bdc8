// Which tiles of an image are the same as in the last image of the camera.
#pragma once
#include <string.h>

#include "draw_bin.h"
#include "drawing.h"

// Side of a block of texels whose changes are counted: 1 << CHANGE_SHIFT.
#define CHANGE_SHIFT 5

static inline int32_t change_blocks(int32_t texels) { return (texels + (1 << CHANGE_SHIFT) - 1) >> CHANGE_SHIFT; }

// Largest number of a texel that is read, also beside a map of the classic look.
#define FARTHEST_READ (1 << 24)
// The first column of a rectangle of texels in which there is a surface.
#define SHADOWED INT32_MIN

// A rectangle: tiles, or texels; one past the end.
typedef struct {
    int32_t x0, y0, x1, y1;
} Region;

// Sets which tiles of a camera are drawn; returns their number.
int64_t draw_mark(Frame *f, int32_t camera);
// The tiles in which a sphere of an instance may be visible.
Region draw_tiles_around(const Camera *k, const float *model, const float *sphere);
// Whether no surface casts a shadow of a light on the points for which some texels of its map were read, x0, y0, x1,
// y1; the map may have been another one then.
int draw_is_lit(const ClassicLight *before, const ClassicLight *now, const int32_t *r);
// Copies a tile from the last image.
void draw_take_over(const Frame *f, int64_t tile);
// Copies a tile for the next image.
void draw_keep(const Frame *f, int64_t tile);

static inline Kept *kept_of(const Frame *f, int32_t camera) { return f->kept ? f->kept[camera] : NULL; }

// Whether a sphere may be visible in a tile that is drawn.
static inline int is_in_drawn_tile(const Frame *f, const Camera *k, const float *model, const float *sphere) {
    const Region r = draw_tiles_around(k, model, sphere);
    const uint8_t *drawn = f->drawn + k->tile + r.x0;
    for (int32_t y = r.y0; y < r.y1 && r.x0 < r.x1; y++)
        if (memchr(drawn + y * tiles_across(k), 1, (size_t)(r.x1 - r.x0))) return 1;
    return 0;
}
