// Samples to shade, eight at a time, of any pixels of a tile.
#pragma once
#include "drawing.h"
#include "simd.h"

typedef struct {
    F8 x, y;                 // position in the image
    F8 inverse, nx, ny, nz;  // see `depth_at`; the normal, not normalised
    F8 r, g, b, er, eg, eb, metallic, roughness;
    F8 u, v, ux, vx, uy, vy;  // texture coordinates and their changes to the right and down
    I8 plain, texture;
    V3 ray, place, normal;        // the direction for a depth of 1, the position, and the unit normal, in the world
    F8 depth, sun;                // m; the share of the light of the sun
    V3 lights[1 + MOST_SHADOWS];  // in the classic look: of the lights without shadows, and of each light with shadows
    F8 red, green, blue;          // the colour of the material in the classic look
    I8 hazed, fine;
} Looks;

// The interpolated attributes of a triangle, in lanes: the normal; the texture coordinates and 1, times the factor of
// all edges; what `depth_at` converts.
enum { NORMAL_X, NORMAL_Y, NORMAL_Z, TEXTURE_U, TEXTURE_V, WHOLE, INVERSE };

// The attributes as planes: their changes to the right and down, and their values at pixel 0, 0.
typedef struct {
    F8 across, down, start;
} Planes;

// Depths, from a number that is linear in the image and larger the nearer a surface is: 1 / depth for pinholes, and the
// reach minus the depth for parallel rays.
static inline F8 depth_at(const Camera *k, F8 inverse) { return k->parallel ? reach_of(k) - inverse : 1 / inverse; }

// How far eight samples are from the axis: for pinholes at a depth of 1.
static inline V3 aside_of(const Camera *k, F8 x, F8 y) {
    const float *r = k->axes;
    const F8 cx = (x - k->cx) * (1 / k->fx), cy = (y - k->cy) * (1 / k->fy);
    return (V3){r[0] * cx + r[3] * cy, r[1] * cx + r[4] * cy, r[2] * cx + r[5] * cy};
}

static inline F8 at_point(const Planes *p, float x, float y) { return p->across * x + p->down * y + p->start; }

// An attribute of eight samples.
static inline F8 at_points(const Planes *p, int which, F8 x, F8 y) {
    return p->across[which] * x + p->down[which] * y + p->start[which];
}
