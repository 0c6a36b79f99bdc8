// Planes in place of boxes below wheeled robots; the twin of `tests/kernel/twins/driving.py`.
#include <math.h>
#include <stdint.h>

#include "export.h"

typedef struct {
    int64_t robots, planes;                                       // N, P
    const int64_t *first, *geoms, *carriers;                      // (N + 1), (S), (S)
    const int64_t *slots, *dofs;                                  // (N)
    const int64_t *boxes;                                         // (P) geoms
    const double *places, *tops;                                  // (P, 12), (P, 9)
    const int32_t *box_bits, *plane_bits;                         // (P)
    const double *velocities, *body_places;                       // of the engine
    const double *box_places, *box_turns, *shape_places, *radii;  // of the engine, by geom
    int32_t *types, *affinities;                                  // of the engine, by geom
    double period, edge, deep;
    int64_t all_bits;
    const double *positions;  // (K, 3)
} Planes;

MORSE_EXPORT void morse_planes(const Planes *all);

static double length(const double *v) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

// The distance from the origin of a robot to its outermost point.
static double reach(const Planes *all, int64_t i) {
    double most = 0.0;
    for (int64_t k = all->first[i]; k < all->first[i + 1]; k++) {
        const int64_t geom = all->geoms[k], carrier = all->carriers[k];
        double far = length(all->shape_places + 3 * geom) + all->radii[geom];
        if (carrier >= 0) far += length(all->body_places + 3 * carrier);
        if (far > most) most = far;
    }
    return most;
}

// Whether the box has its bit, and is at the place of its floor.
static int stands(const Planes *all, int64_t p) {
    const int64_t box = all->boxes[p];
    if (all->types[box] != all->box_bits[p]) return 0;
    const double *place = all->places + 12 * p;
    for (int k = 0; k < 3; k++)
        if (all->box_places[3 * box + k] != place[k]) return 0;
    for (int k = 0; k < 9; k++)
        if (all->box_turns[9 * box + k] != place[3 + k]) return 0;
    return 1;
}

static int is_above(const double *top, const double *at, double margin, double deep) {
    const double dx = at[0] - top[1], dy = at[1] - top[2];
    const double along = top[7] - fabs(top[3] * dx + top[4] * dy);
    const double across = top[8] - fabs(top[5] * dx + top[6] * dy);
    return along > margin && across > margin && at[2] > top[0] - deep;
}

// Selects the planes or the boxes that the shapes of each robot touch.
void morse_planes(const Planes *all) {
    for (int64_t i = 0; i < all->robots; i++) {
        const double *at = all->positions + 3 * all->slots[i], *v = all->velocities + all->dofs[i];
        const double margin = reach(all, i) + 2.0 * sqrt(v[0] * v[0] + v[1] * v[1]) * all->period + all->edge;
        int32_t bits = (int32_t)all->all_bits;
        for (int64_t p = 0; p < all->planes; p++)
            if (is_above(all->tops + 9 * p, at, margin, all->deep) && stands(all, p))
                bits = (bits & ~all->box_bits[p]) | all->plane_bits[p];
        for (int64_t k = all->first[i]; k < all->first[i + 1]; k++) {
            const int64_t geom = all->geoms[k];
            if (all->types[geom]) all->types[geom] = all->affinities[geom] = bits;
        }
    }
}
