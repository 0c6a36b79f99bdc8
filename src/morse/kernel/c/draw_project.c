// Projects the triangles that may be visible to each camera.
//
// Edge functions in homogeneous coordinates (M. Olano and T. Greer, "Triangle scan conversion using 2D homogeneous
// coordinates", 1997): no triangle is clipped, and the edge functions also give barycentric coordinates.
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "draw_bin.h"
#include "draw_corners.h"
#include "simd.h"

// Limit of the coefficients of 1 / depth, so that the values at all pixels are finite.
#define LARGEST 1e30f
// A column or row beyond all images.
#define BEYOND 32768.0
// Bound of the rounding error of areas, relative to the coordinates.
#define CERTAIN 1e-12

// What is the same for all triangles of a camera.
typedef struct {
    D4 reach, first;  // distance of samples from the corners of their pixels; the limits of bounds
    F8 dx, dy;        // the positions of the samples of a pixel
    int samples;
} Grid;

static Grid grid_of(const Frame *f, const Camera *k) {
    // samples other than the centres of pixels are for colours only
    const int samples = k->color ? f->sample_count : 1;
    const double reach = samples > 1 ? 0.9 : 0.5;
    Grid g = {.reach = {reach, reach, reach - 1, reach - 1},
              .first = {0, 0, 1 - (double)k->width, 1 - (double)k->height},
              .samples = samples};
    EACH_LANE(j) {
        const float *by = f->samples + (j < f->sample_count ? 2 * j : 0);
        g.dx[j] = by[0], g.dy[j] = by[1];
    }
    return g;
}

// A triangle that may be visible: its lowest pixels (x, y, -x, -y).
typedef struct {
    I4 low;
    int32_t triangle, material;
} Candidate;

// Pixels whose samples may lie in a triangle, from its lowest coordinates (x, y, -x, -y); returns whether there are
// any.
static inline int lowest_pixels(const Grid *g, D4 low, I4 *to) {
    D4 r;
    low -= g->reach;
    EACH(i, 4) {
        const double whole = ceil(low[i]);
        r[i] = whole > g->first[i] ? whole : g->first[i];
    }
    // all images are smaller; larger numbers are no integers
    *to = __builtin_convertvector(lesser_four(r, all_four(BEYOND)), I4);
    return !((r[0] + r[2] > 0) | (r[1] + r[3] > 0));
}

// Whether a triangle is seen from behind, beyond doubt: of triangles that are nearly seen from the side, `planes`
// decides. All of it is between the near and the far plane.
static inline int is_back(const Corner *const *q, D4 low, int mirrored) {
    const D4 a = q[1]->place - q[0]->place, b = q[2]->place - q[0]->place;
    const double area = a[0] * b[1] - a[1] * b[0];
    const double most = CERTAIN * (fabs(low[0]) + fabs(low[2]) + 1) * (fabs(low[1]) + fabs(low[3]) + 1);
    return (mirrored ? -area : area) > most;
}

static inline D4 turned(D4 a) { return (D4){a[1], a[2], a[0], a[3]}; }

static inline D4 cross(D4 a, D4 b) {
    const D4 c = turned(a), d = turned(b);
    return c * turned(d) - turned(c) * d;
}

static inline void store(float *to, D4 from) {
    const F4 r = __builtin_convertvector(from, F4);
    memcpy(to, &r, sizeof r);
}

// Whether the back face of a triangle is not visible.
static inline int hides_back(int flags, int closed) {
    return !(flags & DOUBLE_SIDED) | ((closed != 0) & !(flags & (MASKED | DITHERED)));
}

// Of parallel rays, see `depth_at`.
static inline D4 nearness(const Camera *k, const Corner *q) { return all_four((double)reach_of(k) - q->at[3]); }

// The planes of a triangle; 0 if it is not visible from this side.
static inline int planes(const Frame *f, const Camera *k, const Part *part, const Corner *const *q, int closed,
                         Seen *s) {
    const D4 e[3] = {cross(q[1]->at, q[2]->at), cross(q[2]->at, q[0]->at), cross(q[0]->at, q[1]->at)};
    const D4 terms = q[0]->at * e[0];
    const double volume = terms[0] + terms[1] + terms[2];
    if (!(volume > 0 || volume < 0)) return 0;
    // y points down: the volume of a front face is negative
    const int back = (volume > 0) != ((part->flags & MIRRORED) != 0);
    if (back && hides_back(f->materials[s->material].flags, closed)) return 0;
    const D4 sign = all_four(volume > 0 ? 1 : -1);
    // each of them writes one number too many, which the next one replaces
    EACH(i, 3) store(s->e[i], sign * e[i]);
    const D4 w = k->parallel ? e[0] * nearness(k, q[0]) + e[1] * nearness(k, q[1]) + e[2] * nearness(k, q[2])
                             : e[0] + e[1] + e[2];
    store(s->w, w / all_four(volume));
    s->back = back;
    return fabsf(s->w[0]) + fabsf(s->w[1]) + fabsf(s->w[2]) < LARGEST;
}

// Whether some of eight samples may be inside a triangle: the same numbers as when it is drawn.
static inline int contains_some(const Seen *s, F8 x, F8 y) {
    I8 out = splat_int(0);
    EACH(i, 3) out |= bits_of(s->e[i][0] * x + (s->e[i][1] * y + s->e[i][2] + 0.0f));
    return lanes_of(~out) != 0;
}

// Whether a triangle may cover a sample; decided only for the smallest, which are many and mostly between samples.
static int reaches_samples(const Seen *s, const Bounds *b, const Grid *g) {
    const int wide = b->x1 - b->x0, high = b->y1 - b->y0;
    if (g->samples == 1) {
        if (wide > 3 || high > 1) return 1;
        const I8 lane = {0, 1, 2, 3, 4, 5, 6, 7};
        return contains_some(s, to_float(lane & 3) + ((float)b->x0 + 0.5f),
                             to_float(lane >> 2) + ((float)b->y0 + 0.5f));
    }
    if (wide + high > 1) return 1;
    for (int y = b->y0; y <= b->y1; y++)
        for (int x = b->x0; x <= b->x1; x++) {
            const int lane = x % LANES;
            if (contains_some(s, (float)lane + ((float)(x - lane) + 0.5f + g->dx), (float)y + 0.5f + g->dy)) return 1;
        }
    return 0;
}

// Whether the closed parts of a cluster are beyond the near plane.
static int is_outside(const Frame *f, const Camera *k, const Part *part) {
    const float *m = f->models[part->instance], *s = f->spheres[part->cluster], *r = k->axes;
    float x[3];
    EACH(i, 3) x[i] = m[4 * i] * s[0] + m[4 * i + 1] * s[1] + m[4 * i + 2] * s[2] + m[4 * i + 3] - k->eye[i];
    return r[6] * x[0] + r[7] * x[1] + r[8] * x[2] - f->guards[part->cluster] * stretch_of(m) >= k->near;
}

// Finds the triangles of a part that may be visible; returns their number. Without branches: the processor would
// predict them wrongly.
static inline int find_candidates(const Frame *f, const Camera *k, const Grid *g, const Part *part,
                                  const Corner *corners, int between, int closed, Candidate *to) {
    const Cluster *cluster = f->clusters + part->cluster;
    const int32_t *slots = f->slots + part->slots;
    const int mirrored = (part->flags & MIRRORED) != 0;
    int count = 0;
    for (int t = cluster->triangle; t < cluster->triangle + cluster->triangles; t++) {
        const uint16_t *c = f->corners[t];
        const Corner *q[3] = {corners + c[0], corners + c[1], corners + c[2]};
        const D4 low = between ? lowest(q) : lowest_visible(q, k);
        Candidate *candidate = to + count;
        candidate->triangle = t, candidate->material = slots[f->triangles[t][3]];
        const int hidden = hides_back(f->materials[candidate->material].flags, closed & f->closed[t]);
        count += lowest_pixels(g, low, &candidate->low) & !(between & hidden & is_back(q, low, mirrored));
    }
    return count;
}

// The triangles of a part; returns the end.
static int64_t project_part(const Frame *f, const Camera *k, const Grid *g, int32_t number, int64_t to,
                            int32_t *share) {
    Corner corners[MOST_VERTICES];
    Candidate candidates[MOST_TRIANGLES + 1];
    double a[4][4];
    const Part *part = f->parts + number;
    const Cluster *cluster = f->clusters + part->cluster;
    projection(k, f->models[part->instance], a);
    if (!is_finite(a, f->spheres[part->cluster])) return to;
    const float (*points)[3] = (const float (*)[3])(f->points + cluster->vertex);
    const int closed = is_outside(f, k, part) ? (part->flags & SOLID ? CLOSED | MIXED : CLOSED) : 0,
              between = project_corners(k, a, points, f->point_counts[part->cluster], corners),
              count = find_candidates(f, k, g, part, corners, between, closed, candidates);
    EACH(n, count) {
        const Candidate *candidate = candidates + n;
        const int t = candidate->triangle;
        const I4 low = candidate->low;
        const uint16_t *c = f->corners[t];
        const Corner *q[3] = {corners + c[0], corners + c[1], corners + c[2]};
        Seen *s = f->seen + to;
        Bounds *b = f->bounds + to;
        *b = (Bounds){(int16_t)low[0], (int16_t)low[1], (int16_t)-low[2], (int16_t)-low[3]};
        s->material = candidate->material;
        if (!planes(f, k, part, q, closed & f->closed[t], s) || !reaches_samples(s, b, g)) continue;
        s->triangle = t, s->part = number;
        add_to_tiles(f, k, to++, share, NULL);
    }
    return to;
}

// Projects the triangles of a chunk, and counts them in the tiles.
void draw_project(Frame *f, int64_t piece) {
    const Chunk *chunk = f->chunks + piece;
    const Camera *k = f->cameras + chunk->camera;
    const Grid g = grid_of(f, k);
    int32_t *share = f->shares + chunk->row;
    memset(share, 0, sizeof *share * (size_t)tiles_of(k));
    for (int32_t j = chunk->first; j < chunk->end; j++) {
        f->counts[j] = project_part(f, k, &g, f->jobs[j][1], f->starts[j], share) - f->starts[j];
    }
}
