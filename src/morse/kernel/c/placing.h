// Solids at the poses of their rigid groups; see rays_place.c.
#pragma once

#include <stdint.h>

#include "export.h"
#include "tree.h"

// Rows are solids, except for the poses of the groups.
typedef struct {
    const double *slot_positions, *slot_rotations;    // (K, 3), (K, 3, 3)
    const double *anchor;                             // (3)
    const int64_t *slots;                             // (S)
    const double *places, *turns, *centres, *halves;  // poses in the group; boxes in their own frames
    const int32_t *kinds;                             // (S)
    double *positions, *rotations;                    // results, relative to the anchor
} Placing;

// A tree over some of the solids, and memory to build it.
typedef struct {
    int32_t count;
    const int32_t *members;  // indices of solids
    Box *boxes;
    int32_t *scratch;
    Node *nodes;
    int32_t *leaves;  // result: the solid in each leaf
} Gathering;

MORSE_EXPORT int32_t morse_rays_place(const Placing *all, const Gathering *some);
