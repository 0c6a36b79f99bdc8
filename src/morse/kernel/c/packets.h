// Rays in packets of eight with similar directions, and cones around packets, so that a solid is compared with all rays
// of a packet at once, or with none of them.
//
// Cones and spheres are in single precision and too large rather than too small: results do not depend on them.
#pragma once

#include <string.h>

#include "primitives.h"
#include "ray.h"

enum { PIECE = 1024, PACKETS = PIECE / WIDTH, BLOCKS = PACKETS / WIDTH, CELLS = 16 };

// Bounds of the rounding errors of single precision: of coordinates, and of squares of distances.
#define COORDINATE_ERROR 1e-6f
#define SQUARE_ERROR 4e-6f

typedef float FourFloats __attribute__((vector_size(16)));

typedef struct {
    Doubles way[3][2], origin[3][2];  // unit vectors; no origins if all rays have the same one
    Doubles length[2];                // of the directions as they were given; 0 for lanes without a ray
    Doubles distance[2];              // the nearest so far; minus infinity for lanes without a ray
    Longs solid[2];                   // the nearest so far, -1 for none
    Floats coarse_way[3], coarse_origin[3];
    int32_t face[WIDTH], ray[WIDTH];  // triangle of a mesh; number of the ray, -1 for none
} Packet;

// Cones around eight packets, or around eight times eight: the rays of each begin within `spread` of its apex.
typedef struct {
    Floats axis[3], apex[3], cosine, sine, spread;
} Cones;

// The rays that a thread casts at once; places in single precision are relative to the anchor.
typedef struct {
    Packet packets[PACKETS];
    Cones cones[BLOCKS], wide[BLOCKS / WIDTH];
    double anchor[3];
    int32_t rays, is_sorted, shared, is_placed;  // shared: all rays begin at the anchor; whether that is finite
    int32_t order[PIECE];
    uint8_t cells[PIECE];
} __attribute__((aligned(32))) Bundle;

_Static_assert(sizeof(Bundle) == 116864, "Python allocates bundles of that size");

// In single precision, without numbers whose products would be denormal: these take ten times as long.
static inline float coarse(double x) { return fabs(x) < 1e-9 ? 0.0f : limited(x); }

static inline Floats sizes_of(Floats a) { return CHOSEN(a < 0.0f, -a, a); }

// The four numbers of each half as one vector, in single precision.
static inline Floats narrowed(const Doubles *halves) {
    Floats all;
    for (int h = 0; h < 2; h++) {
        const FourFloats half = __builtin_convertvector(halves[h], FourFloats);
        memcpy((float *)&all + 4 * h, &half, sizeof half);
    }
    return all;
}

// The cells of eight directions on an octahedron that is unfolded to a square (Meyer et al. 2010).
static inline Ints cells_of(const Floats *way) {
    const Floats scale = 0.5f * CELLS / (sizes_of(way[0]) + sizes_of(way[1]) + sizes_of(way[2]));
    const Floats u = way[0] * scale, v = way[1] * scale;
    const Floats a = 0.5f * CELLS - sizes_of(v), b = 0.5f * CELLS - sizes_of(u);
    Floats at[2] = {CHOSEN(way[2] < 0.0f, CHOSEN(u < 0.0f, -a, a), u),
                    CHOSEN(way[2] < 0.0f, CHOSEN(v < 0.0f, -b, b), v)};
    Ints cell = EACH(Ints, 0);
    for (int k = 0; k < 2; k++) {
        const Floats place = at[k] + 0.5f * CELLS;
        // written so that NaN gives a cell, too
        const Floats lower = CHOSEN(place > 0.0f, place, EACH(Floats, 0.0f));
        Ints n = __builtin_convertvector(CHOSEN(lower < CELLS - 1.0f, lower, EACH(Floats, CELLS - 1.0f)), Ints);
        // along a curve of Morton: a bit of one after a bit of the other
        n = (n | n << 2) & 0x33, n = (n | n << 1) & 0x55;
        cell |= n << k;
    }
    return cell;
}

// Rays with similar directions one after another.
static inline void sort_rays(Bundle *b, const double *ways) {
    int32_t first[CELLS * CELLS] = {0}, sum = 0;
    for (int32_t n = 0; n < b->rays; n += WIDTH) {
        Floats way[3];
        for (int k = 0; k < WIDTH; k++) {
            const double *one = ways + 3 * (n + k < b->rays ? n + k : n);
            for (int j = 0; j < 3; j++) way[j][k] = (float)one[j];
        }
        const Ints cells = cells_of(way);
        for (int k = 0; k < WIDTH && n + k < b->rays; k++) first[b->cells[n + k] = (uint8_t)cells[k]]++;
    }
    for (int32_t k = 0; k < CELLS * CELLS; k++) {
        const int32_t count = first[k];
        first[k] = sum, sum += count;
    }
    for (int32_t n = 0; n < b->rays; n++) b->order[first[b->cells[n]]++] = n;
}

// The unit vectors of four directions, and their lengths; 0 for directions that are 0 or not finite.
static inline void unit_ways(Doubles *way, Doubles *length) {
    Doubles most = size4(way[0]);
    for (int k = 1; k < 3; k++) most = larger4(most, size4(way[k]));
    const Longs good = (most > 0.0) & (most < (double)INFINITY);
    // squares of very long and very short directions are not finite, or 0: scaled by a power of 2, without rounding
    const Longs exponent = 2045 - ((Longs)most >> 52), power = exponent + ((exponent < 1) & (1 - exponent));
    const Doubles scale = (Doubles)(power << 52);
    for (int k = 0; k < 3; k++) way[k] *= scale;
    const Doubles root = root4(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
    *length = picked4(good, root / scale, EACH(Doubles, 0.0));
    for (int k = 0; k < 3; k++) way[k] = picked4(good, way[k] / root, EACH(Doubles, 0.0));
}

static inline void set_cone(Cones *cones, int lane, const float *axis, float cosine, const float *apex, float spread) {
    const int whole = !(cosine > 0.01f);
    for (int k = 0; k < 3; k++) {
        cones->axis[k][lane] = axis[k], cones->apex[k][lane] = apex[k];
        spread += COORDINATE_ERROR * fabsf(apex[k]);
    }
    cones->cosine[lane] = whole ? 0.0f : cosine;
    cones->sine[lane] = whole ? 0.0f : sqrtf(1.0f - cosine * cosine) + COORDINATE_ERROR;
    cones->spread[lane] = spread;
}

static const float NO_RAY[3] = {0.0f, 0.0f, 0.0f};

// A cone that no solid meets.
static inline void set_no_cone(Cones *cones, int lane) { set_cone(cones, lane, NO_RAY, 0.0f, NO_RAY, -INFINITY); }

static inline float sum_of(const Floats *a) {
    FourFloats half[2];
    memcpy(half, a, sizeof half);
    half[0] += half[1];
    return (half[0][0] + half[0][1]) + (half[0][2] + half[0][3]);
}

static inline float smaller_of(float a, float b) { return a < b ? a : b; }

static inline float least_of(const Floats *a) {
    float four[4];
    for (int k = 0; k < 4; k++) four[k] = smaller_of((*a)[k], (*a)[4 + k]);
    return smaller_of(smaller_of(four[0], four[1]), smaller_of(four[2], four[3]));
}

// The cone around eight unit vectors, of which those that are 0 do not count; false if there are none.
static inline int cone_around(const Floats *way, float *axis, float *cosine) {
    float square = 0.0f;
    for (int k = 0; k < 3; k++) axis[k] = sum_of(way + k), square += axis[k] * axis[k];
    const Ints none = (way[0] == 0.0f) & (way[1] == 0.0f) & (way[2] == 0.0f);
    if (bits8(&none) == 255u) return 0;
    const float scale = square > 1e-6f ? 1.0f / sqrtf(square) : 0.0f;
    for (int k = 0; k < 3; k++) axis[k] = scale > 0.0f ? axis[k] * scale : (float)(k == 0);
    const Floats dots = way[0] * axis[0] + way[1] * axis[1] + way[2] * axis[2];
    const Floats counted = CHOSEN(none, EACH(Floats, 1.0f), dots);
    const float least = least_of(&counted) - 2.0f * COORDINATE_ERROR;
    *cosine = scale > 0.0f ? least : -1.0f;
    return 1;
}

// The sphere around the origins of eight rays, or around eight spheres, of which those that are empty do not count.
static inline float sphere_around(const Floats *at, const Floats *radius, const Ints *counted, float *middle) {
    for (int k = 0; k < 3; k++) {
        const Floats low = CHOSEN(*counted, at[k], EACH(Floats, INFINITY));
        const Floats high = CHOSEN(*counted, -at[k], EACH(Floats, INFINITY));
        middle[k] = 0.5f * least_of(&low) - 0.5f * least_of(&high);
    }
    const Floats x = at[0] - middle[0], y = at[1] - middle[1], z = at[2] - middle[2];
    float most = 0.0f;
    for (int k = 0; k < WIDTH; k++) {
        if (!(*counted)[k]) continue;
        const float reach = sqrtf(x[k] * x[k] + y[k] * y[k] + z[k] * z[k]) * WIDER + (*radius)[k];
        most = reach > most ? reach : most;
    }
    return most;
}

static inline void fill_packet(Bundle *b, int32_t number, const double *points, int64_t step, const double *ways) {
    static const double nothing[3] = {0.0, 0.0, 0.0};
    Packet *p = b->packets + number;
    const double *way[WIDTH];
    Longs finite[2] = {EACH(Longs, -1), EACH(Longs, -1)};
    for (int k = 0; k < WIDTH; k++) {
        const int32_t place = number * WIDTH + k, n = place < b->rays ? b->is_sorted ? b->order[place] : place : -1;
        p->ray[k] = n, way[k] = n < 0 ? nothing : ways + 3 * n;
        if (b->shared) continue;
        for (int j = 0; j < 3; j++) {
            double at = n < 0 ? b->anchor[j] : points[step * n + j];
            if (!isfinite(at)) finite[k / 4][k % 4] = 0, at = b->anchor[j];
            p->origin[j][k / 4][k % 4] = at;
            p->coarse_origin[j][k] = coarse(at - b->anchor[j]);
        }
    }
    for (int h = 0; h < 2; h++) {
        const double *const *four = way + 4 * h;
        Doubles unit[3];
        for (int j = 0; j < 3; j++) {
            unit[j] = (Doubles){four[0][j], four[1][j], four[2][j], four[3][j]};
            unit[j] = picked4(finite[h], unit[j], EACH(Doubles, 0.0));
        }
        unit_ways(unit, &p->length[h]);
        for (int j = 0; j < 3; j++) p->way[j][h] = unit[j];
    }
    for (int j = 0; j < 3; j++) {
        const Floats rough = narrowed(p->way[j]);
        p->coarse_way[j] = CHOSEN(sizes_of(rough) < 1e-9f, EACH(Floats, 0.0f), rough);
    }
}

// Rays with different origins may begin elsewhere if the anchor is not finite.
static inline void set_anchor(Bundle *b, const double *point) {
    const int is_finite = isfinite(point[0] + point[1] + point[2]);
    for (int k = 0; k < 3; k++) b->anchor[k] = is_finite ? point[k] : 0.0;
    b->is_placed = is_finite || !b->shared;
}

// The cone around the rays of a packet.
static inline void set_cone_of(const Bundle *b, const Packet *p, Cones *cones, int lane) {
    const Floats no_radius = EACH(Floats, 0.0f);
    float axis[3], cosine, apex[3] = {0.0f, 0.0f, 0.0f}, spread = 0.0f;
    if (!cone_around(p->coarse_way, axis, &cosine)) {
        set_no_cone(cones, lane);
        return;
    }
    const Ints counted = (p->coarse_way[0] != 0.0f) | (p->coarse_way[1] != 0.0f) | (p->coarse_way[2] != 0.0f);
    if (!b->shared) spread = sphere_around(p->coarse_origin, &no_radius, &counted, apex);
    set_cone(cones, lane, axis, cosine, apex, spread);
}

// The cone around eight cones: the angle between their axes and the largest of their half angles, added.
static inline void set_wide_cone(const Cones *inner, Cones *wide, int lane) {
    float axis[3], cosine, apex[3], sine = 0.0f, least = 1.0f;
    if (!cone_around(inner->axis, axis, &cosine)) {
        set_no_cone(wide, lane);
        return;
    }
    const Ints counted = inner->spread >= 0.0f;
    for (int k = 0; k < WIDTH; k++) {
        if (!counted[k]) continue;
        sine = inner->sine[k] > sine ? inner->sine[k] : sine;
        least = smaller_of(inner->cosine[k], least);
    }
    const float between = cosine > 0.0f ? sqrtf(1.0f - cosine * cosine) + COORDINATE_ERROR : 1.0f;
    const float both = least > 0.0f && cosine > 0.0f ? cosine * least - between * sine - COORDINATE_ERROR : -1.0f;
    const float spread = sphere_around(inner->apex, &inner->spread, &counted, apex);
    set_cone(wide, lane, axis, both, apex, spread);
}

// Fills a bundle with rays whose directions and, with a step that is not 0, origins are given. Sorted rays have cones.
static inline void fill_bundle(Bundle *b, int32_t rays, const double *points, int64_t step, const double *ways,
                               int is_sorted) {
    b->rays = rays, b->shared = step == 0, b->is_sorted = is_sorted;
    set_anchor(b, points);
    if (is_sorted) sort_rays(b, ways);
    const int32_t packets = (rays + WIDTH - 1) / WIDTH, blocks = (packets + WIDTH - 1) / WIDTH;
    for (int32_t n = 0; n < packets; n++) fill_packet(b, n, points, step, ways);
    if (!is_sorted) return;
    for (int32_t n = 0; n < blocks * WIDTH; n++) {
        if (n < packets)
            set_cone_of(b, b->packets + n, b->cones + n / WIDTH, n % WIDTH);
        else
            set_no_cone(b->cones + n / WIDTH, n % WIDTH);
    }
    for (int32_t n = 0; n < (blocks + WIDTH - 1) / WIDTH * WIDTH; n++) {
        if (n < blocks)
            set_wide_cone(b->cones + n, b->wide + n / WIDTH, n % WIDTH);
        else
            set_no_cone(b->wide + n / WIDTH, n % WIDTH);
    }
}

// Forgets all hits; rays end at a limit.
static inline void reset_bundle(Bundle *b, double limit) {
    for (int32_t n = 0; n * WIDTH < b->rays; n++) {
        Packet *p = b->packets + n;
        for (int h = 0; h < 2; h++) {
            p->distance[h] = picked4(p->length[h] > 0.0, EACH(Doubles, limit), EACH(Doubles, -INFINITY));
            p->solid[h] = EACH(Longs, -1);
        }
    }
}

// A bit for each of eight cones that a sphere meets.
static inline uint32_t met_cones(const Cones *c, const float *at, float radius) {
    const Floats x = at[0] - c->apex[0], y = at[1] - c->apex[1], z = at[2] - c->apex[2];
    const Floats along = x * c->axis[0] + y * c->axis[1] + z * c->axis[2], square = x * x + y * y + z * z;
    const Floats reach = radius + c->spread + along * c->sine + 2.0f * COORDINATE_ERROR * sizes_of(along);
    const Floats beside = (square - along * along) * (c->cosine * c->cosine);
    const Ints met = (beside <= reach * reach + square * SQUARE_ERROR) & (reach >= 0.0f);
    return bits8(&met);
}
