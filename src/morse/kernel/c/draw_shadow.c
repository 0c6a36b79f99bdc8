// The shadow map: distances to the nearest surface from the sun.
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "draw_bounds.h"
#include "draw_kept.h"
#include "draw_sight.h"
#include "drawing.h"
#include "export.h"
#include "simd.h"

// Number of moved parts above which all of them are drawn again.
#define MANY_MOVED 256

// The parts that may move, and what a shadow map has of them; MOVERS in morse/kernel/drawing/native.py.
enum { STOOD = 1, MOVED = 2 };

typedef struct {
    const int32_t *parts;
    const uint8_t *left_out;  // whether their shadows are not needed
    const float *base;        // the map without them
    float (*models)[12];      // their models in the map
    int32_t (*touched)[4];    // the texels that each of them may fill
    int32_t (*extents)[4];    // the same for parts out of sight, which are not in the map
    uint8_t *again;           // whether each of them is drawn again: STOOD or MOVED
    int32_t (*changed)[4];    // room for two rectangles of each
    uint8_t *stale;  // whether the bounds of each block are computed again; 0 between calls; null without bounds
    ShadowBlock *bounds;
    int64_t *changes;  // Frame.shadow_changes; may be null
    int32_t count, spare;
} Movers;

MORSE_EXPORT void morse_draw_shadow(Frame *f, int32_t (*rectangles)[4]);
MORSE_EXPORT void morse_draw_movers(Frame *f, Movers *m);

static inline float least(float a, float b) { return a < b ? a : b; }
static inline float most(float a, float b) { return a > b ? a : b; }

static inline F4 either(I4 mask, F4 a, F4 b) { return (F4)(((I4)a & mask) | ((I4)b & ~mask)); }

// The edges of a triangle along a row, as base + step * x, and its distance.
typedef struct {
    float base[3], step[3], distance, slope, most;
} Line;

// Fills the texels from one column to before another one.
static inline void fill_line(float *row, int x, int end, int width, const Line *l) {
    for (; x < end && x + LANES <= width; x += LANES) {
        F8 old;
        memcpy(&old, row + x, sizeof old);
        const F8 fx = (F8){0, 1, 2, 3, 4, 5, 6, 7} + ((float)x + 0.5f), d = l->distance + l->slope * fx;
        I8 in = (d > old) & (fx < splat((float)end)) & (d < splat(l->most));
        EACH(i, 3) in &= l->base[i] + l->step[i] * fx >= splat(0);
        NO_MASKED_STORE;
        const F8 now = pick(in, d, old);
        memcpy(row + x, &now, sizeof now);
    }
    for (; x < end; x++) {
        const float fx = (float)x + 0.5f, d = l->distance + l->slope * fx;
        int in = d > row[x] && d < l->most;
        EACH(i, 3) in &= l->base[i] + l->step[i] * fx >= 0;
        row[x] = in ? d : row[x];
    }
}

// Draws a triangle; with `hidden`, only if its area has the other sign, and nothing from the distance `behind` on.
static inline void fill(const Frame *f, const float *q[3], float hidden, float behind) {
    const float *o = q[0], size[2] = {(float)f->shadow_width, (float)f->shadow_height};
    const float bx = q[1][0] - o[0], by = q[1][1] - o[1], cx = q[2][0] - o[0], cy = q[2][1] - o[1];
    const float area = bx * cy - by * cx;
    if (!(area > 0 || area < 0) || area * hidden > 0) return;
    const float left = o[0] + least(0, least(bx, cx)), right = o[0] + most(0, most(bx, cx));
    const float top = o[1] + least(0, least(by, cy)), bottom = o[1] + most(0, most(by, cy));
    if (!(right >= 0.5f && bottom >= 0.5f && left < size[0] && top < size[1])) return;
    const int x0 = (int)ceilf(most(left, 0.5f) - 0.5f), x1 = (int)(least(right, size[0]) - 0.5f);
    const int y0 = (int)ceilf(most(top, 0.5f) - 0.5f), y1 = (int)(least(bottom, size[1]) - 0.5f);
    // most small triangles are between the centres of texels
    if (x0 > x1 || y0 > y1) return;
    const float sign = area > 0 ? 1.0f : -1.0f, bz = q[1][2] - o[2], cz = q[2][2] - o[2];
    const float dx = (bz * cy - cz * by) / area, dy = (cz * bx - bz * cx) / area;
    Line l = {.slope = dx, .most = behind};
    EACH(i, 3) l.step[i] = -sign * (q[(i + 2) % 3][1] - q[(i + 1) % 3][1]);
    for (int y = y0; y <= y1; y++) {
        const float fy = (float)y + 0.5f;
        EACH(i, 3) {
            const float *b = q[(i + 1) % 3], *e = q[(i + 2) % 3];
            l.base[i] = sign * ((e[0] - b[0]) * (fy - b[1]) + (e[1] - b[1]) * b[0]);
        }
        l.distance = o[2] + dy * (fy - o[1]) - dx * o[0];
        fill_line(f->shadow + (int64_t)y * f->shadow_width, x0, x1 + 1, f->shadow_width, &l);
    }
}

// Mesh to texels and distance, in columns.
static inline void into_map(const Frame *f, const float *m, F4 *a) {
    const float *s = f->sun;
    EACH(n, 4)
    EACH(i, 4)
    a[n][i] =
        i == 3 ? 0 : s[4 * i] * m[n] + s[4 * i + 1] * m[4 + n] + s[4 * i + 2] * m[8 + n] + (n == 3 ? s[4 * i + 3] : 0);
}

// The texels between the lowest and the highest coordinates: x0, y0, x1, y1, one past the end.
static inline void texels_between(const Frame *f, F4 low, F4 high, int32_t *rectangle) {
    const float size[2] = {(float)f->shadow_width, (float)f->shadow_height};
    EACH(i, 2) {
        rectangle[i] = (int)most(least(low[i], size[i]), 0);
        rectangle[2 + i] = (int)most(least(high[i] + 1, size[i]), 0);
    }
}

// The texels that a part in a box may fill.
static void surround(const Frame *f, const float *m, const float *box, int32_t *rectangle) {
    F4 a[4];
    into_map(f, m, a);
    F4 low = a[3], high = low;
    EACH(i, 3) {
        const F4 one = a[i] * box[i], other = a[i] * box[i + 3];
        low += either(one < other, one, other), high += either(one < other, other, one);
    }
    texels_between(f, low, high, rectangle);
}

// Draws a part into the shadow map; `rectangle` receives the texels that it may fill: x0, y0, x1, y1, one past the end.
static void cast(const Frame *f, const Part *part, int32_t *rectangle) {
    const Cluster *c = f->clusters + part->cluster;
    const float (*points)[3] = (const float (*)[3])(f->points + c->vertex);
    F4 seen[MOST_VERTICES], a[4], low = {1e9f, 1e9f, 1e9f, 1e9f}, high = -low;
    into_map(f, f->models[part->instance], a);
    EACH(v, f->point_counts[part->cluster]) {
        const float *p = points[v];
        const F4 at = a[0] * p[0] + a[1] * p[1] + a[2] * p[2] + a[3];
        seen[v] = at, low = either(low < at, low, at), high = either(high > at, high, at);
    }
    texels_between(f, low, high, rectangle);
    // the back faces of closed parts are farther from the sun than their front faces
    const float back = part->flags & MIRRORED ? 1.0f : -1.0f;
    // of parts on both sides of the light, the front faces may be behind it
    const float behind = f->sun[13] > 0 ? f->sun[14] : INFINITY;
    const int cut = high[2] > behind;
    for (int t = c->triangle; t < c->triangle + c->triangles; t++) {
        const uint16_t *corner = f->corners[t];
        const float *q[3] = {(const float *)(seen + corner[0]), (const float *)(seen + corner[1]),
                             (const float *)(seen + corner[2])};
        fill(f, q, f->closed[t] && !cut ? back : 0, behind);
    }
}

// Draws the parts of the jobs into the shadow map, in one thread; each rectangle receives the texels that a job may
// fill.
void morse_draw_shadow(Frame *f, int32_t (*rectangles)[4]) {
    EACH(j, f->job_count) cast(f, f->parts + f->jobs[j][1], rectangles[j]);
}

static inline int meets(const int32_t *a, const int32_t *b) {
    return a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
}

// The model of a part that is not in the map.
static const float NOWHERE[12];

static inline int differ(const float *model, const float *other) { return memcmp(model, other, sizeof NOWHERE) != 0; }

// Marks the parts that have moved, and sets their present models: zeros if they are left out. `changed` receives what
// they have filled before. The shadow of a part that stands remains in the map while it is out of sight: other cameras
// may see it.
static int find_moved(const Frame *f, Movers *m) {
    View views[MOST_VIEWS];
    const int count = views_of(f, views);
    int moved = 0;
    EACH(i, m->count) {
        const Part *part = f->parts + m->parts[i];
        const float *now = m->left_out[i] ? NOWHERE : f->models[part->instance];
        if (differ(now, m->models[i]) && is_out_of_sight(views, count, now, f->boxes[part->cluster])) {
            surround(f, now, f->boxes[part->cluster], m->extents[i]);
            now = NOWHERE;
        }
        m->again[i] = differ(now, m->models[i]) ? MOVED : 0;
        if (!m->again[i]) continue;
        memcpy(m->models[i], now, sizeof NOWHERE);
        memcpy(m->changed[moved++], m->touched[i], sizeof *m->changed);
    }
    return moved;
}

static void restore(const Frame *f, const float *base, const int32_t *r) {
    const int64_t width = f->shadow_width;
    for (int64_t y = r[1]; y < r[3] && r[0] < r[2]; y++)
        memcpy(f->shadow + y * width + r[0], base + y * width + r[0], sizeof *base * (size_t)(r[2] - r[0]));
}

// Sets the bounds of the blocks with a texel of some rectangles, each block once.
static void bound_changed(const Frame *f, Movers *m, int count) {
    const int64_t across = blocks_across(f->shadow_width);
    EACH(i, count) {
        const Blocks b = blocks_of(m->changed[i]);
        for (int32_t y = b.y0; y < b.y1; y++)
            if (b.x0 < b.x1) memset(m->stale + y * across + b.x0, 1, (size_t)(b.x1 - b.x0));
    }
    EACH(i, count) {
        const Blocks b = blocks_of(m->changed[i]);
        for (int32_t y = b.y0; y < b.y1; y++)
            for (int32_t x = b.x0; x < b.x1; x++) {
                const int64_t at = y * across + x;
                if (!m->stale[at]) continue;
                m->bounds[at] = bound(f->shadow, f->shadow_width, f->shadow_height, x * SIDE, y * SIDE);
                m->stale[at] = 0;
            }
    }
}

// Counts the changes of some rectangles.
static void count_changes(Frame *f, const Movers *m, int count) {
    const int64_t across = change_blocks(f->shadow_width), all = across * change_blocks(f->shadow_height);
    m->changes[all] = ++f->change;
    EACH(i, count) {
        const int32_t *r = m->changed[i];
        if (r[0] >= r[2]) continue;
        for (int64_t y = r[1] >> CHANGE_SHIFT; y < change_blocks(r[3]); y++)
            for (int64_t x = r[0] >> CHANGE_SHIFT; x < change_blocks(r[2]); x++) m->changes[y * across + x] = f->change;
    }
}

// Updates the shadows of parts that have moved. Others in the same region are drawn again as well.
void morse_draw_movers(Frame *f, Movers *m) {
    const int moved = find_moved(f, m);
    if (!moved) return;
    EACH(n, moved) restore(f, m->base, m->changed[n]);
    EACH(i, m->count) {
        if (!m->again[i] && moved > MANY_MOVED) m->again[i] = STOOD;
        for (int n = 0; n < moved && !m->again[i]; n++)
            if (meets(m->touched[i], m->changed[n])) m->again[i] = STOOD;
    }
    int changed = moved;
    EACH(i, m->count) {
        if (!m->again[i]) continue;
        memset(m->touched[i], 0, sizeof *m->touched);
        if (differ(m->models[i], NOWHERE)) {
            cast(f, f->parts + m->parts[i], m->touched[i]);
            memcpy(m->extents[i], m->touched[i], sizeof *m->extents);
        }
        if (m->again[i] == MOVED) memcpy(m->changed[changed++], m->touched[i], sizeof *m->changed);
    }
    if (m->stale) bound_changed(f, m, changed);
    if (m->changes) count_changes(f, m, changed);
}
