// The samples to shade in a row of a tile, one after the other.
#pragma once
#include "drawing.h"
#include "simd.h"

#define MOST_LOOKS (TILE * MOST_SAMPLES)
// eight samples of `l`, starting at number `i`
#define AT(name) (*(const F8 *)(l->name + i))

// Attributes of a triangle as planes: normals, texture coordinates and the sum of its edges.
typedef struct {
    float normal[3][3], uv[2][3], whole[3];
    int32_t who;
} Planes;

// Size of the cache: most triangles are visible again in the next row.
#define MOST_PLANES 64

typedef struct {
    Planes planes[MOST_PLANES];
    float x[MOST_LOOKS], y[MOST_LOOKS], share[MOST_LOOKS], inverse[MOST_LOOKS];
    float nx[MOST_LOOKS], ny[MOST_LOOKS], nz[MOST_LOOKS];
    float r[MOST_LOOKS], g[MOST_LOOKS], b[MOST_LOOKS], er[MOST_LOOKS], eg[MOST_LOOKS], eb[MOST_LOOKS];
    float metallic[MOST_LOOKS], roughness[MOST_LOOKS];
    float u[MOST_LOOKS], v[MOST_LOOKS], ux[MOST_LOOKS], vx[MOST_LOOKS], uy[MOST_LOOKS], vy[MOST_LOOKS];
    int32_t who[MOST_LOOKS], plain[MOST_LOOKS], column[MOST_LOOKS], texture[MOST_LOOKS];
} __attribute__((aligned(32))) Looks;
