// Intersection of a ray with a triangle mesh: watertight, in double precision (Woop, Benthin and Wald 2013).
//
// Each operation is the same as in `tests/kernel/twins/triangles.py`, so that both give bit-identical results.
#pragma once

#include "ray.h"

enum { BLOCK = 4 };

// Four triangles: `corners[corner][axis]`. Lanes without a triangle have a face of -1 and corners of zero.
typedef struct {
    Doubles corners[3][3];
    int32_t faces[BLOCK];
} __attribute__((aligned(32))) Block;

_Static_assert(sizeof(Block) == 320, "Python allocates blocks of that size");

typedef struct {
    const Node *nodes;  // null without triangles
    const Block *blocks;
} Mesh;

// A ray, sheared so that it runs along an axis: an edge that two triangles share is on the same side for both.
typedef struct {
    const Block *blocks;
    const double *origin;
    double shear_x, shear_y, shear_z;
    int x, y, z;
    double distance;  // nearest so far
    int32_t face;     // INT32_MAX: none yet
} MeshQuery;

static inline MeshQuery mesh_query(const Mesh *mesh, const Ray *ray, double limit) {
    const double *d = ray->direction;
    int z = fabs(d[1]) > fabs(d[0]) ? 1 : 0;
    z = fabs(d[2]) > fabs(d[z]) ? 2 : z;
    const int x = (z + 1) % 3, y = (z + 2) % 3;
    return (MeshQuery){mesh->blocks, ray->origin, d[x] / d[z], d[y] / d[z], 1.0 / d[z], x, y, z, limit, INT32_MAX};
}

static inline void meet_block(void *what, int32_t leaf) {
    MeshQuery *q = what;
    const Block *block = q->blocks + leaf;
    Doubles px[3], py[3], pz[3];
    for (int k = 0; k < 3; k++) {
        const Doubles away = block->corners[k][q->z] - q->origin[q->z];
        px[k] = (block->corners[k][q->x] - q->origin[q->x]) - q->shear_x * away;
        py[k] = (block->corners[k][q->y] - q->origin[q->y]) - q->shear_y * away;
        pz[k] = q->shear_z * away;
    }
    const Doubles u = px[2] * py[1] - py[2] * px[1];
    const Doubles v = px[0] * py[2] - py[0] * px[2];
    const Doubles w = px[1] * py[0] - py[1] * px[0];
    const Doubles sum = u + v + w;
    Longs inside = ((u >= 0.0) & (v >= 0.0) & (w >= 0.0)) | ((u <= 0.0) & (v <= 0.0) & (w <= 0.0));
    inside &= sum != 0.0;
    if (!bits4(&inside)) return;
    const Doubles distances = (u * pz[0] + v * pz[1] + w * pz[2]) / sum;
    const Longs near = inside & (distances >= 0.0) & (distances <= q->distance);
    for (uint32_t left = bits4(&near); left; left &= left - 1) {
        const int k = __builtin_ctz(left);
        // of two triangles at the same distance, the first one counts
        if (distances[k] < q->distance || (distances[k] == q->distance && block->faces[k] < q->face)) {
            q->distance = distances[k];
            q->face = block->faces[k];
        }
    }
}

// The nearest triangle up to a distance, which is lowered; false if there is none.
static inline int meet_mesh(const Mesh *mesh, const Ray *ray, double *limit, int32_t *face) {
    if (!mesh->nodes) return 0;
    MeshQuery q = mesh_query(mesh, ray, *limit);
    const Slopes slopes = slopes_of(ray);
    walk(mesh->nodes, &slopes, &q.distance, meet_block, &q);
    if (q.face == INT32_MAX) return 0;
    // no -0.0, as for primitives
    *limit = q.distance + 0.0;
    *face = q.face;
    return 1;
}
