// The solids that rays can hit, as described in `morse/kernel/rays.py`.
#pragma once

#include "export.h"
#include "mesh.h"

typedef struct {
    const int32_t *kinds;                         // (S)
    const double *positions, *rotations, *sizes;  // (S, 3), (S, 3, 3), (S, 3)
    const Mesh *const *meshes;                    // (S), null for primitives
    // trees, and the solid of each of their leaves; null if empty
    const Node *still, *moving;
    const int32_t *still_leaves, *moving_leaves;
} Solids;

// The rays of some sensors with the same directions; results are (B, N).
typedef struct {
    int64_t rays;                                   // N of each sensor
    const double *slot_positions, *slot_rotations;  // (K, 3), (K, 3, 3): of all rigid groups
    const double *anchor;                           // (3)
    const int64_t *slots;                           // (B) the group of each sensor
    const double *offsets, *turns;                  // (B, 3), (B, 3, 3): the pose of each sensor in its group
    int64_t upright;                                // the directions are in the axes of the world
    const double *directions, *origins;             // (N, 3), (N, 3) or null
    const int64_t *owners, *groups;                 // (B), (S): a ray passes through solids of its own group
    double limit;                                   // maximum distance
    double *distances;                              // infinite for nothing
    int64_t *solids;                                // -1 for nothing
    int32_t *faces;                                 // triangle of the mesh, else -1
    int64_t next;                                   // first ray that no thread has taken
} Rays;

MORSE_EXPORT void morse_rays_cast(const Solids *solids, Rays *rays, int64_t whole, int64_t part);
