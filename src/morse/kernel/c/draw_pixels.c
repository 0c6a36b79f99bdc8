// Finds the visible triangle of each pixel, then shades it, tile by tile.
#include <math.h>
#include <stddef.h>
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

// Number of groups of eight samples that are shaded together: the processor waits for the memory of several of them at
// once.
#define MOST_GROUPS 4

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
    Looks looks[MOST_GROUPS];
    I4 total[TILE * TILE];  // red, green and blue of the pixels of rows with different triangles
    Row rows[TILE * COLUMNS], mixed[TILE * COLUMNS];
    int32_t row_count, mixed_count;
} __attribute__((aligned(64))) Work;

static inline V3 visible(V3 c) { return (V3){within(c.x, 0, 1), within(c.y, 0, 1), within(c.z, 0, 1)}; }

// The directions of eight samples, for a depth of 1.
static inline V3 ray_of(const Camera *k, F8 x, F8 y) {
    const V3 forward = everywhere(k->axes + 6);
    return k->parallel ? forward : sum(aside_of(k, x, y), forward);
}

// The light of the sky in groups of eight samples, 0 to 1: step by step, because each step waits for the one before.
static __attribute__((noinline)) void shade_sky(const Frame *f, const Camera *k, Looks *l, int groups, V3 *light) {
    if (f->classic && has_plain_sky(f->classic)) {
        EACH(g, groups) light[g] = plain_sky(f->classic);
        return;
    }
    if (f->classic) {
        EACH(g, groups) light[g] = classic_sky(f, k, l + g, ray_of(k, l[g].x, l[g].y));
        return;
    }
    EACH(g, groups) light[g] = unit(ray_of(k, l[g].x, l[g].y));
    EACH(g, groups) light[g] = sky_in(f->sky, light[g]);
    EACH(g, groups) light[g] = scaled(light[g], splat(k->exposure));
    if (f->sky[AS_IN_1_4] <= 0) EACH(g, groups) light[g] = tone(light[g]);
    EACH(g, groups) light[g] = visible(light[g]);
}

// The textures of eight samples, and where they are.
static inline void look_closer(const Frame *f, const Camera *k, Looks *l) {
    add_textures(f, l);
    l->ray = ray_of(k, l->x, l->y), l->depth = depth_at(k, l->inverse);
    l->place = sum(everywhere(k->eye), scaled(l->ray, l->depth));
    if (k->parallel) l->place = sum(l->place, aside_of(k, l->x, l->y));
    l->normal = unit((V3){l->nx, l->ny, l->nz});
}

// The light of surfaces in eight samples, 0 to 1.
static inline V3 shade(const Frame *f, const Camera *k, const Looks *l) {
    const float *sky = f->sky;
    const V3 base = {l->r, l->g, l->b}, glow = {l->er, l->eg, l->eb};
    if (!any(~l->plain)) return visible(base);
    const int coded = sky[AS_IN_1_4] > 0;
    V3 c = lit(f, l, scaled(unit(l->ray), splat(-1)), coded ? codes(base) : base);
    c = sum(c, coded ? codes(glow) : glow);
    if (sky[16] > 0) {
        const F8 t = within((l->depth - sky[15]) * (1 / sky[16]), 0, 1);
        c = mixed(c, coded ? codes(everywhere(sky)) : everywhere(sky), t * t * (3 - 2 * t));
    }
    c = scaled(c, splat(k->exposure));
    return visible(chosen(l->plain, base, coded ? light_of_codes(visible(c)) : tone(c)));
}

// The light of surfaces in groups of eight samples, step by step.
static __attribute__((noinline)) void shade_groups(const Frame *f, const Camera *k, Looks *l, int groups, V3 *light) {
    EACH(g, groups) look_closer(f, k, l + g);
    if (f->classic) {
        EACH(g, groups) light[g] = visible(classic_light(f, k, l + g));
        return;
    }
    EACH(g, groups) look_at_sun(f, l + g);
    EACH(g, groups) light[g] = shade(f, k, l + g);
}

// A step of the table of sRGB.
static inline I8 step_of(F8 light) { return (to_int(light * ONE_LIGHT) + (1 << (LIGHT_SHIFT - 1))) >> LIGHT_SHIFT; }

// Steps without gamma correction as codes: divided by 4095 and multiplied by 255, rounded.
#define CODE_OF(step) (((step) * 255 + 2048 + (((step) * 255 + 2047) >> 12)) >> 12)

static inline void write_pixel(const Frame *f, int32_t r, int32_t g, int32_t b, uint8_t *to) {
    const uint8_t pixel[4] = {f->encoded[r], f->encoded[g], f->encoded[b], 255};
    memcpy(to, pixel, sizeof pixel);
}

// Eight pixels, opaque: as sRGB, or without gamma correction in the classic look.
static inline void write_colours(const Frame *f, V3 c, int count, uint8_t (*to)[4]) {
    const I8 r = step_of(c.x), g = step_of(c.y), b = step_of(c.z);
    if (f->classic) {
        const I8 pixels = CODE_OF(r) | CODE_OF(g) << 8 | CODE_OF(b) << 16 | ~0xffffff;
        if (count == LANES)
            memcpy(to, &pixels, sizeof pixels);
        else
            memcpy(to, &pixels, 4 * (size_t)count);
        return;
    }
    EACH(j, count) write_pixel(f, r[j], g[j], b[j], to[j]);
}

// Adds the light of eight samples to their pixels.
static inline void add_light(I4 *total, const uint16_t *pixels, F8 share, V3 c, int count) {
    const I8 r = to_int(c.x * share), g = to_int(c.y * share), b = to_int(c.z * share), none = splat_int(0);
    const L4 rg[2] = {(L4)__builtin_shufflevector(r, g, 0, 8, 1, 9, 4, 12, 5, 13),
                      (L4)__builtin_shufflevector(r, g, 2, 10, 3, 11, 6, 14, 7, 15)};
    const L4 bn[2] = {(L4)__builtin_shufflevector(b, none, 0, 8, 1, 9, 4, 12, 5, 13),
                      (L4)__builtin_shufflevector(b, none, 2, 10, 3, 11, 6, 14, 7, 15)};
    // each of them has two samples, four lanes apart
    I8 pairs[4];
    EACH(i, 2) {
        pairs[2 * i] = (I8)__builtin_shufflevector(rg[i], bn[i], 0, 4, 2, 6);
        pairs[2 * i + 1] = (I8)__builtin_shufflevector(rg[i], bn[i], 1, 5, 3, 7);
    }
    EACH(j, count) total[pixels[j]] += ((const I4 *)(pairs + j % 4))[j / 4];
}

// Prepares samples that wait to be shaded; `count` of eight lanes are used.
static inline void look_at_waiting(const Frame *f, const Shown *s, const Waiting *q, int i, int count, int kind,
                                   Looks *l) {
    memcpy(&l->x, q->x + i, sizeof l->x), memcpy(&l->y, q->y + i, sizeof l->y);
    if (kind == NO_SURFACES) return;
    const Planes *planes[LANES];
    int32_t materials[LANES];
    // lanes that are not used are those of the first sample
    EACH_LANE(j) {
        const int place = q->place[j < count ? i + j : i];
        planes[j] = s->planes + place, materials[j] = s->material[place];
    }
    look_at_samples(f, l, planes, materials, kind == TEXTURED_SURFACES);
    if (!f->classic) return;
    const Corners *corners[LANES];
    EACH_LANE(j) corners[j] = s->corners + q->place[j < count ? i + j : i];
    interpolate(f, l, corners);
}

static inline int lanes_left(int count, int i) { return count - i < LANES ? count - i : LANES; }

// Shades the samples of a kind that wait, and adds them to their pixels.
static void finish(const Frame *f, const Camera *k, Work *w, int kind) {
    Waiting *q = w->samples.waiting + kind;
    V3 light[MOST_GROUPS];
    for (int i = 0; i < q->count; i += MOST_GROUPS * LANES) {
        int groups = 0;
        for (int n = i; n < q->count && groups < MOST_GROUPS; n += LANES)
            look_at_waiting(f, &w->shown, q, n, lanes_left(q->count, n), kind, w->looks + groups++);
        if (kind == NO_SURFACES)
            shade_sky(f, k, w->looks, groups, light);
        else
            shade_groups(f, k, w->looks, groups, light);
        EACH(g, groups) {
            const int first = i + g * LANES;
            F8 share;
            memcpy(&share, q->share + first, sizeof share);
            add_light(w->total, q->pixel + first, share, light[g], lanes_left(q->count, first));
        }
    }
    q->count = 0;
}

// Makes room for the planes of more triangles.
static inline void make_room(const Frame *f, const Camera *k, Work *w, int triangles) {
    if (w->shown.count + triangles <= MOST_SHOWN) return;
    EACH(i, KINDS) finish(f, k, w, i);
    w->shown.count = w->shown.complete = 0;
}

// Lets samples wait that are shaded as one.
static inline void add_sample(const Frame *f, const Camera *k, Work *w, const Collected *c, int16_t place,
                              unsigned shares) {
    Samples *s = &w->samples;
    const int kind = place < 0 ? NO_SURFACES : w->shown.kind[place];
    Waiting *q = s->waiting + kind;
    if (q->count == MOST_WAITING) finish(f, k, w, kind);
    const int i = q->count++;
    const unsigned pixel = c->pixel, sample = c->sample;
    q->x[i] = s->x[sample][pixel % TILE], q->y[i] = s->y[sample][pixel / TILE];
    q->share[i] = s->shares[shares], q->pixel[i] = c->pixel, q->place[i] = place;
}

// Joins the samples of a pixel that are alike; then they wait to be shaded.
static inline void join(const Frame *f, const Camera *k, Work *w, Pixel *p, int count) {
    int kept[MOST_SAMPLES], shares[MOST_SAMPLES], n = 0;
    EACH(i, count) {
        int at = 0;
        while (at < n && !alike(&w->samples, &w->shown, p, kept[at], i)) at++;
        if (at == n) kept[n] = i, shares[n++] = 0;
        shares[at] += p->of[i].shares;
    }
    EACH(i, n) add_sample(f, k, w, p->of + kept[i], p->places[kept[i]], (unsigned)shares[i]);
}

static void join_collected(const Frame *f, const Camera *k, Work *w) {
    Samples *s = &w->samples;
    const Collected *c = s->collected;
    int16_t places[MOST_COLLECTED];
    int32_t materials[MOST_COLLECTED];
    make_room(f, k, w, s->count);
    EACH(i, s->count) places[i] = (int16_t)(c[i].who < 0 ? -1 : place_of(f, &w->shown, c[i].who));
    complete(f, k, &w->shown);
    EACH(i, s->count) materials[i] = places[i] < 0 ? -1 : w->shown.material[places[i]];
    for (int i = 0, end; i < s->count; i = end) {
        for (end = i + 1; end < s->count && c[end].pixel == c[i].pixel;) end++;
        if (end == i + 1) {
            add_sample(f, k, w, c + i, places[i], c[i].shares);
            continue;
        }
        Pixel pixel;
        pixel.of = c + i, pixel.places = places + i, pixel.materials = materials + i, pixel.known = 0;
        join(f, k, w, &pixel, end - i);
    }
    s->count = 0;
}

// Eight pixels of a row.
static inline void write_row(const Frame *f, const Camera *k, const Row *row, V3 light) {
    const int count = lanes_left(k->width, row->x);
    write_colours(f, light, count, f->rgba + (k->pixel + (int64_t)row->y * k->width + row->x));
}

static void finish_rows(const Frame *f, const Camera *k, Work *w, const Row *const *rows, int groups, int is_sky) {
    V3 light[MOST_GROUPS];
    if (is_sky)
        shade_sky(f, k, w->looks, groups, light);
    else
        shade_groups(f, k, w->looks, groups, light);
    EACH(g, groups) write_row(f, k, rows[g], light[g]);
}

// Rows that show only one triangle each, or only the sky.
static void draw_same(const Frame *f, const Camera *k, Work *w, int is_sky) {
    const Row *rows[MOST_GROUPS];
    int groups = 0;
    EACH(i, w->row_count) {
        const Row *row = w->rows + i;
        if ((row->who < 0) != is_sky) continue;
        Looks *l = w->looks + groups;
        l->x = STEPS + ((float)row->x + 0.5f + f->samples[0]), l->y = splat((float)row->y + 0.5f + f->samples[1]);
        if (!is_sky) look_at_triangle(f, l, w->shown.planes + row->place, w->shown.material[row->place]);
        if (!is_sky && f->classic) interpolate_one(f, l, w->shown.corners + row->place);
        rows[groups++] = row;
        if (groups < MOST_GROUPS) continue;
        finish_rows(f, k, w, rows, groups, is_sky);
        groups = 0;
    }
    finish_rows(f, k, w, rows, groups, is_sky);
}

// Eight pixels of different triangles, from their light.
static inline void write_mixed(const Frame *f, const Camera *k, const Work *w, const Row *row) {
    const int count = k->width - row->x < LANES ? k->width - row->x : LANES;
    const I4 *total = w->total + (row->y - w->tile.top) * TILE + (row->x - w->tile.left);
    uint8_t (*to)[4] = f->rgba + (k->pixel + (int64_t)row->y * k->width + row->x);
    EACH(j, count) {
        const I4 c = (total[j] + (1 << (LIGHT_SHIFT - 1))) >> LIGHT_SHIFT;
        if (!f->classic) {
            write_pixel(f, c[0], c[1], c[2], to[j]);
            continue;
        }
        const I4 code = CODE_OF(c);
        const int32_t pixel = code[0] | code[1] << 8 | code[2] << 16 | ~0xffffff;
        memcpy(to[j], &pixel, sizeof pixel);
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
    complete(f, k, &w->shown);
    draw_same(f, k, w, 0), draw_same(f, k, w, 1);
    EACH(i, KINDS) finish(f, k, w, i);
    EACH(i, w->mixed_count) write_mixed(f, k, w, w->mixed + i);
}

// The unit normals of eight pixels along the axes of the camera; 0 without a surface.
static void write_normals(const Frame *f, const Camera *k, Work *w, I8 shown, int x, int y, int count, float (*to)[3]) {
    const float *r = k->axes;
    const F8 px = STEPS + ((float)x + 0.5f), py = splat((float)y + 0.5f);
    F8 n[3] = {splat(0), splat(0), splat(0)};
    make_room(f, k, w, LANES);
    // once for each triangle in the row
    for (unsigned left = lanes_of(shown >= 0) & ((1u << count) - 1); left;) {
        const int32_t who = shown[__builtin_ctz(left)];
        const int place = place_of(f, &w->shown, who);
        complete(f, k, &w->shown);
        const I8 mine = shown == who;
        EACH(i, 3) n[i] = pick(mine, at_points(w->shown.planes + place, NORMAL_X + i, px, py), n[i]);
        left &= ~lanes_of(mine);
    }
    const V3 u = unit((V3){n[0], n[1], n[2]});
    F8 turned[3];
    EACH(i, 3) turned[i] = r[3 * i] * u.x + r[3 * i + 1] * u.y + r[3 * i + 2] * u.z;
    EACH(j, count) EACH(i, 3) to[j][i] = turned[i][j];
}

static inline int32_t instance_of(const Frame *f, int32_t who) {
    return who < 0 ? -1 : f->parts[f->seen[who].part].instance;
}

// Depths and ids of eight pixels.
static inline void write_surfaces(const Frame *f, F8 depth, I8 ids, int count, int64_t pixel) {
    // of a constant size, the copies are single instructions
    if (count == LANES) {
        memcpy(f->depth + pixel, &depth, sizeof depth), memcpy(f->ids + pixel, &ids, sizeof ids);
        return;
    }
    EACH(j, count) f->depth[pixel + j] = depth[j], f->ids[pixel + j] = ids[j];
}

// The instances in eight pixels, without conditions that the processor would predict wrongly.
static inline I8 instances_of(const Frame *f, I8 shown) {
    const I8 none = shown < 0;
    const unsigned solid = lanes_of(~none);
    if (!solid) return none;
    const I8 known = pick_int(none, splat_int(shown[__builtin_ctz(solid)]), shown);
    I8 ids;
    EACH_LANE(j) ids[j] = f->parts[f->seen[known[j]].part].instance;
    return ids | none;
}

// Whether the rows of a block show a single triangle each, which may be none.
static inline int shows_one(const Tile *t, int block, int r) {
    const I8 shown = t->shown[block][0][r];
    I8 other = shown ^ splat_int(shown[0]);
    for (int n = 1; n < t->samples; n++) other |= t->shown[block][n][r] ^ shown;
    return !any(other);
}

// The rows of a block that are in the image.
static void draw_block(const Frame *f, const Camera *k, Work *w, int column, int block_row) {
    const Tile *t = &w->tile;
    const int block = column * LANES + block_row, x = t->left + column * LANES, top = t->top + block_row * BLOCK_ROWS;
    const int count = lanes_left(k->width, x), rows = k->height - top < BLOCK_ROWS ? k->height - top : BLOCK_ROWS;
    const int32_t flat = t->flat[column][block_row];
    const float *by = f->samples, *surface = surface_of(f, t, flat);
    I8 shown = splat_int(flat), ids = splat_int(flat < 0 ? -1 : instance_of(f, flat));
    const F8 columns = STEPS + ((float)x + 0.5f + by[0]);
    EACH(r, rows) {
        const int y = top + r;
        const int64_t pixel = k->pixel + (int64_t)y * k->width + x;
        int same = 1;
        F8 inverse;
        if (flat == MANY) {
            inverse = t->inverse[block][0][r], shown = t->shown[block][0][r], same = shows_one(t, block, r);
            ids = same ? splat_int(instance_of(f, shown[0])) : instances_of(f, shown);
        } else {
            inverse = row_of(surface, columns, (float)y + 0.5f + by[1]);
        }
        write_surfaces(f, pick(shown < 0, splat(0), depth_at(k, inverse)), ids, count, pixel);
        if (k->normals) write_normals(f, k, w, shown, x, y, count, f->normals + pixel);
        if (!k->color) continue;
        const Row row = {shown[0], 0, (int16_t)x, (int16_t)y};
        if (same) {
            w->rows[w->row_count++] = row;
            continue;
        }
        const int first = (y - t->top) * TILE + column * LANES;
        if (w->samples.count > MOST_COLLECTED - MOST_OF_ROW) join_collected(f, k, w);
        w->mixed[w->mixed_count++] = row;
        EACH(j, LANES) w->total[first + j] = (I4){0, 0, 0, 0};
        collect(&w->samples, t, block, r, first, count);
    }
}

// Fills a tile without triangles and with a sky of one colour; 0 if it is another one.
static int fill_tile(const Frame *f, const Camera *k, int64_t tile) {
    if (f->firsts[tile] != f->firsts[tile + 1] || k->normals || kept_of(f, f->tiles[tile][0])) return 0;
    if (k->color && !(f->classic && has_plain_sky(f->classic))) return 0;
    const int left = f->tiles[tile][1], top = f->tiles[tile][2];
    const int count = k->width - left < TILE ? k->width - left : TILE;
    for (int y = top; y < top + TILE && y < k->height; y++) {
        const int64_t pixel = k->pixel + (int64_t)y * k->width + left;
        for (int x = 0; x < count; x += LANES) {
            const int wide = lanes_left(count, x);
            write_surfaces(f, splat(0), splat_int(-1), wide, pixel + x);
            if (k->color) write_colours(f, visible(plain_sky(f->classic)), wide, f->rgba + (pixel + x));
        }
    }
    return 1;
}

static void draw_tile(const Frame *f, const Camera *k, int64_t tile, Work *w) {
    if (fill_tile(f, k, tile)) return;
    Tile *t = &w->tile;
    const int left = f->tiles[tile][1], top = f->tiles[tile][2], samples = k->color ? f->sample_count : 1;
    clear(f, k, t, left, top, samples);
    for (int64_t m = f->firsts[tile], end = f->firsts[tile + 1]; m < end; m++) {
        const int32_t ahead = f->members[m + AHEAD < end ? m + AHEAD : m];
        __builtin_prefetch(f->seen + ahead), __builtin_prefetch(f->bounds + ahead);
        cover(f, k, f->members[m], t);
    }
    w->row_count = w->mixed_count = w->shown.count = w->shown.complete = 0;
    if (k->color) place_samples(f, &w->samples, left, top, samples);
    for (int c = 0; c < COLUMNS && left + c * LANES < k->width; c++)
        for (int y = 0; y < TILE && top + y < k->height; y += BLOCK_ROWS) draw_block(f, k, w, c, y / BLOCK_ROWS);
    if (k->color) draw_colours(f, k, w);
    const Kept *kept = kept_of(f, f->tiles[tile][0]);
    if (!kept) return;
    draw_keep(f, tile);
    if (k->color) find_reads(f, k, t, kept->reads[tile - k->tile]);
}

// All pixels of all tiles, shared by the threads.
void draw_pixels(Frame *f, int64_t thread) {
    Work w;
    // lanes without a texture are computed, too
    memset(w.looks, 0, sizeof w.looks);
    // and lanes without a sample, and places in a table that is empty
    memset(&w.samples, 0, sizeof w.samples), memset(&w.shown, 0, offsetof(Shown, corners));
    for (int64_t t; (t = take_piece(f, PIXELS, thread, f->tile_count)) >= 0;) {
        if (f->drawn[t])
            draw_tile(f, f->cameras + f->tiles[t][0], t, &w);
        else
            draw_take_over(f, t);
    }
}
