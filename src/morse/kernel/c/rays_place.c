// Places solids at the poses of their rigid groups, with bounding boxes.
#include <stdint.h>

#include "placing.h"

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
        boxes[i] = box_around(all->kinds[solid], position, rotation, centre, half);
    }
    int32_t leaf_count;
    const int32_t nodes = build_tree(some->count, boxes, 1, some->scratch, some->nodes, some->leaves, &leaf_count);
    for (int32_t k = 0; k < leaf_count; k++) some->leaves[k] = some->members[some->leaves[k]];
    return nodes;
}
