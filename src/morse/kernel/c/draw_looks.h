// Eight samples to shade, of any pixels of a tile.
#pragma once
#include "drawing.h"
#include "simd.h"

typedef struct {
    F8 x, y, share;          // position in the image, and share of the pixel
    F8 inverse, nx, ny, nz;  // 1 / depth; the normal, not normalised
    F8 r, g, b, er, eg, eb, metallic, roughness;
    F8 u, v, ux, vx, uy, vy;  // texture coordinates and their changes to the right and down
    I8 none, plain, texture;
    int32_t pixel[LANES];
} Looks;

// Number of groups of samples that are shaded one after the other: they are stored long before they are loaded.
#define MOST_GROUPS 8

// Attributes of a triangle as planes: normals, texture coordinates and the sum of its edges.
typedef struct {
    float normal[3][3], uv[2][3], whole[3];
    int32_t who;
} Planes;

// Size of the cache: most triangles are visible again in the next row.
#define MOST_PLANES 64

static inline float at_point(const float *p, float x, float y) { return p[0] * x + p[1] * y + p[2]; }
static inline F8 at_points(const float *p, F8 x, F8 y) { return p[0] * x + p[1] * y + p[2]; }
