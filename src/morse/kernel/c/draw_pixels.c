// Finds the visible triangle of each pixel, then shades it, tile by tile.
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "draw_cover.h"
#include "draw_kept.h"
#include "draw_light.h"
#include "draw_looks.h"
#include "draw_mixed.h"
#include "draw_reads.h"
#include "draw_shown.h"
#include "draw_surface.h"
#include "draw_texture.h"
#include "drawing.h"
#include "simd.h"

// Number of triangles between a prefetch and its use.
#define AHEAD 6

// Eight pixels of a row that show only one triangle; x and y are those in the image.
typedef struct {
    int32_t who, place;
    int16_t x, y;
} Row;

// What a thread needs for a tile.
typedef struct {
    Tile tile;
    Shown shown;
    Samples samples;
    Looks looks;
    I4 total[TILE * TILE];  // red, green and blue of the pixels of rows with different triangles
    Row rows[TILE * COLUMNS], mixed[TILE * COLUMNS];
    int32_t row_count, mixed_count;
} __attribute__((aligned(64))) Work;

static inline V3 visible(V3 c) { return (V3){within(c.x, 0, 1), within(c.y, 0, 1), within(c.z, 0, 1)}; }

// The directions of eight samples, for a depth of 1.
static inline V3 ray_of(const Camera *k, F8 x, F8 y) {
    const float *r = k->axes;
    const F8 cx = (x - k->cx) * (1 / k->fx), cy = (y - k->cy) * (1 / k->fy);
    return (V3){r[0] * cx + r[3] * cy + r[6], r[1] * cx + r[4] * cy + r[7], r[2] * cx + r[5] * cy + r[8]};
}

// The light of the sky in eight samples, 0 to 1.
static __attribute__((noinline)) V3 shade_sky(const Frame *f, const Camera *k, F8 x, F8 y) {
    return visible(tone(scaled(sky_in(f->sky, unit(ray_of(k, x, y))), splat(k->exposure))));
}

// The light of surfaces in eight samples, 0 to 1.
static __attribute__((noinline)) V3 shade(const Frame *f, const Camera *k, Looks *l) {
    const float *sky = f->sky;
    const V3 ray = ray_of(k, l->x, l->y);
    add_textures(f, l);
    const V3 base = {l->r, l->g, l->b};
    if (!any(~l->plain)) return visible(base);
    const F8 depth = 1 / l->inverse;
    const V3 place = sum(everywhere(k->eye), scaled(ray, depth)), n = unit((V3){l->nx, l->ny, l->nz});
    V3 c = lit(f, place, n, scaled(unit(ray), splat(-1)), base, l->metallic, l->roughness);
    c = sum(c, (V3){l->er, l->eg, l->eb});
    if (sky[16] > 0) {
        const F8 t = within((depth - sky[15]) * (1 / sky[16]), 0, 1);
        c = mixed(c, everywhere(sky), t * t * (3 - 2 * t));
    }
    return visible(chosen(l->plain, base, tone(scaled(c, splat(k->exposure)))));
}

// A step of the table of sRGB.
static inline I8 step_of(F8 light) { return (to_int(light * ONE_LIGHT) + (1 << (LIGHT_SHIFT - 1))) >> LIGHT_SHIFT; }

static inline void write_pixel(const Frame *f, int32_t r, int32_t g, int32_t b, uint8_t *to) {
    const uint8_t pixel[4] = {f->encoded[r], f->encoded[g], f->encoded[b], 255};
    memcpy(to, pixel, sizeof pixel);
}

// Eight pixels as sRGB, opaque.
static inline void write_colours(const Frame *f, V3 c, int count, uint8_t (*to)[4]) {
    const I8 r = step_of(c.x), g = step_of(c.y), b = step_of(c.z);
    EACH(j, count) write_pixel(f, r[j], g[j], b[j], to[j]);
}

// Adds the light of eight samples to their pixels.
static inline void add_light(I4 *total, const int16_t *pixels, F8 share, V3 c, int count) {
    const I8 r = to_int(c.x * share), g = to_int(c.y * share), b = to_int(c.z * share);
    EACH(j, count) total[pixels[j]] += (I4){r[j], g[j], b[j], 0};
}

// Shades the samples of a kind that wait, and adds them to their pixels.
static void finish(const Frame *f, const Camera *k, Work *w, int kind) {
    Waiting *q = w->samples.waiting + kind;
    const Shown *s = &w->shown;
    Looks *l = &w->looks;
    for (int i = 0; i < q->count; i += LANES) {
        const int count = q->count - i < LANES ? q->count - i : LANES;
        F8 share;
        memcpy(&l->x, q->x + i, sizeof l->x), memcpy(&l->y, q->y + i, sizeof l->y);
        memcpy(&share, q->share + i, sizeof share);
        V3 c;
        if (kind == NO_SURFACES) {
            c = shade_sky(f, k, l->x, l->y);
        } else {
            const Planes *planes[LANES];
            int32_t materials[LANES];
            // lanes that are not used are those of the first sample
            EACH_LANE(j) {
                const int place = q->place[j < count ? i + j : i];
                planes[j] = s->planes + place, materials[j] = s->material[place];
            }
            look_at_samples(f, l, planes, materials, kind == TEXTURED_SURFACES);
            c = shade(f, k, l);
        }
        add_light(w->total, q->pixel + i, share, c, count);
    }
    q->count = 0;
}

// Makes room for the planes of more triangles.
static inline void make_room(const Frame *f, const Camera *k, Work *w, int triangles) {
    if (w->shown.count + triangles <= MOST_SHOWN) return;
    EACH(i, KINDS) finish(f, k, w, i);
    w->shown.count = w->shown.complete = 0;
}

// Lets a sample wait.
static inline void add_spot(const Frame *f, const Camera *k, Work *w, const Spot *spot, int pixel) {
    Samples *s = &w->samples;
    const int kind = spot->place < 0 ? NO_SURFACES : w->shown.kind[spot->place];
    Waiting *q = s->waiting + kind;
    if (q->count == MOST_WAITING) finish(f, k, w, kind);
    const int i = q->count++;
    q->x[i] = s->x[spot->sample][pixel % TILE], q->y[i] = s->y[spot->sample][pixel / TILE];
    q->share[i] = s->shares[spot->shares], q->pixel[i] = (int16_t)pixel, q->place[i] = (int16_t)spot->place;
}

// Joins the samples that have been collected; then they wait to be shaded.
static void join_collected(const Frame *f, const Camera *k, Work *w) {
    Samples *s = &w->samples;
    int16_t places[MOST_COLLECTED];
    make_room(f, k, w, s->count);
    EACH(i, s->count) {
        const int32_t who = s->collected[i].who;
        places[i] = (int16_t)(who < 0 ? -1 : place_of(f, &w->shown, who));
    }
    complete(f, &w->shown);
    for (int i = 0, end; i < s->count; i = end) {
        const int pixel = s->collected[i].pixel;
        for (end = i + 1; end < s->count && s->collected[end].pixel == pixel;) end++;
        Spot spots[MOST_SAMPLES];
        const int count = join(s, &w->shown, s->collected + i, places + i, end - i, spots);
        EACH(n, count) add_spot(f, k, w, spots + n, pixel);
    }
    s->count = 0;
}

// Eight pixels in a row of the only triangle that they show.
static inline void draw_same(const Frame *f, const Camera *k, Work *w, const Row *row) {
    Looks *l = &w->looks;
    const int count = k->width - row->x < LANES ? k->width - row->x : LANES;
    uint8_t (*to)[4] = f->rgba + (k->pixel + (int64_t)row->y * k->width + row->x);
    l->x = STEPS + ((float)row->x + 0.5f + f->samples[0]), l->y = splat((float)row->y + 0.5f + f->samples[1]);
    if (row->who < 0) {
        write_colours(f, shade_sky(f, k, l->x, l->y), count, to);
    } else {
        look_at_triangle(l, w->shown.planes + row->place, f->materials + w->shown.material[row->place]);
        write_colours(f, shade(f, k, l), count, to);
    }
}

// Eight pixels of different triangles, from their light.
static inline void write_mixed(const Frame *f, const Camera *k, const Work *w, const Row *row) {
    const int count = k->width - row->x < LANES ? k->width - row->x : LANES;
    const I4 *total = w->total + (row->y - w->tile.top) * TILE + (row->x - w->tile.left);
    uint8_t (*to)[4] = f->rgba + (k->pixel + (int64_t)row->y * k->width + row->x);
    EACH(j, count) {
        const I4 c = (total[j] + (1 << (LIGHT_SHIFT - 1))) >> LIGHT_SHIFT;
        write_pixel(f, c[0], c[1], c[2], to[j]);
    }
}

// Shades everything that the tile shows.
static void draw_colours(const Frame *f, const Camera *k, Work *w) {
    join_collected(f, k, w);
    make_room(f, k, w, w->row_count);
    EACH(i, w->row_count) {
        Row *row = w->rows + i;
        if (row->who >= 0) row->place = place_of(f, &w->shown, row->who);
    }
    complete(f, &w->shown);
    EACH(i, w->row_count) draw_same(f, k, w, w->rows + i);
    EACH(i, KINDS) finish(f, k, w, i);
    EACH(i, w->mixed_count) write_mixed(f, k, w, w->mixed + i);
}

// The unit normals of eight pixels along the axes of the camera; 0 without a surface.
static void write_normals(const Frame *f, const Camera *k, Work *w, I8 shown, int x, int y, int count, float (*to)[3]) {
    const float *r = k->axes, fy = (float)y + 0.5f;
    make_room(f, k, w, LANES);
    EACH(j, count) {
        float n[3] = {0, 0, 0};
        if (shown[j] >= 0) {
            const int place = place_of(f, &w->shown, shown[j]);
            complete(f, &w->shown);
            const F8 at = at_point(w->shown.planes + place, (float)(x + j) + 0.5f, fy);
            EACH(i, 3) n[i] = at[i];
        }
        const float square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        const float factor = 1 / sqrtf(square > 1e-30f ? square : 1e-30f);
        EACH(i, 3) n[i] *= factor;
        EACH(i, 3) to[j][i] = r[3 * i] * n[0] + r[3 * i + 1] * n[1] + r[3 * i + 2] * n[2];
    }
}

static inline int32_t instance_of(const Frame *f, int32_t who) {
    return who < 0 ? -1 : f->parts[f->seen[who].part].instance;
}

// Depths and ids of eight pixels.
static inline void write_surfaces(const Frame *f, I8 shown, F8 inverse, int same, int count, int64_t pixel) {
    const F8 depth = pick(shown < 0, splat(0), 1 / inverse);
    I8 ids = splat_int(instance_of(f, shown[0]));
    if (!same)
        for (int j = 1; j < LANES; j++) ids[j] = shown[j] == shown[j - 1] ? ids[j - 1] : instance_of(f, shown[j]);
    // of a constant size, the copies are single instructions
    if (count == LANES) {
        memcpy(f->depth + pixel, &depth, sizeof depth), memcpy(f->ids + pixel, &ids, sizeof ids);
        return;
    }
    EACH(j, count) f->depth[pixel + j] = depth[j], f->ids[pixel + j] = ids[j];
}

// A row of a block.
static void draw_row(const Frame *f, const Camera *k, Work *w, int column, int block_row, int r) {
    const Tile *t = &w->tile;
    const int block = column * LANES + block_row, x = t->left + column * LANES;
    const int y = t->top + block_row * BLOCK_ROWS + r, count = k->width - x < LANES ? k->width - x : LANES;
    const int64_t pixel = k->pixel + (int64_t)y * k->width + x;
    const int32_t flat = t->flat[column][block_row];
    I8 shown = splat_int(flat);
    F8 inverse;
    int same = 1;
    if (flat == MANY) {
        inverse = t->inverse[block][0][r], shown = t->shown[block][0][r];
        I8 other = shown ^ splat_int(shown[0]);
        for (int n = 1; n < t->samples; n++) other |= t->shown[block][n][r] ^ shown;
        same = !any(other);
    } else {
        const float *by = f->samples;
        inverse = row_of(surface_of(f, t, flat), STEPS + ((float)x + 0.5f + by[0]), (float)y + 0.5f + by[1]);
    }
    write_surfaces(f, shown, inverse, same, count, pixel);
    if (k->normals) write_normals(f, k, w, shown, x, y, count, f->normals + pixel);
    if (!k->color) return;
    const Row row = {shown[0], 0, (int16_t)x, (int16_t)y};
    if (same) {
        w->rows[w->row_count++] = row;
        return;
    }
    const int first = (y - t->top) * TILE + column * LANES;
    if (w->samples.count > MOST_COLLECTED - MOST_OF_ROW) join_collected(f, k, w);
    w->mixed[w->mixed_count++] = row;
    EACH(j, LANES) w->total[first + j] = (I4){0, 0, 0, 0};
    collect(&w->samples, t, block, r, first, count);
}

static void draw_tile(const Frame *f, const Camera *k, int64_t tile, Work *w) {
    Tile *t = &w->tile;
    const int left = f->tiles[tile][1], top = f->tiles[tile][2], samples = k->color ? f->sample_count : 1;
    clear(f, t, left, top, samples, k->near, k->far);
    for (int64_t m = f->firsts[tile], end = f->firsts[tile + 1]; m < end; m++) {
        const int32_t ahead = f->members[m + AHEAD < end ? m + AHEAD : m];
        __builtin_prefetch(f->seen + ahead), __builtin_prefetch(f->bounds + ahead);
        cover(f, k, f->members[m], t);
    }
    w->row_count = w->mixed_count = w->shown.count = w->shown.complete = 0;
    if (k->color) place_samples(f, &w->samples, left, top, samples);
    for (int c = 0; c < COLUMNS && left + c * LANES < k->width; c++)
        for (int y = 0; y < TILE && top + y < k->height; y++) draw_row(f, k, w, c, y / BLOCK_ROWS, y % BLOCK_ROWS);
    if (k->color) draw_colours(f, k, w);
    const Kept *kept = kept_of(f, f->tiles[tile][0]);
    if (!kept) return;
    draw_keep(f, tile);
    if (k->color) find_reads(f, k, t, kept->reads[tile - k->tile]);
}

// All pixels of all tiles, shared by the threads.
void draw_pixels(Frame *f) {
    Work w;
    // lanes without a texture are computed, too
    memset(&w.looks, 0, sizeof w.looks);
    // and lanes without a sample, and places in a table that is empty
    memset(&w.samples, 0, sizeof w.samples), memset(&w.shown, 0, sizeof w.shown);
    int64_t *next = &f->stages[PIXELS].next;
    for (int64_t t; (t = __atomic_fetch_add(next, 1, __ATOMIC_RELAXED)) < f->tile_count;) {
        if (f->drawn[t])
            draw_tile(f, f->cameras + f->tiles[t][0], t, &w);
        else
            draw_take_over(f, t);
    }
}
