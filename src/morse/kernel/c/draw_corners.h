// The vertices of a cluster in the image of a camera.
#pragma once
#include <math.h>
#include <stdint.h>

#include "drawing.h"

typedef double D4 __attribute__((vector_size(32)));

// Limit of projected coordinates, so that the values at all pixels are finite.
#define FARTHEST 1e15
// Margin of clipped coordinates: pixels, and relative to their terms.
#define CLIP_MARGIN 1.0
#define CLIP_ROUNDING 1e-14

// A vertex: (x w, y w, w, depth), and (x, y, -x, -y) in pixels. For pinholes, w is the depth, for parallel rays 1.
typedef struct {
    D4 at, place;
} Corner;

static inline D4 all_four(double a) { return (D4){a, a, a, a}; }

static inline D4 lesser_four(D4 a, D4 b) {
    D4 r;
    EACH(i, 4) r[i] = a[i] < b[i] ? a[i] : b[i];
    return r;
}

// An upper bound of the largest stretch of a model: the Frobenius norm, also for sheared parts.
static inline float stretch_of(const float *m) {
    float scale = 0;
    EACH(i, 3) scale += m[i] * m[i] + m[4 + i] * m[4 + i] + m[8 + i] * m[8 + i];
    return sqrtf(scale);
}

// An upper bound of the largest stretch of a model that is exact for rotations: the root of the largest sum of a row of
// its square.
static inline float scale_of(const float *m) {
    float most = 0;
    EACH(i, 3) {
        float row = 0;
        EACH(j, 3) row += fabsf(m[i] * m[j] + m[4 + i] * m[4 + j] + m[8 + i] * m[8 + j]);
        most = row > most ? row : most;
    }
    return sqrtf(most);
}

// Mesh to (x w, y w, w, depth) of a camera. Differences of positions are computed first, in double precision.
static inline void projection(const Camera *k, const float *m, double a[4][4]) {
    const float *r = k->axes;
    EACH(i, 4) {
        double x[3];
        EACH(n, 3) x[n] = m[4 * n + i] - (i == 3 ? (double)k->eye[n] : 0);
        a[3][i] = r[6] * x[0] + r[7] * x[1] + r[8] * x[2];
        a[2][i] = k->parallel ? i == 3 : a[3][i];
        a[0][i] = k->fx * (r[0] * x[0] + r[1] * x[1] + r[2] * x[2]) + k->cx * a[2][i];
        a[1][i] = k->fy * (r[3] * x[0] + r[4] * x[1] + r[5] * x[2]) + k->cy * a[2][i];
    }
}

// Whether the coordinates of all vertices in a sphere are finite.
static inline int is_finite(double a[4][4], const float *s) {
    int fine = 1;
    EACH(i, 4) {
        double most = fabs(a[i][3]);
        EACH(n, 3) most += fabs(a[i][n]) * ((double)fabsf(s[n]) + (double)s[3]);
        fine &= most < FARTHEST;
    }
    return fine;
}

// The depth in front of which triangles are clipped for their bounds: no sample is visible there.
static inline double cut_of(const Camera *k) { return (double)k->near / 2; }

// Projects the vertices of a cluster; returns whether all of them are between the near and the far plane.
static inline int project_corners(const Camera *k, double a[4][4], const float (*points)[3], int count, Corner *to) {
    const D4 x = {a[0][0], a[1][0], a[2][0], a[3][0]}, y = {a[0][1], a[1][1], a[2][1], a[3][1]};
    const D4 z = {a[0][2], a[1][2], a[2][2], a[3][2]}, base = {a[0][3], a[1][3], a[2][3], a[3][3]};
    const D4 signs = {1, 1, -1, -1};
    const double near = k->near, far = k->far, cut = k->parallel ? 0 : cut_of(k);
    int between = 1;
    EACH(v, count) {
        const float *p = points[v];
        const D4 at = x * (double)p[0] + y * (double)p[1] + z * (double)p[2] + base;
        const double w = at[2], depth = at[3];
        between &= depth >= near && depth <= far;
        to[v].at = at;
        const D4 place = {at[0], at[1], at[0], at[1]};
        to[v].place = place / all_four(w < cut ? 1 : w) * signs;
    }
    return between;
}

// The lowest coordinates (x, y, -x, -y) of a triangle between the near and the far plane.
static inline D4 lowest(const Corner *const *q) {
    return lesser_four(lesser_four(q[0]->place, q[1]->place), q[2]->place);
}

// The same for the visible part of any triangle; far beyond the image if nothing is visible.
static inline D4 lowest_visible(const Corner *const *q, const Camera *k) {
    const double w[3] = {q[0]->at[3], q[1]->at[3], q[2]->at[3]}, near = k->near, far = k->far, cut = cut_of(k);
    D4 low = all_four(FARTHEST);
    if ((w[0] < near && w[1] < near && w[2] < near) || (w[0] > far && w[1] > far && w[2] > far)) return low;
    // of parallel rays, all points have a place
    if (k->parallel) return lowest(q);
    EACH(i, 3) {
        const int n = (i + 1) % 3;
        if (w[i] >= cut) low = lesser_four(low, q[i]->place);
        if ((w[i] < cut) == (w[n] < cut)) continue;
        // the edge crosses the plane: the same numbers in both directions
        const D4 a = w[i] < cut ? q[i]->at : q[n]->at, b = w[i] < cut ? q[n]->at : q[i]->at;
        const double t = (cut - a[2]) / (b[2] - a[2]);
        D4 place;
        EACH(j, 2) {
            const double at = (a[j] + t * (b[j] - a[j])) / cut;
            const double margin = CLIP_MARGIN + CLIP_ROUNDING * (fabs(a[j]) + fabs(b[j])) / cut;
            place[j] = at - margin, place[j + 2] = -at - margin;
        }
        low = lesser_four(low, place);
    }
    return low;
}
