// Casts rays at solids: the nearest surface of each ray; of several at the same distance, that of the first solid.
#include "primitives.h"
#include "solids.h"

typedef struct {
    const Solids *all;
    const int32_t *leaves;
    const int64_t *groups;
    const Ray *ray;
    int64_t owner, solid;
    double distance;
    int32_t face;
} Query;

static inline void turn(const double *r, const double *v, double *out) {
    for (int k = 0; k < 3; k++) out[k] = r[3 * k] * v[0] + r[3 * k + 1] * v[1] + r[3 * k + 2] * v[2];
}

static inline void turn_back(const double *r, const double *v, double *out) {
    for (int k = 0; k < 3; k++) out[k] = r[k] * v[0] + r[3 + k] * v[1] + r[6 + k] * v[2];
}

static void meet_solid(void *what, int32_t leaf) {
    Query *q = what;
    const Solids *all = q->all;
    const int32_t solid = q->leaves[leaf];
    if (q->groups[solid] == q->owner) return;
    const double *place = all->positions + 3 * (int64_t)solid, *rotation = all->rotations + 9 * (int64_t)solid;
    const double *o = q->ray->origin, away[3] = {o[0] - place[0], o[1] - place[1], o[2] - place[2]};
    Ray local;
    turn_back(rotation, away, local.origin);
    turn_back(rotation, q->ray->direction, local.direction);
    double distance = q->distance;
    int32_t face = -1;
    if (all->kinds[solid] == MESH) {
        if (!meet_mesh(all->meshes[solid], &local, &distance, &face)) return;
    } else {
        distance = first_surface(all->kinds[solid], local.origin, local.direction, all->sizes + 3 * (int64_t)solid);
    }
    if (distance < q->distance || (distance == q->distance && solid < q->solid)) {
        q->distance = distance;
        q->solid = solid;
        q->face = face;
    }
}

static inline int is_finite(const double *v) { return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]); }

// The origin of the rays of a sensor, and their rotation.
static void aim(const Rays *rays, int64_t sensor, double *position, double *rotation) {
    const int64_t slot = rays->slots[sensor];
    const double *p = rays->slot_positions + 3 * slot, *r = rays->slot_rotations + 9 * slot;
    turn(r, rays->offsets + 3 * sensor, position);
    for (int k = 0; k < 3; k++) position[k] = position[k] + (p[k] - rays->anchor[k]);
    const double *t = rays->turns + 9 * sensor;
    for (int row = 0; row < 3; row++) {
        for (int k = 0; k < 3; k++) {
            const double sum = r[3 * row] * t[k] + r[3 * row + 1] * t[3 + k] + r[3 * row + 2] * t[6 + k];
            rotation[3 * row + k] = rays->upright ? (double)(row == k) : sum;
        }
    }
}

static void cast_one(const Solids *solids, const Rays *rays, const double *position, const double *rotation,
                     int64_t sensor, int64_t number) {
    Ray ray = {{position[0], position[1], position[2]}, {0.0, 0.0, 0.0}};
    turn(rotation, rays->directions + 3 * number, ray.direction);
    if (rays->origins) {
        turn(rotation, rays->origins + 3 * number, ray.origin);
        for (int k = 0; k < 3; k++) ray.origin[k] = ray.origin[k] + position[k];
    }
    Query q = {solids, 0, rays->groups, &ray, rays->owners[sensor], -1, rays->limit, -1};
    // rays whose origin or target is NaN or infinite hit nothing
    if (is_finite(ray.origin) && is_finite(ray.direction)) {
        const Slopes slopes = slopes_of(&ray);
        if (solids->still) {
            q.leaves = solids->still_leaves;
            walk(solids->still, &slopes, &q.distance, meet_solid, &q);
        }
        if (solids->moving) {
            q.leaves = solids->moving_leaves;
            walk(solids->moving, &slopes, &q.distance, meet_solid, &q);
        }
    }
    const int64_t i = sensor * rays->rays + number;
    rays->distances[i] = q.solid < 0 ? INFINITY : q.distance;
    rays->solids[i] = q.solid;
    rays->faces[i] = q.face;
}

// Casts the rays first, ..., last - 1 of all rays of all sensors.
static void cast_part(const Solids *solids, const Rays *rays, int64_t first, int64_t last) {
    while (first < last) {
        const int64_t sensor = first / rays->rays, start = sensor * rays->rays;
        const int64_t end = last < start + rays->rays ? last : start + rays->rays;
        double position[3], rotation[9];
        aim(rays, sensor, position, rotation);
        for (; first < end; first++) cast_one(solids, rays, position, rotation, sensor, first - start);
    }
}

// Casts all rays; several threads may call it at once, and each takes one part after another: some parts take longer
// than others. Each ray is computed independently, so that the distribution over threads does not matter.
void morse_rays_cast(const Solids *solids, Rays *rays, int64_t whole, int64_t part) {
    for (;;) {
        const int64_t first = __atomic_fetch_add(&rays->next, part, __ATOMIC_RELAXED);
        if (first >= whole) return;
        cast_part(solids, rays, first, whole - first < part ? whole : first + part);
    }
}
