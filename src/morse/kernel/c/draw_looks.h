// Samples to shade, eight at a time, of any pixels of a tile.
#pragma once
#include "drawing.h"
#include "simd.h"

typedef struct {
    F8 x, y;                 // position in the image
    F8 inverse, nx, ny, nz;  // 1 / depth; the normal, not normalised
    F8 r, g, b, er, eg, eb, metallic, roughness;
    F8 u, v, ux, vx, uy, vy;  // texture coordinates and their changes to the right and down
    I8 plain, texture;
} Looks;

// The interpolated attributes of a triangle, in lanes: the normal; the texture coordinates and 1, times the factor of
// all edges; 1 / depth.
enum { NORMAL_X, NORMAL_Y, NORMAL_Z, TEXTURE_U, TEXTURE_V, WHOLE, INVERSE };

// The attributes as planes: their changes to the right and down, and their values at pixel 0, 0.
typedef struct {
    F8 across, down, start;
    int32_t who, material;
} Planes;

// Size of the cache: most triangles are visible again in the next row.
#define MOST_PLANES 64

// Eight samples before they are shaded: a row of attributes for each. Those without a surface have no attributes, those
// without a texture no changes of them.
typedef struct {
    F8 value[LANES], across[LANES], down[LANES];
    F8 x, y, share;  // position in the image; share of the pixel
    int32_t pixel[LANES], material[LANES];
} Points;

// Number of groups of samples that are shaded one after the other: they are stored long before they are loaded.
#define MOST_GROUPS 8

// Fills a lane that is not used.
static inline void repeat_point(Points *p, int lane) {
    p->value[lane] = p->value[0], p->across[lane] = p->across[0], p->down[lane] = p->down[0];
    p->x[lane] = p->x[0], p->y[lane] = p->y[0], p->material[lane] = p->material[0];
}

static inline F8 at_point(const Planes *p, float x, float y) { return p->across * x + p->down * y + p->start; }

// An attribute of eight samples.
static inline F8 at_points(const Planes *p, int which, F8 x, F8 y) {
    return p->across[which] * x + p->down[which] * y + p->start[which];
}
