// Casts rays at the solids of many worlds of one model, whose poses are read where the engine keeps them.
//
// Rays are in packets with similar directions; one solid after another, the nearest first, is compared with all of
// them: a sphere around it with cones around packets, then sphere and box with each ray. Only rays that meet these are
// tested exactly, four at a time.
#include "export.h"
#include "mesh.h"
#include "packets.h"

enum { PLANE = MESH + 1, DISTANCES = 256 };

// With fewer solids, it takes longer to sort the rays than to compare each of them.
#define FEW_SOLIDS 16

// A ray that is steeper than that is parallel to a plane, as in MuJoCo.
#define PARALLEL_TO_PLANE 1e-15

// Solids are in the order of their geoms.
typedef struct {
    int64_t solids;
    const int32_t *kinds, *geoms, *bodies;   // (S): kind, number of the geom and of its body
    const double *sizes, *centres, *halves;  // (S, 3): of primitives; the box around each, in its own frame
    const Mesh *const *meshes;               // (S), null for primitives
    const double *face_normals;              // (F, 3) of all meshes
    const int64_t *first_faces;              // (S)
} Model;

// A sphere around a solid, relative to the anchor.
typedef struct {
    float at[3], radius;
    int32_t solid;
} Bound;

// Memory of a thread.
typedef struct {
    Bundle *bundle;
    Bound *bounds, *sorted;  // (S)
} Room;

// The rays of all worlds; results are (N, R). Steps are numbers of values from one to the next.
typedef struct {
    int64_t worlds, rays;
    const double *const *positions, *const *turns;  // of the geoms of each world
    const double *points, *ways;
    int64_t point_step, point_world, way_world;
    double limit;
    int64_t excluded;  // body whose geoms rays pass through; -1 for none
    double *distances;
    int32_t *geoms;
    double *normals;  // null if they are not wanted
    Room *rooms;      // of each thread
    int64_t next, arrived;
} ModelRays;

MORSE_EXPORT void morse_rays_model(const Model *model, ModelRays *rays);

// A solid at its place in a world, and what all rays from the anchor have in common.
typedef struct {
    int32_t kind, solid;
    const double *place, *turn, *size;
    const Mesh *mesh;
    double origin[3];  // of rays from the anchor, in the frame of the solid
    float at[3], radius, axes[9], half[3];
} Target;

static inline void into(const double *r, const double *v, double *to) {
    for (int k = 0; k < 3; k++) to[k] = r[k] * v[0] + r[3 + k] * v[1] + r[6 + k] * v[2];
}

static inline void from(const double *r, const double *v, double *to) {
    for (int k = 0; k < 3; k++) to[k] = dot3(r + 3 * k, v);
}

static inline void into4(const double *r, const Doubles *v, Doubles *to) {
    for (int k = 0; k < 3; k++) to[k] = r[k] * v[0] + r[3 + k] * v[1] + r[6 + k] * v[2];
}

// The origins of four rays in the frame of a solid.
static inline void origins_in(const Target *t, const Bundle *b, const Packet *p, int half, Doubles *to) {
    if (b->shared) {
        for (int k = 0; k < 3; k++) to[k] = EACH(Doubles, t->origin[k]);
        return;
    }
    Doubles away[3];
    for (int k = 0; k < 3; k++) away[k] = p->origin[k][half] - t->place[k];
    into4(t->turn, away, to);
}

// Of several solids at the same distance, the first one counts.
static inline void take(Packet *p, int half, Longs met, Doubles distance, int32_t solid) {
    const Longs before = (Longs)(p->solid[half] > (int64_t)solid);
    met &= (distance < p->distance[half]) | ((distance == p->distance[half]) & before);
    p->distance[half] = picked4(met, distance, p->distance[half]);
    p->solid[half] = (p->solid[half] & ~met) | (EACH(Longs, (int64_t)solid) & met);
}

static inline void meet_triangles(Packet *p, int half, uint32_t lanes, const Target *t, const Doubles *o,
                                  const Doubles *d) {
    for (; lanes; lanes &= lanes - 1) {
        const int k = __builtin_ctz(lanes);
        const Ray local = {{o[0][k], o[1][k], o[2][k]}, {d[0][k], d[1][k], d[2][k]}};
        double distance = p->distance[half][k];
        int32_t face;
        if (!meet_mesh(t->mesh, &local, &distance, &face)) continue;
        if (distance == p->distance[half][k] && p->solid[half][k] <= t->solid) continue;
        p->distance[half][k] = distance;
        p->solid[half][k] = t->solid, p->face[4 * half + k] = face;
    }
}

static inline __attribute__((always_inline)) void meet_half(const Bundle *b, Packet *p, int half, uint32_t lanes,
                                                            const Target *t, int32_t kind) {
    Doubles origin[3], way[3] = {p->way[0][half], p->way[1][half], p->way[2][half]}, local[3];
    origins_in(t, b, p, half, origin);
    into4(t->turn, way, local);
    if (kind == MESH) {
        meet_triangles(p, half, lanes, t, origin, local);
        return;
    }
    const Longs met = {-(int64_t)(lanes & 1), -(int64_t)(lanes >> 1 & 1), -(int64_t)(lanes >> 2 & 1),
                       -(int64_t)(lanes >> 3 & 1)};
    take(p, half, met, first_surface4(kind, origin, local, t->size), t->solid);
}

// A bit for each ray of a packet that may meet a solid before its present hit: its sphere, then its box. The box needs
// three cross products, and no divisions.
static inline uint32_t met_rays(const Bundle *b, const Packet *p, const Target *t) {
    Floats away[3], slack = EACH(Floats, 0.0f);
    for (int k = 0; k < 3; k++) {
        away[k] = EACH(Floats, t->at[k]);
        if (b->shared) continue;
        away[k] -= p->coarse_origin[k];
        slack += COORDINATE_ERROR * sizes_of(p->coarse_origin[k]);
    }
    const Floats *d = p->coarse_way, radius = t->radius + slack;
    const Floats along = away[0] * d[0] + away[1] * d[1] + away[2] * d[2];
    const Floats square = away[0] * away[0] + away[1] * away[1] + away[2] * away[2];
    const Floats wide = radius + (square * SQUARE_ERROR + SQUARE_ERROR);
    const Floats limit = narrowed(p->distance);
    Ints met = (square - along * along <= radius * radius + square * SQUARE_ERROR) & (along + wide >= 0.0f) &
               (along - wide <= limit * WIDER);
    const uint32_t bits = bits8(&met);
    if (t->kind == SPHERE || !bits) return bits;
    const Floats error = COORDINATE_ERROR * (sizes_of(away[0]) + sizes_of(away[1]) + sizes_of(away[2])) + slack;
    Floats c[3], way[3], size[3];
    for (int k = 0; k < 3; k++) {
        c[k] = t->axes[k] * away[0] + t->axes[3 + k] * away[1] + t->axes[6 + k] * away[2];
        way[k] = t->axes[k] * d[0] + t->axes[3 + k] * d[1] + t->axes[6 + k] * d[2];
        size[k] = sizes_of(way[k]);
    }
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        met &= sizes_of(c[i] * way[j] - c[j] * way[i]) <= t->half[i] * size[j] + t->half[j] * size[i] + error;
    }
    return bits8(&met);
}

static inline __attribute__((always_inline)) void meet_packet(const Bundle *b, Packet *p, const Target *t,
                                                              int32_t kind) {
    const uint32_t lanes = met_rays(b, p, t);
    if (lanes & 15u) meet_half(b, p, 0, lanes & 15u, t, kind);
    if (lanes >> 4) meet_half(b, p, 1, lanes >> 4, t, kind);
}

static inline __attribute__((always_inline)) void meet_packets(Bundle *b, const Target *t, int32_t kind) {
    const int32_t packets = (b->rays + WIDTH - 1) / WIDTH, blocks = (packets + WIDTH - 1) / WIDTH;
    for (int32_t n = 0; n < packets && !b->is_sorted; n++) meet_packet(b, b->packets + n, t, kind);
    if (!b->is_sorted) return;
    for (int32_t first = 0; first < blocks; first += WIDTH) {
        uint32_t wide = met_cones(b->wide + first / WIDTH, t->at, t->radius);
        for (; wide; wide &= wide - 1) {
            const int32_t block = first + __builtin_ctz(wide);
            uint32_t narrow = met_cones(b->cones + block, t->at, t->radius);
            for (; narrow; narrow &= narrow - 1)
                meet_packet(b, b->packets + block * WIDTH + __builtin_ctz(narrow), t, kind);
        }
    }
}

static void meet_solid(Bundle *b, const Target *t) {
    switch (t->kind) {
        case BOX:
            meet_packets(b, t, BOX);
            break;
        case SPHERE:
            meet_packets(b, t, SPHERE);
            break;
        case CYLINDER:
            meet_packets(b, t, CYLINDER);
            break;
        case CAPSULE:
            meet_packets(b, t, CAPSULE);
            break;
        case ELLIPSOID:
            meet_packets(b, t, ELLIPSOID);
            break;
        default:
            meet_packets(b, t, MESH);
    }
}

// Planes are hit from the front, within their borders.
static void meet_plane(Bundle *b, const Target *t) {
    const double *turn = t->turn, *size = t->size;
    for (int32_t n = 0; n * WIDTH < b->rays; n++) {
        Packet *p = b->packets + n;
        for (int h = 0; h < 2; h++) {
            const Doubles way[3] = {p->way[0][h], p->way[1][h], p->way[2][h]};
            const Doubles down = turn[2] * way[0] + turn[5] * way[1] + turn[8] * way[2];
            Longs met = down < -PARALLEL_TO_PLANE;
            if (!bits4(&met)) continue;
            Doubles o[3], d[3];
            origins_in(t, b, p, h, o);
            const Doubles distance = -o[2] / down;
            met &= distance >= 0.0;
            if (size[0] > 0.0 || size[1] > 0.0) {
                into4(turn, way, d);
                for (int k = 0; k < 2; k++)
                    if (size[k] > 0.0) met &= size4(o[k] + distance * d[k]) <= size[k];
            }
            take(p, h, met, distance, t->solid);
        }
    }
}

static inline Target target_of(const Model *m, const ModelRays *rays, int64_t world, const Bundle *b, int32_t solid) {
    const int64_t geom = m->geoms[solid], row = 3 * (int64_t)solid;
    Target t = {.kind = m->kinds[solid], .solid = solid, .size = m->sizes + row, .mesh = m->meshes[solid]};
    t.place = rays->positions[world] + 3 * geom, t.turn = rays->turns[world] + 9 * geom;
    const double away[3] = {b->anchor[0] - t.place[0], b->anchor[1] - t.place[1], b->anchor[2] - t.place[2]};
    into(t.turn, away, t.origin);
    for (int k = 0; k < 9; k++) t.axes[k] = coarse(t.turn[k]);
    for (int k = 0; k < 3; k++) t.half[k] = limited(m->halves[row + k]) * (1.0f + COORDINATE_ERROR) + COORDINATE_ERROR;
    return t;
}

static inline Bound bound_of(const Model *m, const double *place, const double *turn, const double *anchor,
                             int32_t solid) {
    Bound bound = {.solid = solid};
    const double *half = m->halves + 3 * (int64_t)solid;
    double centre[3];
    from(turn, m->centres + 3 * (int64_t)solid, centre);
    float far = 0.0f;
    for (int k = 0; k < 3; k++) {
        bound.at[k] = coarse(centre[k] + place[k] - anchor[k]);
        far += fabsf(bound.at[k]);
    }
    const float radius = limited(m->kinds[solid] == SPHERE ? half[0] : sqrt(dot3(half, half)));
    bound.radius = radius * (1.0f + COORDINATE_ERROR) + COORDINATE_ERROR * far + 1e-8f;
    return bound;
}

// A number that grows with the distance of a sphere from the anchor, below DISTANCES: its exponent, and three bits
// more.
static inline uint8_t near_of(const Bound *bound) {
    const float *at = bound->at, away = sqrtf(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]) - bound->radius;
    if (!(away > 0x1p-12f)) return 0;
    if (!(away < 0x1p18f)) return DISTANCES - 1;
    uint32_t bits;
    memcpy(&bits, &away, sizeof bits);
    return (uint8_t)((bits >> 20) - ((127u - 12u) << 3));
}

// Spheres around all solids that are not planes, the nearest first; returns their number.
static inline int32_t bound_solids(const Model *m, const ModelRays *rays, int64_t world, const double *anchor,
                                   const Room *room) {
    int32_t first[DISTANCES] = {0}, sum = 0, count = 0;
    for (int32_t n = 0; n < m->solids; n++) {
        if (m->kinds[n] == PLANE || m->bodies[n] == rays->excluded) continue;
        const int64_t geom = m->geoms[n];
        room->bounds[count] = bound_of(m, rays->positions[world] + 3 * geom, rays->turns[world] + 9 * geom, anchor, n);
        first[near_of(room->bounds + count++)]++;
    }
    for (int32_t k = 0; k < DISTANCES; k++) {
        const int32_t some = first[k];
        first[k] = sum, sum += some;
    }
    for (int32_t n = 0; n < count; n++) room->sorted[first[near_of(room->bounds + n)]++] = room->bounds[n];
    return count;
}

static inline Doubles sign4(Doubles a) { return picked4(a < 0.0, EACH(Doubles, -1.0), EACH(Doubles, 1.0)); }

// The outward normals of a primitive at places on it, in its own frame, of any length.
static inline void normals_at(int32_t kind, const double *size, const Doubles *at, Doubles *to) {
    const Doubles none = EACH(Doubles, 0.0);
    for (int k = 0; k < 3; k++) to[k] = at[k];
    switch (kind) {
        case BOX: {
            const Doubles far[3] = {size4(at[0]), size4(at[1]), size4(at[2])};
            const Longs y = far[1] * size[0] > far[0] * size[1];
            const Doubles most = picked4(y, far[1], far[0]), reach = picked4(y, none + size[1], none + size[0]);
            const Longs z = far[2] * reach > most * size[2];
            to[0] = picked4(y | z, none, sign4(at[0]));
            to[1] = picked4(y & ~z, sign4(at[1]), none);
            to[2] = picked4(z, sign4(at[2]), none);
            break;
        }
        case ELLIPSOID:
            for (int k = 0; k < 3; k++) to[k] = at[k] / (size[k] * size[k]);
            break;
        case CYLINDER: {
            const Doubles radius = root4(at[0] * at[0] + at[1] * at[1]);
            const Longs cap = size4(at[2]) - size[1] > radius - size[0];
            for (int k = 0; k < 2; k++) to[k] = picked4(cap, none, at[k]);
            to[2] = picked4(cap, sign4(at[2]), none);
            break;
        }
        case CAPSULE: {
            const Doubles end = picked4(at[2] > size[1], none + size[1], at[2]);
            to[2] = at[2] - picked4(at[2] < -size[1], none - size[1], end);
            break;
        }
        default:
            break;
    }
}

// The unit normals of a solid that four rays have hit, against the rays; of other lanes, anything.
static inline void find_normals(const Model *m, const ModelRays *rays, int64_t world, const Bundle *b, const Packet *p,
                                int half, int32_t solid, Doubles *to) {
    const int64_t geom = m->geoms[solid];
    const double *place = rays->positions[world] + 3 * geom, *turn = rays->turns[world] + 9 * geom;
    const int32_t kind = m->kinds[solid];
    if (kind == PLANE) {
        // hit from the front
        for (int k = 0; k < 3; k++) to[k] = EACH(Doubles, turn[3 * k + 2]);
        return;
    }
    Doubles own[3], at[3];
    if (kind == MESH) {
        for (int k = 0; k < 4; k++) {
            const int is_met = p->solid[half][k] == solid;
            const double *normal = m->face_normals + 3 * (m->first_faces[solid] + (is_met ? p->face[4 * half + k] : 0));
            for (int j = 0; j < 3; j++) own[j][k] = normal[j];
        }
    } else {
        for (int k = 0; k < 3; k++) {
            const Doubles origin = b->shared ? EACH(Doubles, b->anchor[k]) : p->origin[k][half];
            at[k] = origin - place[k] + p->distance[half] * p->way[k][half];
        }
        Doubles local[3];
        into4(turn, at, local);
        normals_at(kind, m->sizes + 3 * (int64_t)solid, local, own);
    }
    for (int k = 0; k < 3; k++) to[k] = turn[3 * k] * own[0] + turn[3 * k + 1] * own[1] + turn[3 * k + 2] * own[2];
    const Doubles way[3] = {p->way[0][half], p->way[1][half], p->way[2][half]};
    Doubles scale = sign4(-dot34(to, way));
    // those of boxes and triangles are unit vectors already
    if (kind != BOX && kind != MESH) scale /= larger4(root4(dot34(to, to)), EACH(Doubles, 1e-300));
    for (int k = 0; k < 3; k++) to[k] *= scale;
}

// Writes the normals of four rays, of which some hit something.
static inline void write_normals(const Model *m, const ModelRays *rays, int64_t world, const Bundle *b, const Packet *p,
                                 int half, uint32_t hit, double *to) {
    const Longs solids = p->solid[half];
    const int32_t *ray = p->ray + 4 * half;
    while (hit) {
        const int32_t solid = (int32_t)p->solid[half][__builtin_ctz(hit)];
        const Longs same = solids == (int64_t)solid;
        Doubles found[3];
        find_normals(m, rays, world, b, p, half, solid, found);
        const uint32_t met = bits4(&same);
        for (int k = 0; k < 4; k++) {
            if (!(met >> k & 1)) continue;
            double *row = to + 3 * (int64_t)ray[k];
            for (int j = 0; j < 3; j++) row[j] = found[j][k];
        }
        hit &= ~met;
    }
}

static inline __attribute__((always_inline)) void write_packet(const Model *m, const ModelRays *rays, int64_t world,
                                                               int64_t start, const Bundle *b, const Packet *p,
                                                               int count) {
    double *distances = rays->distances + start;
    int32_t *geoms = rays->geoms + start;
    for (int half = 0; half < 2; half++) {
        const int32_t *ray = p->ray + 4 * half;
        const Longs *solids = p->solid + half, hits = *solids >= 0;
        const Doubles found = picked4(hits, p->distance[half] / p->length[half], EACH(Doubles, -1.0));
        for (int k = 0; k < 4 && 4 * half + k < count; k++) {
            const int64_t solid = ((const int64_t *)solids)[k];
            distances[ray[k]] = found[k], geoms[ray[k]] = solid < 0 ? -1 : m->geoms[solid];
        }
        const uint32_t hit = rays->normals ? bits4(&hits) : 0;
        if (hit) write_normals(m, rays, world, b, p, half, hit, rays->normals + 3 * start);
    }
}

static inline void write_hits(const Model *m, const ModelRays *rays, int64_t world, int64_t first, const Bundle *b) {
    const int64_t start = world * rays->rays + first;
    const int32_t whole = b->rays / WIDTH, rest = b->rays % WIDTH;
    for (int32_t n = 0; n < whole; n++) write_packet(m, rays, world, start, b, b->packets + n, WIDTH);
    if (rest) write_packet(m, rays, world, start, b, b->packets + whole, rest);
}

// Passes through the memory of results in order: rays that are sorted write it in any order. There are no normals yet.
static inline void clear_results(const ModelRays *rays, int64_t start, int32_t count) {
    for (int32_t n = 0; n < count; n += WIDTH) {
        __builtin_prefetch(rays->distances + start + n, 1, 2);
        __builtin_prefetch(rays->geoms + start + n, 1, 2);
    }
    if (rays->normals) memset(rays->normals + 3 * start, 0, (size_t)count * 3 * sizeof(double));
}

static void cast_bundle(const Model *m, const ModelRays *rays, int64_t world, int64_t first, const Room *room) {
    Bundle *b = room->bundle;
    clear_results(rays, world * rays->rays + first, b->rays);
    reset_bundle(b, b->is_placed ? rays->limit : -INFINITY);
    for (int32_t n = 0; n < m->solids; n++) {
        if (m->kinds[n] != PLANE || m->bodies[n] == rays->excluded) continue;
        const Target plane = target_of(m, rays, world, b, n);
        meet_plane(b, &plane);
    }
    const int32_t count = bound_solids(m, rays, world, b->anchor, room);
    for (int32_t n = 0; n < count; n++) {
        const Bound *bound = room->sorted + n;
        Target solid = target_of(m, rays, world, b, bound->solid);
        memcpy(solid.at, bound->at, sizeof solid.at);
        solid.radius = bound->radius;
        meet_solid(b, &solid);
    }
    write_hits(m, rays, world, first, b);
}

// Casts all rays; several threads may call it at once, and each takes one piece after another: those of all worlds,
// then the next rays. Each ray is computed independently, so that the distribution over threads does not matter.
void morse_rays_model(const Model *model, ModelRays *rays) {
    const int64_t pieces = (rays->rays + PIECE - 1) / PIECE * rays->worlds;
    const Room *room = rays->rooms + __atomic_fetch_add(&rays->arrived, 1, __ATOMIC_RELAXED);
    const int is_sorted = model->solids * (rays->way_world ? 1 : rays->worlds) > FEW_SOLIDS;
    const double *known_ways = 0, *known_points = 0;
    for (;;) {
        const int64_t piece = __atomic_fetch_add(&rays->next, 1, __ATOMIC_RELAXED), world = piece % rays->worlds;
        if (piece >= pieces) return;
        const int64_t first = piece / rays->worlds * PIECE, left = rays->rays - first;
        const double *ways = rays->ways + world * rays->way_world + 3 * first;
        const double *points = rays->points + world * rays->point_world + first * rays->point_step;
        if (ways != known_ways || (rays->point_step && points != known_points))
            fill_bundle(room->bundle, (int32_t)(left < PIECE ? left : PIECE), points, rays->point_step, ways,
                        is_sorted);
        else
            set_anchor(room->bundle, points);
        known_ways = ways, known_points = points;
        cast_bundle(model, rays, world, first, room);
    }
}
