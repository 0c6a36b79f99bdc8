// Finds the triangles that may be visible to each camera, and projects them.
//
// Edge functions in homogeneous coordinates (M. Olano and T. Greer, "Triangle scan conversion using 2D homogeneous
// coordinates", 1997): no triangle is clipped, and the edge functions also give barycentric coordinates.
#include <math.h>
#include <stdint.h>

#include "drawing.h"
#include "export.h"
#include "simd.h"

// Maximum number of vertices of a cluster.
#define MOST_VERTICES (3 * 256)
// Clusters smaller than this many pixels are left out.
#define SMALLEST 0.25f

// Limits of projected coordinates and of the coefficients of 1 / depth, so that the values at all pixels are finite.
#define FARTHEST 1e15
#define LARGEST 1e30f

MORSE_EXPORT int32_t morse_draw_find(Frame *f);
MORSE_EXPORT void morse_draw_project(Frame *f);

static int may_be_seen(const Camera *k, const float *m, const float *s) {
    const float *r = k->axes, fx = k->fx, fy = k->fy;
    const float side[4] = {k->cx, (float)k->width - k->cx, k->cy, (float)k->height - k->cy};
    float x[3], q[3], scale = 0, length[4];
    EACH(i, 4) length[i] = sqrtf((i < 2 ? fx * fx : fy * fy) + side[i] * side[i]);
    EACH(i, 3) x[i] = m[4 * i] * s[0] + m[4 * i + 1] * s[1] + m[4 * i + 2] * s[2] + m[4 * i + 3] - k->eye[i];
    // the Frobenius norm is an upper bound of the largest stretch, also for sheared parts
    EACH(i, 3) scale += m[i] * m[i] + m[4 + i] * m[4 + i] + m[8 + i] * m[8 + i];
    EACH(i, 3) q[i] = r[3 * i] * x[0] + r[3 * i + 1] * x[1] + r[3 * i + 2] * x[2];
    const float size = s[3] * sqrtf(scale);
    if (!(q[2] >= k->near - size && q[2] <= k->far + size)) return 0;
    if (q[2] > size && (fx > fy ? fx : fy) * size < SMALLEST * q[2]) return 0;
    if (side[0] * q[2] + fx * q[0] < -size * length[0] || side[1] * q[2] - fx * q[0] < -size * length[1]) return 0;
    return side[2] * q[2] + fy * q[1] >= -size * length[2] && side[3] * q[2] - fy * q[1] >= -size * length[3];
}

// Pairs of camera and part that may be visible; returns their number.
int32_t morse_draw_find(Frame *f) {
    int32_t count = 0;
    EACH(c, f->camera_count) EACH(p, f->part_count) {
        const Part *part = f->parts + p;
        if (!may_be_seen(f->cameras + c, f->models[part->instance], f->spheres[part->cluster])) continue;
        f->jobs[count][0] = c, f->jobs[count++][1] = p;
    }
    return count;
}

// Pixels whose samples may lie in a triangle with the corners (x w, y w, w, x, y); 0 if none. If the triangle reaches
// behind the camera, all pixels: the tiles test it.
static int bounds(const double *q[3], const Camera *k, double reach, Seen *s) {
    double x0 = 1e9, y0 = 1e9, x1 = -1e9, y1 = -1e9;
    const int behind = (q[0][2] < k->near) + (q[1][2] < k->near) + (q[2][2] < k->near);
    EACH(i, 3) {
        const double x = q[i][3], y = q[i][4];
        x0 = x < x0 ? x : x0, x1 = x > x1 ? x : x1, y0 = y < y0 ? y : y0, y1 = y > y1 ? y : y1;
    }
    x0 -= reach, y0 -= reach, x1 += reach - 1, y1 += reach - 1;
    if (behind) x0 = y0 = 0, x1 = k->width, y1 = k->height;
    if (behind == 3 || !(x1 >= 0 && y1 >= 0 && x0 < k->width && y0 < k->height)) return 0;
    s->x0 = (int16_t)(x0 > 0 ? ceil(x0) : 0), s->y0 = (int16_t)(y0 > 0 ? ceil(y0) : 0);
    s->x1 = (int16_t)(x1 < k->width - 1 ? x1 : k->width - 1),
    s->y1 = (int16_t)(y1 < k->height - 1 ? y1 : k->height - 1);
    return s->x0 <= s->x1 && s->y0 <= s->y1;
}

// Mesh to (x w, y w, w) of a camera. Differences of positions are computed first, in double precision.
static void projection(const Camera *k, const float *m, double a[3][4]) {
    const float *r = k->axes;
    EACH(i, 4) {
        double x[3];
        EACH(n, 3) x[n] = m[4 * n + i] - (i == 3 ? (double)k->eye[n] : 0);
        a[2][i] = r[6] * x[0] + r[7] * x[1] + r[8] * x[2];
        a[0][i] = k->fx * (r[0] * x[0] + r[1] * x[1] + r[2] * x[2]) + k->cx * a[2][i];
        a[1][i] = k->fy * (r[3] * x[0] + r[4] * x[1] + r[5] * x[2]) + k->cy * a[2][i];
    }
}

// Whether the coordinates of all vertices in a sphere are finite.
static int is_finite(double a[3][4], const float *s) {
    int fine = 1;
    EACH(i, 3) {
        double most = fabs(a[i][3]);
        EACH(n, 3) most += fabs(a[i][n]) * ((double)fabsf(s[n]) + (double)s[3]);
        fine &= most < FARTHEST;
    }
    return fine;
}

// The planes of a triangle; 0 if it is not visible from this side.
static int planes(const Frame *f, const Part *part, const double *q[3], Seen *s) {
    double e[3][3];
    EACH(i, 3) {
        const double *b = q[(i + 1) % 3], *c = q[(i + 2) % 3];
        e[i][0] = b[1] * c[2] - b[2] * c[1], e[i][1] = b[2] * c[0] - b[0] * c[2], e[i][2] = b[0] * c[1] - b[1] * c[0];
    }
    const double volume = q[0][0] * e[0][0] + q[0][1] * e[0][1] + q[0][2] * e[0][2];
    if (!(volume > 0 || volume < 0)) return 0;
    // y points down: the volume of a front face is negative
    s->back = (volume > 0) != ((part->flags & MIRRORED) != 0);
    if (s->back && !(f->materials[s->material].flags & DOUBLE_SIDED)) return 0;
    EACH(i, 3) EACH(n, 3) s->e[i][n] = (float)(volume > 0 ? e[i][n] : -e[i][n]);
    EACH(n, 3) s->w[n] = (float)((e[0][n] + e[1][n] + e[2][n]) / volume);
    return fabsf(s->w[0]) + fabsf(s->w[1]) + fabsf(s->w[2]) < LARGEST;
}

// Whether some of eight samples may be inside a triangle: the same numbers as when it is drawn.
static inline int contains_some(const Seen *s, F8 x, F8 y) {
    I8 out = splat_int(0);
    EACH(i, 3) out |= bits_of(s->e[i][0] * x + (s->e[i][1] * y + s->e[i][2] + 0.0f));
    return lanes_of(~out) != 0;
}

// Whether a triangle may cover a sample; decided only for the smallest, which are many and mostly between samples.
static int reaches_samples(const Seen *s, F8 dx, F8 dy, int samples) {
    const int wide = s->x1 - s->x0, high = s->y1 - s->y0;
    if (samples == 1) {
        if (wide > 3 || high > 1) return 1;
        const I8 lane = {0, 1, 2, 3, 4, 5, 6, 7};
        return contains_some(s, to_float(lane & 3) + ((float)s->x0 + 0.5f),
                             to_float(lane >> 2) + ((float)s->y0 + 0.5f));
    }
    if (wide + high > 1) return 1;
    for (int y = s->y0; y <= s->y1; y++)
        for (int x = s->x0; x <= s->x1; x++) {
            const int lane = x % LANES;
            if (contains_some(s, (float)lane + ((float)(x - lane) + 0.5f + dx), (float)y + 0.5f + dy)) return 1;
        }
    return 0;
}

void morse_draw_project(Frame *f) {
    double screen[MOST_VERTICES][5], a[3][4];
    F8 dx, dy;
    EACH_LANE(j) {
        const float *by = f->samples + (j < f->sample_count ? 2 * j : 0);
        dx[j] = by[0], dy[j] = by[1];
    }
    for (int64_t j; (j = take(f)) < f->job_count;) {
        const Camera *k = f->cameras + f->jobs[j][0];
        // samples other than the centres of pixels are for colours only
        const int samples = k->color ? f->sample_count : 1;
        const double reach = samples > 1 ? 0.9 : 0.5;
        const Part *part = f->parts + f->jobs[j][1];
        const Cluster *cluster = f->clusters + part->cluster;
        projection(k, f->models[part->instance], a);
        f->counts[j] = 0;
        if (!is_finite(a, f->spheres[part->cluster])) continue;
        EACH(v, cluster->vertices) {
            const float *p = f->vertices[cluster->vertex + v].p;
            double *to = screen[v];
            EACH(i, 3) to[i] = a[i][0] * p[0] + a[i][1] * p[1] + a[i][2] * p[2] + a[i][3];
            // triangles in the plane of the camera are bounded by the image, not by their corners
            const double w = to[2] < k->near ? 1 : to[2];
            to[3] = to[0] / w, to[4] = to[1] / w;
        }
        Seen *s = f->seen + f->starts[j];
        for (int t = cluster->triangle; t < cluster->triangle + cluster->triangles; t++) {
            const int32_t *c = f->triangles[t];
            const double *q[3] = {screen[c[0]], screen[c[1]], screen[c[2]]};
            if (q[0][2] > k->far && q[1][2] > k->far && q[2][2] > k->far) continue;
            s->material = f->slots[part->slots + c[3]];
            if (!bounds(q, k, reach, s) || !planes(f, part, q, s) || !reaches_samples(s, dx, dy, samples)) continue;
            s->triangle = t, s->part = f->jobs[j][1], s++;
        }
        f->counts[j] = s - (f->seen + f->starts[j]);
    }
}
