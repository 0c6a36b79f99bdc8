// Solids at the poses of their rigid groups; see rays_place.c.
#pragma once

#include <math.h>
#include <stdint.h>

#include "export.h"
#include "primitives.h"
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

// Larger by the rounding errors of single precision and of the surface formulas.
static inline float below(double x, double slack) { return (float)(x - slack); }

// The box around a solid at a pose: `centre` and `half` are those of the box in its own frame.
static inline Box box_around(int32_t kind, const double *position, const double *rotation, const double *centre,
                             const double *half) {
    Box box;
    for (int k = 0; k < 3; k++) {
        const double *row = rotation + 3 * k;
        const double at = position[k] + row[0] * centre[0] + row[1] * centre[1] + row[2] * centre[2];
        double reach = fabs(row[0]) * half[0] + fabs(row[1]) * half[1] + fabs(row[2]) * half[2];
        if (kind == SPHERE) reach = half[0];
        const double slack = 1e-6 * (fabs(at) + reach) + 1e-9;
        box.low[k] = below(at - reach, slack);
        box.high[k] = -below(-at - reach, slack);
    }
    return box;
}

MORSE_EXPORT int32_t morse_rays_place(const Placing *all, const Gathering *some);
