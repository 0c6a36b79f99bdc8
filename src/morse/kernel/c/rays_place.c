// Places solids at the poses of their rigid groups, with bounding boxes.
#include <math.h>
#include <stdint.h>

#include "placing.h"
#include "primitives.h"

// Larger by the rounding errors of single precision and of the surface formulas.
static float below(double x, double slack) { return (float)(x - slack); }

// Places some solids, and builds their tree; returns the number of its nodes.
int32_t morse_rays_place(const Placing *all, const Gathering *some) {
    Box *boxes = some->boxes;
    for (int32_t i = 0; i < some->count; i++) {
        const int64_t solid = some->members[i], slot = all->slots[solid];
        const double *p = all->slot_positions + 3 * slot, *r = all->slot_rotations + 9 * slot;
        const double *place = all->places + 3 * solid, *turn = all->turns + 9 * solid;
        const double *centre = all->centres + 3 * solid, *half = all->halves + 3 * solid;
        double *position = all->positions + 3 * solid, *rotation = all->rotations + 9 * solid;
        for (int k = 0; k < 3; k++) {
            const double *row = r + 3 * k;
            position[k] = (row[0] * place[0] + row[1] * place[1] + row[2] * place[2]) + (p[k] - all->anchor[k]);
            for (int j = 0; j < 3; j++)
                rotation[3 * k + j] = row[0] * turn[j] + row[1] * turn[3 + j] + row[2] * turn[6 + j];
        }
        for (int k = 0; k < 3; k++) {
            const double *row = rotation + 3 * k;
            const double at = position[k] + row[0] * centre[0] + row[1] * centre[1] + row[2] * centre[2];
            double reach = fabs(row[0]) * half[0] + fabs(row[1]) * half[1] + fabs(row[2]) * half[2];
            if (all->kinds[solid] == SPHERE) reach = half[0];
            const double slack = 1e-6 * (fabs(at) + reach) + 1e-9;
            boxes[i].low[k] = below(at - reach, slack);
            boxes[i].high[k] = -below(-at - reach, slack);
        }
    }
    int32_t leaf_count;
    const int32_t nodes = build_tree(some->count, boxes, 1, some->scratch, some->nodes, some->leaves, &leaf_count);
    for (int32_t k = 0; k < leaf_count; k++) some->leaves[k] = some->members[some->leaves[k]];
    return nodes;
}
