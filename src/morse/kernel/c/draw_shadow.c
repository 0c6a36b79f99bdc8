// The shadow map: distances to the nearest surface from the sun.
#include <math.h>
#include <stdint.h>

#include "drawing.h"
#include "export.h"

#define MOST_VERTICES (3 * 256)

MORSE_EXPORT void morse_draw_shadow(Frame *f, int32_t (*rectangles)[4]);

static inline float least(float a, float b) { return a < b ? a : b; }
static inline float most(float a, float b) { return a > b ? a : b; }

static void fill(const Frame *f, const float *q[3]) {
    const float *o = q[0], size[2] = {(float)f->shadow_width, (float)f->shadow_height};
    const float bx = q[1][0] - o[0], by = q[1][1] - o[1], bz = q[1][2] - o[2];
    const float cx = q[2][0] - o[0], cy = q[2][1] - o[1], cz = q[2][2] - o[2], area = bx * cy - by * cx;
    const float left = o[0] + least(0, least(bx, cx)), right = o[0] + most(0, most(bx, cx));
    const float top = o[1] + least(0, least(by, cy)), bottom = o[1] + most(0, most(by, cy));
    if (!(area > 0 || area < 0) || !(right >= 0.5f && bottom >= 0.5f && left < size[0] && top < size[1])) return;
    const int x0 = (int)ceilf(most(left, 0.5f) - 0.5f), x1 = (int)(least(right, size[0]) - 0.5f);
    const int y0 = (int)ceilf(most(top, 0.5f) - 0.5f), y1 = (int)(least(bottom, size[1]) - 0.5f);
    // most small triangles are between the centres of texels
    if (x0 > x1 || y0 > y1) return;
    const float sign = area > 0 ? 1.0f : -1.0f, dx = (bz * cy - cz * by) / area, dy = (cz * bx - bz * cx) / area;
    for (int y = y0; y <= y1; y++) {
        float *row = f->shadow + (int64_t)y * f->shadow_width, base[3], step[3];
        const float fy = (float)y + 0.5f;
        EACH(i, 3) {
            const float *b = q[(i + 1) % 3], *e = q[(i + 2) % 3];
            base[i] = sign * ((e[0] - b[0]) * (fy - b[1]) + (e[1] - b[1]) * b[0]);
            step[i] = -sign * (e[1] - b[1]);
        }
        const float z = o[2] + dy * (fy - o[1]) - dx * o[0];
        for (int x = x0; x <= x1; x++) {
            const float fx = (float)x + 0.5f, d = z + dx * fx;
            const int in = (base[0] + step[0] * fx >= 0) & (base[1] + step[1] * fx >= 0) &
                           (base[2] + step[2] * fx >= 0) & (d > row[x]);
            row[x] = in ? d : row[x];
        }
    }
}

// Draws the parts of the jobs into the shadow map, in one thread; each rectangle receives the texels that a job may
// fill: x0, y0, x1, y1, one past the end.
void morse_draw_shadow(Frame *f, int32_t (*rectangles)[4]) {
    const float *s = f->sun, size[2] = {(float)f->shadow_width, (float)f->shadow_height};
    float seen[MOST_VERTICES][3], a[3][4];
    EACH(j, f->job_count) {
        const Part *part = f->parts + f->jobs[j][1];
        const Cluster *c = f->clusters + part->cluster;
        const float *m = f->models[part->instance];
        float low[2] = {1e9f, 1e9f}, high[2] = {-1e9f, -1e9f};
        EACH(i, 3)
        EACH(n, 4)
        a[i][n] = s[4 * i] * m[n] + s[4 * i + 1] * m[4 + n] + s[4 * i + 2] * m[8 + n] + (n == 3 ? s[4 * i + 3] : 0);
        EACH(v, c->vertices) {
            const float *p = f->vertices[c->vertex + v].p;
            EACH(i, 3) seen[v][i] = a[i][0] * p[0] + a[i][1] * p[1] + a[i][2] * p[2] + a[i][3];
            EACH(i, 2) low[i] = least(low[i], seen[v][i]), high[i] = most(high[i], seen[v][i]);
        }
        EACH(i, 2) {
            rectangles[j][i] = (int)most(least(low[i], size[i]), 0);
            rectangles[j][2 + i] = (int)most(least(high[i] + 1, size[i]), 0);
        }
        for (int t = c->triangle; t < c->triangle + c->triangles; t++) {
            const int32_t *corner = f->triangles[t];
            const float *q[3] = {seen[corner[0]], seen[corner[1]], seen[corner[2]]};
            fill(f, q);
        }
    }
}
