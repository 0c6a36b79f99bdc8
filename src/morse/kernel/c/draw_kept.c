// Takes over the tiles of the last image of a camera that did not change.
//
// A tile depends on the triangles that may be visible in it, and on the texels of the shadow maps that are read for it.
// It is drawn again if it may show a part that has moved, before or now, or if one of these texels has changed. All
// else that an image depends on is the same: see `NativeKept` in morse/kernel/drawing/native.py.
#include "draw_kept.h"

#include <math.h>
#include <stdint.h>

#include "draw_bounds.h"
#include "draw_corners.h"

// Distance of samples from the bounds of triangles, and all rounding errors, pixels.
#define PIXEL_MARGIN 3.0
// Bound of the rounding errors of spheres, relative to their radius.
#define SPHERE_ROUNDING 1e-3
// Margin of texels that are converted to those of another map: texels, and relative to the origins of the maps.
#define READ_MARGIN 2.0
#define READ_ROUNDING 1e-5

// The tile of a coordinate: 0 to `count`.
static inline int32_t tile_of(double pixel, int32_t count) {
    const double tile = floor(pixel / TILE);
    return tile > 0 ? (tile < count ? (int32_t)tile : count) : 0;
}

// The coordinates that a sphere may have in an image: those of a box around it. `far` and `near` are the depths of its
// ends.
static inline void extent(const Camera *k, double middle, double size, double near, double far, double focal,
                          double centre, double *low, double *high) {
    const double a = middle - size, b = middle + size;
    if (k->parallel) near = far = 1;
    *low = focal * (a / (a < 0 ? near : far)) + centre - PIXEL_MARGIN;
    *high = focal * (b / (b < 0 ? far : near)) + centre + PIXEL_MARGIN;
}

Region draw_tiles_around(const Camera *k, const float *model, const float *sphere) {
    const int32_t across = tiles_across(k), down = (k->height + TILE - 1) / TILE;
    const Region all = {0, 0, across, down}, none = {0, 0, 0, 0};
    const double size = (double)sphere[3] * (double)scale_of(model) * (1 + SPHERE_ROUNDING);
    const float *r = k->axes;
    double x[3], q[3], x0, y0, x1, y1;
    // instances without a place are not visible
    if (size == 0) return none;
    EACH(i, 3)
    x[i] = (double)model[4 * i] * sphere[0] + (double)model[4 * i + 1] * sphere[1] +
           (double)model[4 * i + 2] * sphere[2] + (double)model[4 * i + 3] - (double)k->eye[i];
    EACH(i, 3) q[i] = (double)r[3 * i] * x[0] + (double)r[3 * i + 1] * x[1] + (double)r[3 * i + 2] * x[2];
    const double near = q[2] - size, far = q[2] + size;
    if (far < (double)k->near * 0.99 || near > (double)k->far * 1.01) return none;
    // triangles are clipped there
    const double cut = cut_of(k) * 0.99, first = near < cut ? cut : near;
    extent(k, q[0], size, first, far, k->fx, k->cx, &x0, &x1);
    extent(k, q[1], size, first, far, k->fy, k->cy, &y0, &y1);
    if (!(x1 > 0 && y1 > 0 && x0 < k->width && y0 < k->height)) return x1 - x1 == 0 && y1 - y1 == 0 ? none : all;
    return (Region){tile_of(x0, across), tile_of(y0, down), tile_of(x1 + TILE, across), tile_of(y1 + TILE, down)};
}

static void mark_sphere(const Frame *f, const Camera *k, const float *model, const float *sphere) {
    const Region r = draw_tiles_around(k, model, sphere);
    for (int32_t y = r.y0; y < r.y1 && r.x0 < r.x1; y++)
        memset(f->drawn + k->tile + y * tiles_across(k) + r.x0, 1, (size_t)(r.x1 - r.x0));
}

// Marks the tiles of parts that have another pose than in the last image.
static void mark_moved(const Frame *f, const Camera *k, const Kept *kept) {
    int32_t instance = -1;
    int moved = 0;
    EACH(p, f->part_count) {
        const Part *part = f->parts + p;
        if (part->instance != instance) {
            instance = part->instance;
            moved = memcmp(f->models[instance], kept->models[instance], sizeof *f->models) ||
                    memcmp(f->turns[instance], kept->turns[instance], sizeof *f->turns);
        }
        if (!moved) continue;
        mark_sphere(f, k, kept->models[instance], f->spheres[part->cluster]);
        mark_sphere(f, k, f->models[instance], f->spheres[part->cluster]);
    }
}

// Whether a texel in a rectangle may have changed since a change of a map; `changes` are the last changes of its
// blocks.
static int has_changed(const int64_t *changes, int32_t width, const int32_t *r, int64_t since) {
    if (r[0] >= r[2]) return 0;
    for (int32_t y = r[1] >> CHANGE_SHIFT; y <= (r[3] - 1) >> CHANGE_SHIFT; y++)
        for (int32_t x = r[0] >> CHANGE_SHIFT; x <= (r[2] - 1) >> CHANGE_SHIFT; x++)
            if (changes[(int64_t)y * change_blocks(width) + x] > since) return 1;
    return 0;
}

// Marks the tiles for which texels of a map are read that have changed.
static void mark_shadows(const Frame *f, const Camera *k, const Kept *kept, int map, const int64_t *changes,
                         int32_t width, int32_t height) {
    // the last number is the last change of all
    if (!changes || changes[(int64_t)change_blocks(width) * change_blocks(height)] <= kept->change) return;
    uint8_t *drawn = f->drawn + k->tile;
    EACH(t, tiles_of(k)) drawn[t] |= (uint8_t)has_changed(changes, width, kept->reads[t][map], kept->change);
}

// The same for the map of a spot lamp, which is made anew instead of changed.
static void mark_lamp(const Frame *f, const Camera *k, const Kept *kept) {
    const float *now = f->lamp_shadow, *before = kept->lamp_shadow;
    if (now == before) return;
    EACH(t, tiles_of(k)) {
        const int32_t *r = kept->reads[t][LAMP_MAP];
        int other = 0;
        for (int64_t y = r[1]; y < r[3] && r[0] < r[2] && !other; y++) {
            const int64_t at = y * f->lamp_width + r[0];
            other = memcmp(now + at, before + at, sizeof *now * (size_t)(r[2] - r[0])) != 0;
        }
        f->drawn[k->tile + t] |= (uint8_t)other;
    }
}

// Where column (axis 0) or row (axis 1) 0 of a map is, in texels from the position of its light, along its axes.
static inline double origin_of(const ClassicLight *l, int axis) {
    return (double)l->frame[l->directional ? 4 * axis + 3 : 13 + axis];
}

int draw_is_lit(const ClassicLight *before, const ClassicLight *now, const int32_t *r) {
    const int32_t size[2] = {now->width, now->height};
    // the smallest maps have no bounds
    if (!now->bounds) return 0;
    const double scale = (double)before->frame[12] / (double)now->frame[12];
    int32_t low[2], high[2];
    EACH(i, 2) {
        const double from = origin_of(before, i), to = origin_of(now, i);
        const double margin = READ_MARGIN * (1 + scale) + READ_ROUNDING * (fabs(from) * scale + fabs(to));
        const double first = (r[i] - from) * scale + to - margin, last = (r[i + 2] - from) * scale + to + margin;
        // false for NaN
        low[i] = first > 0 ? (first < size[i] ? (int32_t)first : size[i]) : 0;
        high[i] = last < size[i] ? (last > 0 ? (int32_t)ceil(last) : 0) : size[i];
    }
    for (int32_t y = low[1] / SIDE; y * SIDE < high[1]; y++)
        for (int32_t x = low[0] / SIDE; x * SIDE < high[0]; x++)
            if (!is_lit_block(now->bounds + y * blocks_across(now->width) + x)) return 0;
    return 1;
}

// Marks the tiles in which a shadow of a light may have changed. Its map is made anew whenever something moves, with
// other texels: only tiles without a shadow, before and now, are the same.
static void mark_classic(const Frame *f, const Camera *k, const Kept *kept) {
    EACH(j, f->classic->light_count) {
        const ClassicLight *now = f->classic_lights + j, *before = kept->lights + j;
        if (!now->width || now->version == before->version) continue;
        EACH(t, tiles_of(k)) {
            const int32_t *r = kept->reads[t][now->number - 1];
            if (f->drawn[k->tile + t] || r[0] >= r[2]) continue;
            f->drawn[k->tile + t] = (uint8_t)(r[0] == SHADOWED || !draw_is_lit(before, now, r));
        }
    }
}

int64_t draw_mark(Frame *f, int32_t camera) {
    const Camera *k = f->cameras + camera;
    Kept *kept = kept_of(f, camera);
    uint8_t *drawn = f->drawn + k->tile;
    const int32_t tiles = tiles_of(k);
    memset(drawn, !(kept && kept->is_complete), (size_t)tiles);
    if (kept) {
        if (kept->is_complete) {
            mark_moved(f, k, kept);
            if (k->color && f->classic) {
                mark_classic(f, k, kept);
            } else if (k->color) {
                mark_shadows(f, k, kept, SUN_MAP, f->shadow_changes, f->shadow_width, f->shadow_height);
                mark_shadows(f, k, kept, NEAR_MAP, f->near_changes, f->near_width, f->near_height);
                mark_lamp(f, k, kept);
            }
        }
        memcpy(kept->models, f->models, sizeof *f->models * (size_t)kept->instances);
        memcpy(kept->turns, f->turns, sizeof *f->turns * (size_t)kept->instances);
        kept->change = f->change, kept->is_complete = 0;
    }
    int64_t count = 0;
    EACH(t, tiles) count += drawn[t];
    return count;
}

// Copies a tile of rows of `width` numbers of some bytes.
static inline void copy(const Camera *k, int left, int top, size_t bytes, const void *from, void *to) {
    const int wide = k->width - left < TILE ? k->width - left : TILE,
              end = k->height < top + TILE ? k->height : top + TILE;
    for (int64_t y = top; y < end; y++) {
        const size_t at = (size_t)(y * k->width + left) * bytes;
        memcpy((char *)to + at, (const char *)from + at, (size_t)wide * bytes);
    }
}

void draw_take_over(const Frame *f, int64_t tile) {
    const int32_t *t = f->tiles[tile];
    const Camera *k = f->cameras + t[0];
    const Kept *kept = f->kept[t[0]];
    copy(k, t[1], t[2], sizeof *f->depth, kept->depth, f->depth + k->pixel);
    copy(k, t[1], t[2], sizeof *f->ids, kept->ids, f->ids + k->pixel);
    if (k->color) copy(k, t[1], t[2], sizeof *f->rgba, kept->rgba, f->rgba + k->pixel);
    if (k->normals) copy(k, t[1], t[2], sizeof *f->normals, kept->normals, f->normals + k->pixel);
}

void draw_keep(const Frame *f, int64_t tile) {
    const int32_t *t = f->tiles[tile];
    const Camera *k = f->cameras + t[0];
    const Kept *kept = f->kept[t[0]];
    copy(k, t[1], t[2], sizeof *f->depth, f->depth + k->pixel, kept->depth);
    copy(k, t[1], t[2], sizeof *f->ids, f->ids + k->pixel, kept->ids);
    if (k->color) copy(k, t[1], t[2], sizeof *f->rgba, f->rgba + k->pixel, kept->rgba);
    if (k->normals) copy(k, t[1], t[2], sizeof *f->normals, f->normals + k->pixel, kept->normals);
}
