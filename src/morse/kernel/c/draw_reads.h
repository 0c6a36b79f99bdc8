// The texels of the shadow maps that are read for a tile: bounds that include all rounding errors.
#pragma once
#include <math.h>
#include <stdint.h>

#include "draw_blocks.h"
#include "draw_bounds.h"
#include "draw_kept.h"
#include "drawing.h"
#include "simd.h"

// Texels around those of a point: its offset along the normal, and the texels that are read for it.
#define TEXEL_MARGIN 8.0f
// Bound of the rounding errors of coordinates, relative to the sum of their terms.
#define COORDINATE_ROUNDING 4e-6f
// The same for 1 / depth.
#define DEPTH_ROUNDING 1e-3f
// Depth in front of a spot lamp, m, below which all texels may be read.
#define LEAST_DEPTH 0.05f

// The corners of a part of an image between two depths, and bounds of their coordinates.
typedef struct {
    V3 at, most;
} Corners8;

// Bounds of what `depth_at` converts, of the surfaces in a block; 0 if it has none.
static inline int depths_in(const Frame *f, const Tile *t, int column, int row, Extent x, float *low, float *high) {
    const int32_t flat = t->flat[column][row];
    if (flat == -1) return 0;
    if (flat != MANY) {
        const float *w = f->seen[flat].w;
        *low = smallest(w, x), *high = largest(w, x);
        return 1;
    }
    const int block = column * LANES + row;
    F8 least = splat(INFINITY), most = splat(0);
    EACH(n, t->samples) EACH(r, BLOCK_ROWS) {
        const I8 seen = t->shown[block][n][r] >= 0;
        const F8 z = t->inverse[block][n][r];
        least = lesser(pick(seen, z, splat(INFINITY)), least), most = greater(pick(seen, z, splat(0)), most);
    }
    *low = INFINITY, *high = 0;
    EACH_LANE(j) *low = least[j] < *low ? least[j] : *low, *high = most[j] > *high ? most[j] : *high;
    return *high > 0;
}

static inline F8 size_of(F8 a) { return greater(a, -a); }

static inline Corners8 corners_of(const Camera *k, Extent e, float nearest, float farthest) {
    const F8 x = {e.x0, e.x1, e.x0, e.x1, e.x0, e.x1, e.x0, e.x1}, y = {e.y0, e.y0, e.y1, e.y1, e.y0, e.y0, e.y1, e.y1};
    const F8 depth = {nearest, nearest, nearest, nearest, farthest, farthest, farthest, farthest};
    const F8 w = k->parallel ? splat(1) : depth;
    const F8 right = (x - k->cx) * (1 / k->fx) * w, down = (y - k->cy) * (1 / k->fy) * w;
    const float *r = k->axes, *o = k->eye;
    const F8 far = size_of(right) + size_of(down) + depth;
    return (Corners8){
        {r[0] * right + r[3] * down + r[6] * depth + o[0], r[1] * right + r[4] * down + r[7] * depth + o[1],
         r[2] * right + r[5] * down + r[8] * depth + o[2]},
        {far + fabsf(o[0]), far + fabsf(o[1]), far + fabsf(o[2])}};
}

// A coordinate of the corners in a map, and the bound of its rounding error.
static inline F8 coordinate(const float *s, const Corners8 *c, F8 *error) {
    *error = (fabsf(s[0]) * c->most.x + fabsf(s[1]) * c->most.y + fabsf(s[2]) * c->most.z + fabsf(s[3])) *
             COORDINATE_ROUNDING;
    return s[0] * c->at.x + s[1] * c->at.y + s[2] * c->at.z + s[3];
}

static inline float least_of(F8 a) {
    float r = a[0];
    for (int j = 1; j < LANES; j++) r = a[j] < r ? a[j] : r;
    return r;
}

// A texel of a coordinate, between two limits.
static inline int32_t texel_at(float coordinate, int32_t first, int32_t end) {
    // false for NaN
    return coordinate > (float)first ? (coordinate < (float)end ? (int32_t)floorf(coordinate) : end) : first;
}

// Includes the texels between coordinates in a rectangle, which are between two of `limits`.
static inline void include(int32_t *r, F8 low, F8 high, F8 low_y, F8 high_y, const Region *limits) {
    const int32_t x0 = texel_at(least_of(low) - TEXEL_MARGIN, limits->x0, limits->x1);
    const int32_t y0 = texel_at(least_of(low_y) - TEXEL_MARGIN, limits->y0, limits->y1);
    const int32_t x1 = texel_at(-least_of(-high) + TEXEL_MARGIN + 1, limits->x0, limits->x1);
    const int32_t y1 = texel_at(-least_of(-high_y) + TEXEL_MARGIN + 1, limits->y0, limits->y1);
    if (x0 >= x1 || y0 >= y1) return;
    r[0] = x0 < r[0] ? x0 : r[0], r[1] = y0 < r[1] ? y0 : r[1];
    r[2] = x1 > r[2] ? x1 : r[2], r[3] = y1 > r[3] ? y1 : r[3];
}

// The texels of a map of the sun.
static inline void include_sun(int32_t *r, const float *s, const Corners8 *c, Region limits) {
    F8 du, dv;
    const F8 u = coordinate(s, c, &du), v = coordinate(s + 4, c, &dv);
    include(r, u - du, u + du, v - dv, v + dv, &limits);
}

// The texels of the map of a spot lamp.
static inline void include_lamp(int32_t *r, const float *s, const Corners8 *c, Region limits) {
    F8 du, dv, dw;
    const F8 u = coordinate(s, c, &du), v = coordinate(s + 4, c, &dv), w = coordinate(s + 8, c, &dw);
    // the lamp does not shine backwards
    if (least_of(-w - dw) > 0) return;
    if (!(least_of(w - dw - dw) > LEAST_DEPTH)) {
        r[0] = limits.x0, r[1] = limits.y0, r[2] = limits.x1, r[3] = limits.y1;
        return;
    }
    const F8 scale = 1 / (w - dw), x = u / w, y = v / w;
    const F8 dx = (du + size_of(x) * dw) * scale, dy = (dv + size_of(y) * dw) * scale;
    include(r, x - dx, x + dx, y - dy, y + dy, &limits);
}

// The same of the lights of the classic look. What is beside their maps is lit, and may be in the next ones.
static inline void include_classic(const Frame *f, const Corners8 *c, int32_t (*reads)[4]) {
    const Region limits = {-FARTHEST_READ, -FARTHEST_READ, FARTHEST_READ, FARTHEST_READ};
    EACH(j, f->classic->light_count) {
        const ClassicLight *l = f->classic_lights + j;
        if (!l->width) continue;
        if (l->directional)
            include_sun(reads[l->number - 1], l->frame, c, limits);
        else
            include_lamp(reads[l->number - 1], l->frame, c, limits);
    }
}

// The depth of a bound that is moved outward by rounding errors: towards the camera if `side` is 1, away from it if -1.
static inline float depth_within(const Camera *k, float inverse, float side) {
    const float reach = reach_of(k), error = side * DEPTH_ROUNDING;
    const float depth = k->parallel ? reach - inverse - error * reach : 1 / (inverse * (1 + error));
    // all visible surfaces are between the near and the far plane; false for NaN
    return side > 0 ? (depth > k->near ? depth : k->near) : (depth < k->far && depth > 0 ? depth : k->far);
}

// Sets the texels of each map that are read for a tile: x0, y0, x1, y1, one past the end.
static void find_reads(const Frame *f, const Camera *k, const Tile *t, int32_t (*reads)[4]) {
    EACH(i, READS) reads[i][0] = reads[i][1] = INT32_MAX, reads[i][2] = reads[i][3] = 0;
    EACH(column, COLUMNS) EACH(row, TILE / BLOCK_ROWS) {
        const int x = column * LANES, y = row * BLOCK_ROWS;
        const Extent e = extent_of(t, (Box){x, y, x + LANES - 1, y + BLOCK_ROWS - 1});
        float low, high;
        if (t->left + x >= k->width || t->top + y >= k->height || !depths_in(f, t, column, row, e, &low, &high))
            continue;
        const Corners8 c = corners_of(k, e, depth_within(k, high, 1), depth_within(k, low, -1));
        if (f->classic) {
            include_classic(f, &c, reads);
            continue;
        }
        if (f->shadow_width) include_sun(reads[SUN_MAP], f->sun, &c, (Region){0, 0, f->shadow_width, f->shadow_height});
        if (f->near_width) include_sun(reads[NEAR_MAP], f->near_sun, &c, (Region){0, 0, f->near_width, f->near_height});
        if (f->lamp_width)
            include_lamp(reads[LAMP_MAP], f->lamp_frame, &c, (Region){0, 0, f->lamp_width, f->lamp_height});
    }
    if (!f->classic) return;
    EACH(j, f->classic->light_count) {
        const ClassicLight *l = f->classic_lights + j;
        int32_t *r = l->number ? reads[l->number - 1] : NULL;
        if (r && r[0] < r[2] && !draw_is_lit(l, l, r)) r[0] = SHADOWED;
    }
}
