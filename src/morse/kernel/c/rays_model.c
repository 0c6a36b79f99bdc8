// Casts rays at the solids of many worlds of one model, whose poses are read where the engine keeps them.
//
// Spheres and boxes around a few solids are compared with a ray eight at a time; more solids are in two trees, one of
// them for those that stand. Only solids whose bounds a ray meets are tested exactly.
#include <string.h>

#include "export.h"
#include "mesh.h"
#include "placing.h"
#include "primitives.h"

// Maximum number of solids without a tree; WIDTH times as many groups.
#define FEW_SOLIDS 64
// Bounds of the rounding errors of single precision: of coordinates, and of squares of distances.
#define COORDINATE_ERROR 1e-6f
#define SQUARE_ERROR 4e-6f
// A ray that is steeper than that is parallel to a plane, as in MuJoCo.
#define PARALLEL_TO_PLANE 1e-15

// Solids are in groups: those that move first. Planes are apart.
typedef struct {
    int32_t solids, moving, planes;
    const int32_t *kinds, *geoms, *bodies;      // (S): kind, number of the geom and of its body
    const double *sizes, *centres, *halves;     // (S, 3): of primitives; the box around each, in its own frame
    const Mesh *const *meshes;                  // (S), null for primitives
    const double *face_normals;                 // (F, 3) of all meshes
    const int64_t *first_faces;                 // (S)
    const int32_t *plane_geoms, *plane_bodies;  // (P)
    const double *plane_sizes;                  // (P, 2), 0 for infinite ones
} Model;

// Memory of a thread for the trees of a world: of the moving solids, and of those that stand, which are kept while
// their poses are the same.
typedef struct {
    Box *boxes;
    int32_t *scratch, *leaves[2];
    Node *nodes[2];
    double (*stood)[12];
    int32_t counts[2], is_known;
} Room;

// The rays of all worlds; results are (N, R). Steps are numbers of values from one to the next.
typedef struct {
    int64_t worlds, rays, part;                     // R of each world; rays that a thread takes at once
    const double *const *positions, *const *turns;  // of the geoms of each world
    const double *points, *ways;
    int64_t point_step, point_world, way_world;
    double limit;
    int64_t excluded;  // body whose geoms rays pass through; -1 for none
    double *distances;
    int32_t *geoms;
    double *normals;
    Room *rooms;  // of each thread; null for a few solids
    int64_t next, arrived;
} ModelRays;

MORSE_EXPORT void morse_rays_model(const Model *model, ModelRays *rays);

// Spheres and boxes around eight solids: their middle relative to an anchor, and the axes and half sizes of the boxes.
typedef struct {
    Floats x, y, z, radius, axes[9], half[3];
} Group;

typedef struct {
    Group groups[FEW_SOLIDS / WIDTH];
    double anchor[3];
} Spheres;

typedef struct {
    const Model *model;
    const double *positions, *turns;  // of the geoms
    const Ray *ray;
    const int32_t *leaves;
    int32_t first;  // solid of the first leaf
    int64_t excluded;
    double distance;
    int32_t solid, geom, face;
} Query;

static inline double dot_of(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline void into(const double *r, const double *v, double *to) {
    for (int k = 0; k < 3; k++) to[k] = r[k] * v[0] + r[3 + k] * v[1] + r[6 + k] * v[2];
}

static inline void from(const double *r, const double *v, double *to) {
    for (int k = 0; k < 3; k++) to[k] = dot_of(r + 3 * k, v);
}

// The ray in the frame of a geom.
static inline Ray ray_in(const Query *q, int32_t geom) {
    const double *place = q->positions + 3 * (int64_t)geom, *turn = q->turns + 9 * (int64_t)geom;
    const double *o = q->ray->origin, away[3] = {o[0] - place[0], o[1] - place[1], o[2] - place[2]};
    Ray local;
    into(turn, away, local.origin);
    into(turn, q->ray->direction, local.direction);
    return local;
}

static inline void meet_solid(Query *q, int32_t solid) {
    const Model *m = q->model;
    const int32_t geom = m->geoms[solid];
    if (m->bodies[solid] == q->excluded) return;
    const Ray local = ray_in(q, geom);
    double distance = q->distance;
    int32_t face = -1;
    if (m->kinds[solid] == MESH) {
        if (!meet_mesh(m->meshes[solid], &local, &distance, &face)) return;
    } else {
        distance = first_surface(m->kinds[solid], local.origin, local.direction, m->sizes + 3 * (int64_t)solid);
    }
    if (distance < q->distance || (distance == q->distance && geom < q->geom)) {
        q->distance = distance;
        q->solid = solid, q->geom = geom, q->face = face;
    }
}

static void meet_leaf(void *what, int32_t leaf) {
    Query *q = what;
    meet_solid(q, q->first + q->leaves[leaf]);
}

// Planes are hit from the front, within their borders.
static inline void meet_planes(Query *q) {
    const Model *m = q->model;
    for (int32_t n = 0; n < m->planes; n++) {
        const int32_t geom = m->plane_geoms[n];
        if (m->plane_bodies[n] == q->excluded) continue;
        const double *turn = q->turns + 9 * (int64_t)geom, *way = q->ray->direction;
        if (!(turn[2] * way[0] + turn[5] * way[1] + turn[8] * way[2] < -PARALLEL_TO_PLANE)) continue;
        const Ray local = ray_in(q, geom);
        const double distance = -local.origin[2] / local.direction[2], *size = m->plane_sizes + 2 * (int64_t)n;
        if (!(distance >= 0.0) || distance > q->distance || (distance == q->distance && geom >= q->geom)) continue;
        int within = 1;
        for (int k = 0; k < 2; k++)
            within &= size[k] <= 0.0 || fabs(local.origin[k] + distance * local.direction[k]) <= size[k];
        if (!within) continue;
        q->distance = distance;
        q->solid = -1, q->geom = geom, q->face = -1;
    }
}

// In single precision, without numbers whose products would be denormal: these take ten times as long.
static inline float coarse(double x) { return fabs(x) < 1e-9 ? 0.0f : limited(x); }

static inline void place_spheres(const Query *q, const double *anchor, Spheres *to) {
    const Model *m = q->model;
    static const double origin[3] = {0.0, 0.0, 0.0};
    if (!isfinite(anchor[0] + anchor[1] + anchor[2])) anchor = origin;
    memcpy(to->anchor, anchor, sizeof to->anchor);
    memset(to->groups, 0, sizeof to->groups);
    for (int32_t n = 0; n < (m->solids + WIDTH - 1) / WIDTH * WIDTH; n++) {
        Group *group = to->groups + n / WIDTH;
        const int lane = n % WIDTH;
        // lanes without a solid have a sphere that is not met
        float values[4] = {0.0f, 0.0f, 0.0f, -1.0f};
        if (n < m->solids) {
            const int64_t geom = m->geoms[n];
            double at[3];
            from(q->turns + 9 * geom, m->centres + 3 * (int64_t)n, at);
            for (int k = 0; k < 3; k++) values[k] = coarse(at[k] + q->positions[3 * geom + k] - anchor[k]);
            const double *half = m->halves + 3 * (int64_t)n;
            values[3] = limited(m->kinds[n] == SPHERE ? half[0] : sqrt(dot_of(half, half)));
            const float far = fabsf(values[0]) + fabsf(values[1]) + fabsf(values[2]);
            values[3] = values[3] * (1.0f + COORDINATE_ERROR) + COORDINATE_ERROR * far + 1e-8f;
        }
        group->x[lane] = values[0], group->y[lane] = values[1], group->z[lane] = values[2];
        group->radius[lane] = values[3];
        for (int k = 0; k < 9 && n < m->solids; k++)
            group->axes[k][lane] = coarse(q->turns[9 * (int64_t)m->geoms[n] + k]);
        for (int k = 0; k < 3 && n < m->solids; k++) {
            const float half = limited(m->halves[3 * (int64_t)n + k]);
            group->half[k][lane] = half * (1.0f + COORDINATE_ERROR) + COORDINATE_ERROR;
        }
    }
}

// A bit for each sphere of a group that a ray meets before a distance; `nearest` is where it may enter them.
static inline uint32_t met_spheres(const Group *s, const float *o, const float *d, float slack, float limit,
                                   Floats *nearest) {
    const Floats x = s->x - o[0], y = s->y - o[1], z = s->z - o[2], radius = s->radius + slack;
    const Floats along = x * d[0] + y * d[1] + z * d[2], square = x * x + y * y + z * z;
    const Floats beside = square - along * along, allowed = radius * radius + square * SQUARE_ERROR;
    const Floats wide = radius + (square * SQUARE_ERROR + SQUARE_ERROR);
    *nearest = along - wide;
    const Ints met = (beside <= allowed) & (along + wide >= 0.0f) & (along - wide <= limit) & (s->radius >= 0.0f);
    return bits8(&met);
}

static inline Floats size_of(Floats a) { return CHOSEN(a < 0.0f, -a, a); }

// A bit for each box of a group that the line of a ray meets: three cross products, without divisions.
static inline uint32_t met_boxes(const Group *s, const float *o, const float *d, float slack) {
    const Floats away[3] = {s->x - o[0], s->y - o[1], s->z - o[2]};
    const Floats error = COORDINATE_ERROR * (size_of(away[0]) + size_of(away[1]) + size_of(away[2])) + slack;
    Floats c[3], way[3], size[3];
    for (int k = 0; k < 3; k++) {
        c[k] = s->axes[k] * away[0] + s->axes[3 + k] * away[1] + s->axes[6 + k] * away[2];
        way[k] = s->axes[k] * d[0] + s->axes[3 + k] * d[1] + s->axes[6 + k] * d[2];
        size[k] = size_of(way[k]);
    }
    Ints met = EACH(Ints, -1);
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const Floats beside = size_of(c[i] * way[j] - c[j] * way[i]);
        met &= beside <= s->half[i] * size[j] + s->half[j] * size[i] + error;
    }
    return bits8(&met);
}

static inline void meet_few(Query *q, const Spheres *s) {
    const Ray *ray = q->ray;
    float o[3], d[3], slack = 0.0f;
    for (int k = 0; k < 3; k++) {
        o[k] = coarse(ray->origin[k] - s->anchor[k]), d[k] = coarse(ray->direction[k]);
        slack += COORDINATE_ERROR * fabsf(o[k]);
    }
    for (int32_t g = 0; g * WIDTH < q->model->solids; g++) {
        Floats nearest;
        uint32_t met = met_spheres(s->groups + g, o, d, slack, rounded_up(q->distance), &nearest);
        if (met) met &= met_boxes(s->groups + g, o, d, slack);
        for (; met; met &= met - 1) {
            const int k = __builtin_ctz(met);
            if (nearest[k] <= rounded_up(q->distance)) meet_solid(q, g * WIDTH + k);
        }
    }
}

static inline void meet_trees(Query *q, const Room *room) {
    const Slopes slopes = slopes_of(q->ray);
    for (int k = 0; k < 2; k++) {
        if (!room->counts[k]) continue;
        q->leaves = room->leaves[k], q->first = k ? q->model->moving : 0;
        walk(room->nodes[k], &slopes, &q->distance, meet_leaf, q);
    }
}

// The tree of the solids that move, or of those that stand.
static void build(const Query *q, Room *room, int standing) {
    const Model *m = q->model;
    const int32_t first = standing ? m->moving : 0, end = standing ? m->solids : m->moving;
    int same = standing && room->is_known;
    for (int32_t n = first; n < end; n++) {
        const int64_t geom = m->geoms[n];
        const double *position = q->positions + 3 * geom, *turn = q->turns + 9 * geom;
        if (standing) {
            double *stood = room->stood[n - first];
            if (!memcmp(stood, position, 3 * sizeof *stood) && !memcmp(stood + 3, turn, 9 * sizeof *stood)) continue;
            same = 0;
            memcpy(stood, position, 3 * sizeof *stood), memcpy(stood + 3, turn, 9 * sizeof *stood);
        }
    }
    if (same) return;
    for (int32_t n = first; n < end; n++) {
        const int64_t geom = m->geoms[n];
        room->boxes[n - first] = box_around(m->kinds[n], q->positions + 3 * geom, q->turns + 9 * geom,
                                            m->centres + 3 * (int64_t)n, m->halves + 3 * (int64_t)n);
    }
    int32_t leaves;
    room->counts[standing] =
        build_tree(end - first, room->boxes, 1, room->scratch, room->nodes[standing], room->leaves[standing], &leaves);
    if (standing) room->is_known = 1;
}

// The outward normal of a primitive at a place on it, in its own frame, of any length.
static inline void normal_at(int32_t kind, const double *size, const double *at, double *to) {
    memcpy(to, at, 3 * sizeof *to);
    switch (kind) {
        case BOX: {
            int axis = 0;
            for (int k = 1; k < 3; k++)
                if (fabs(at[k]) * size[axis] > fabs(at[axis]) * size[k]) axis = k;
            for (int k = 0; k < 3; k++) to[k] = k == axis ? copysign(1.0, at[k]) : 0.0;
            break;
        }
        case ELLIPSOID:
            for (int k = 0; k < 3; k++) to[k] = at[k] / (size[k] * size[k]);
            break;
        case CYLINDER: {
            const double radius = sqrt(at[0] * at[0] + at[1] * at[1]);
            const int cap = fabs(at[2]) - size[1] > radius - size[0];
            for (int k = 0; k < 2; k++) to[k] = cap ? 0.0 : at[k];
            to[2] = cap ? copysign(1.0, at[2]) : 0.0;
            break;
        }
        case CAPSULE:
            to[2] = at[2] - (at[2] > size[1] ? size[1] : at[2] < -size[1] ? -size[1] : at[2]);
            break;
        default:
            break;
    }
}

// The unit normal of the surface that a ray has hit, against the ray.
static inline void find_normal(const Query *q, double *to) {
    const Model *m = q->model;
    double own[3] = {0.0, 0.0, 1.0};
    if (q->solid >= 0 && m->kinds[q->solid] == MESH) {
        memcpy(own, m->face_normals + 3 * (m->first_faces[q->solid] + q->face), sizeof own);
    } else if (q->solid >= 0) {
        const Ray local = ray_in(q, q->geom);
        double at[3];
        for (int k = 0; k < 3; k++) at[k] = local.origin[k] + q->distance * local.direction[k];
        normal_at(m->kinds[q->solid], m->sizes + 3 * (int64_t)q->solid, at, own);
    }
    from(q->turns + 9 * (int64_t)q->geom, own, to);
    const double length = sqrt(dot_of(to, to)), side = dot_of(to, q->ray->direction) > 0.0 ? -1.0 : 1.0;
    const double scale = side / (length > 1e-300 ? length : 1e-300);
    for (int k = 0; k < 3; k++) to[k] *= scale;
}

static inline void cast_ray(Query *q, const ModelRays *rays, const Spheres *spheres, const Room *room,
                            const double *point, const double *way, int64_t i) {
    rays->distances[i] = -1.0, rays->geoms[i] = -1;
    double *normal = rays->normals + 3 * i;
    normal[0] = normal[1] = normal[2] = 0.0;
    // squares of very long and very short directions are not finite, or 0
    const double most = larger(larger(fabs(way[0]), fabs(way[1])), fabs(way[2]));
    if (!(most > 0.0) || !isfinite(most) || !isfinite(point[0] + point[1] + point[2])) return;
    Ray ray;
    double square = 0.0;
    for (int k = 0; k < 3; k++) ray.direction[k] = way[k] / most, square += ray.direction[k] * ray.direction[k];
    const double part = sqrt(square), length = most * part;
    for (int k = 0; k < 3; k++) ray.direction[k] /= part, ray.origin[k] = point[k];
    q->ray = &ray, q->distance = rays->limit, q->solid = q->geom = q->face = -1;
    meet_planes(q);
    if (room)
        meet_trees(q, room);
    else
        meet_few(q, spheres);
    if (q->geom < 0) return;
    rays->distances[i] = q->distance / length, rays->geoms[i] = q->geom;
    find_normal(q, normal);
}

// Casts all rays; several threads may call it at once, and each takes one part after another. Each ray is computed
// independently, so that the distribution over threads does not matter.
void morse_rays_model(const Model *model, ModelRays *rays) {
    const int64_t parts = (rays->rays + rays->part - 1) / rays->part, thread = __atomic_fetch_add(&rays->arrived, 1, 0);
    Room *room = rays->rooms ? rays->rooms + thread : 0;
    Spheres spheres;
    Query q = {.model = model, .excluded = rays->excluded};
    int64_t present = -1;
    for (;;) {
        const int64_t piece = __atomic_fetch_add(&rays->next, 1, __ATOMIC_RELAXED), world = piece / parts;
        if (world >= rays->worlds) return;
        const int64_t first = piece % parts * rays->part;
        const int64_t end = first + rays->part < rays->rays ? first + rays->part : rays->rays;
        const double *points = rays->points + world * rays->point_world, *ways = rays->ways + world * rays->way_world;
        q.positions = rays->positions[world], q.turns = rays->turns[world];
        if (room && world != present) build(&q, room, 0), build(&q, room, 1);
        // the origin of the first ray; of rays from anywhere, the spheres are as accurate as they can be
        if (!room && world != present) place_spheres(&q, points, &spheres);
        present = world;
        for (int64_t n = first; n < end; n++)
            cast_ray(&q, rays, &spheres, room, points + n * rays->point_step, ways + 3 * n, world * rays->rays + n);
    }
}
