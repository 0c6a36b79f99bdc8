// Finds the visible triangle of each pixel, then shades it, tile by tile.
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "draw_cover.h"
#include "draw_light.h"
#include "draw_looks.h"
#include "draw_surface.h"
#include "draw_texture.h"
#include "drawing.h"
#include "simd.h"

// Number of triangles between a prefetch and its use.
#define AHEAD 6

// Triangles of a material in a pixel are shaded together if the cosine of the angle between their normals is larger,
// and the relative difference of their 1 / depth is smaller.
#define ALIKE 0.95f
#define APART 0.125f

// Light is added up in integers, so that the result does not depend on the order: ONE_LIGHT of them are 1.
#define LIGHT_SHIFT 16
#define ONE_LIGHT (4095.0f * (1 << LIGHT_SHIFT))

// Samples are shaded with others of their kind.
enum { NO_SURFACES, PLAIN_SURFACES, TEXTURED_SURFACES, KINDS };

// Samples that wait.
typedef struct {
    Points groups[MOST_GROUPS];
    int32_t count;
} Queue;

// What a thread needs for a tile.
typedef struct {
    Tile tile;
    Looks one;              // samples of the same triangle
    Queue queues[KINDS];    // samples of different triangles
    I4 total[TILE * TILE];  // red, green and blue of the pixels of rows with different triangles
    uint8_t mixed[COLUMNS * LANES * BLOCK_ROWS];
    int32_t mixed_count;
    Planes planes[MOST_PLANES];
} __attribute__((aligned(64))) Work;

// The samples of a triangle, or of several that are alike, in a pixel.
typedef struct {
    F8 value, across, down;
    float x, y;
    int32_t material, textured, shares;
} Spot;

static inline V3 shown(V3 c) { return (V3){within(c.x, 0, 1), within(c.y, 0, 1), within(c.z, 0, 1)}; }

// The directions of eight samples, for a depth of 1.
static inline V3 ray_of(const Camera *k, F8 x, F8 y) {
    const float *r = k->axes;
    const F8 cx = (x - k->cx) * (1 / k->fx), cy = (y - k->cy) * (1 / k->fy);
    return (V3){r[0] * cx + r[3] * cy + r[6], r[1] * cx + r[4] * cy + r[7], r[2] * cx + r[5] * cy + r[8]};
}

// The light of the sky in eight samples, 0 to 1.
static __attribute__((noinline)) V3 shade_sky(const Frame *f, const Camera *k, F8 x, F8 y) {
    return shown(tone(scaled(sky_in(f->sky, unit(ray_of(k, x, y))), splat(k->exposure))));
}

// The light of surfaces in eight samples, 0 to 1.
static __attribute__((noinline)) V3 shade(const Frame *f, const Camera *k, Looks *l) {
    const float *sky = f->sky;
    const V3 ray = ray_of(k, l->x, l->y);
    add_textures(f, l);
    const V3 base = {l->r, l->g, l->b};
    if (!any(~l->plain)) return shown(base);
    const F8 depth = 1 / l->inverse;
    const V3 place = sum(everywhere(k->eye), scaled(ray, depth)), n = unit((V3){l->nx, l->ny, l->nz});
    V3 c = lit(f, place, n, scaled(unit(ray), splat(-1)), base, l->metallic, l->roughness);
    c = sum(c, (V3){l->er, l->eg, l->eb});
    if (sky[16] > 0) {
        const F8 t = within((depth - sky[15]) * (1 / sky[16]), 0, 1);
        c = mixed(c, everywhere(sky), t * t * (3 - 2 * t));
    }
    return shown(chosen(l->plain, base, tone(scaled(c, splat(k->exposure)))));
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
static inline void add_light(Work *w, const Points *p, V3 c, int count) {
    const I8 r = to_int(c.x * p->share), g = to_int(c.y * p->share), b = to_int(c.z * p->share);
    EACH(j, count) w->total[p->pixel[j]] += (I4){r[j], g[j], b[j], 0};
}

// Shades the samples of a queue, and adds them to their pixels.
static void finish(const Frame *f, const Camera *k, Work *w, int kind) {
    Queue *q = w->queues + kind;
    const int count = q->count;
    for (int j = count; j % LANES; j++) repeat_point(q->groups + j / LANES, j % LANES);
    for (int i = 0; i < count; i += LANES) {
        const Points *p = q->groups + i / LANES;
        V3 c;
        if (kind == NO_SURFACES) {
            c = shade_sky(f, k, p->x, p->y);
        } else {
            Looks l;
            look_at_points(f, &l, p, kind == TEXTURED_SURFACES);
            c = shade(f, k, &l);
        }
        add_light(w, p, c, count - i < LANES ? count - i : LANES);
    }
    q->count = 0;
}

// Whether two samples of a material are nearly on one plane.
static inline int on_a_plane(const float *a, const float *b) {
    const float cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const float most = (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) * (b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
    return cosine > 0 && cosine * cosine > ALIKE * ALIKE * most && fabsf(a[INVERSE] - b[INVERSE]) < APART * a[INVERSE];
}

// Whether a coordinate of a texture continues from one triangle to another: it changes by less than in a pixel.
static inline int continues(const Spot *one, const float *a, const float *b, int which) {
    const float at = a[which] / a[WHOLE];
    const float right = one->across[which] - at * one->across[WHOLE], down = one->down[which] - at * one->down[WHOLE];
    return fabsf(b[which] / b[WHOLE] - at) * fabsf(a[WHOLE]) <= fabsf(right) + fabsf(down);
}

// Whether a sample can be shaded with another one.
static inline int alike(const Spot *one, const Spot *other) {
    if (one->material != other->material || one->material < 0) return 0;
    const float *a = (const float *)&one->value, *b = (const float *)&other->value;
    if (!on_a_plane(a, b)) return 0;
    return !one->textured || (continues(one, a, b, TEXTURE_U) && continues(one, a, b, TEXTURE_V));
}

// A sample of a triangle.
static inline void set_spot(const Frame *f, Work *w, int32_t who, float x, float y, Spot *s) {
    s->x = x, s->y = y, s->shares = 0;
    if (who < 0) {
        s->material = -1, s->textured = 0;
        return;
    }
    const Planes *plane = planes_of(f, w->planes, who);
    s->value = at_point(plane, x, y), s->material = plane->material;
    s->textured = f->materials[s->material].texture >= 0;
    if (s->textured) s->across = plane->across, s->down = plane->down;
}

// Adds a sample to its queue.
static inline void add_spot(const Frame *f, const Camera *k, Work *w, const Spot *s, int pixel, float share) {
    const int kind = s->material < 0 ? NO_SURFACES : s->textured ? TEXTURED_SURFACES : PLAIN_SURFACES;
    Queue *q = w->queues + kind;
    if (q->count == MOST_GROUPS * LANES) finish(f, k, w, kind);
    Points *p = q->groups + q->count / LANES;
    const int j = q->count++ % LANES;
    p->x[j] = s->x, p->y[j] = s->y, p->pixel[j] = pixel, p->share[j] = share * ONE_LIGHT;
    if (kind == NO_SURFACES) return;
    p->value[j] = s->value, p->material[j] = s->material;
    if (kind == TEXTURED_SURFACES) p->across[j] = s->across, p->down[j] = s->down;
}

// Collects the samples of a pixel that shows different triangles.
static void collect_pixel(const Frame *f, const Camera *k, Work *w, int pixel, float x, float y, const int32_t *who) {
    Spot spots[MOST_SAMPLES];
    int32_t firsts[MOST_SAMPLES];  // the sample with which each one is shaded
    const int samples = f->sample_count;
    EACH(n, samples) {
        int at = 0;
        while (at < n && who[at] != who[n]) at++;
        if (at < n) {
            at = firsts[at];
        } else {
            const float *by = f->samples + 2 * n;
            set_spot(f, w, who[n], x + by[0], y + by[1], spots + n);
            at = 0;
            while (at < n && !(firsts[at] == at && alike(spots + at, spots + n))) at++;
        }
        firsts[n] = at, spots[at].shares++;
    }
    EACH(n, samples)
    if (firsts[n] == n) add_spot(f, k, w, spots + n, pixel, (float)spots[n].shares / (float)samples);
}

// Eight pixels of different triangles.
static void collect(const Frame *f, const Camera *k, Work *w, int block, int r, int x, int y, int count) {
    const Tile *t = &w->tile;
    const int row = block * BLOCK_ROWS + r, samples = t->samples;
    w->mixed[w->mixed_count++] = (uint8_t)row;
    I8 other = splat_int(0);
    for (int n = 1; n < samples; n++) other |= t->shown[block][n][r] ^ t->shown[block][0][r];
    EACH(j, count) {
        const int pixel = row * LANES + j;
        const float px = (float)(x + j) + 0.5f, py = (float)y + 0.5f;
        w->total[pixel] = (I4){0, 0, 0, 0};
        if (other[j]) {
            int32_t who[MOST_SAMPLES];
            EACH(n, samples) who[n] = t->shown[block][n][r][j];
            collect_pixel(f, k, w, pixel, px, py, who);
        } else {
            Spot s;
            set_spot(f, w, t->shown[block][0][r][j], px + f->samples[0], py + f->samples[1], &s);
            add_spot(f, k, w, &s, pixel, 1);
        }
    }
}

// Eight pixels in a row of the only triangle that they show.
static inline void draw_same(const Frame *f, const Camera *k, Work *w, int32_t who, int x, int y, int count,
                             uint8_t (*to)[4]) {
    Looks *l = &w->one;
    l->x = STEPS + ((float)x + 0.5f + f->samples[0]), l->y = splat((float)y + 0.5f + f->samples[1]);
    if (who < 0) {
        write_colours(f, shade_sky(f, k, l->x, l->y), count, to);
    } else {
        look_at_triangle(f, w->planes, l, who);
        write_colours(f, shade(f, k, l), count, to);
    }
}

// The unit normals of eight pixels along the axes of the camera; 0 without a surface.
static void write_normals(const Frame *f, const Camera *k, Planes *cache, I8 shown, int x, int y, int count,
                          float (*to)[3]) {
    const float *r = k->axes, fy = (float)y + 0.5f;
    EACH(j, count) {
        float n[3] = {0, 0, 0};
        if (shown[j] >= 0) {
            const F8 at = at_point(planes_of(f, cache, shown[j]), (float)(x + j) + 0.5f, fy);
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
    if (k->normals) write_normals(f, k, w->planes, shown, x, y, count, f->normals + pixel);
    if (!k->color) return;
    if (same)
        draw_same(f, k, w, shown[0], x, y, count, f->rgba + pixel);
    else
        collect(f, k, w, block, r, x, y, count);
}

// Eight pixels of different triangles, from their light.
static void write_mixed(const Frame *f, const Camera *k, const Work *w, int row) {
    const int block = row / BLOCK_ROWS, x = w->tile.left + block / LANES * LANES;
    const int y = w->tile.top + block % LANES * BLOCK_ROWS + row % BLOCK_ROWS;
    const int count = k->width - x < LANES ? k->width - x : LANES;
    uint8_t (*to)[4] = f->rgba + (k->pixel + (int64_t)y * k->width + x);
    EACH(j, count) {
        const I4 c = (w->total[row * LANES + j] + (1 << (LIGHT_SHIFT - 1))) >> LIGHT_SHIFT;
        write_pixel(f, c[0], c[1], c[2], to[j]);
    }
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
    w->mixed_count = 0;
    EACH(i, KINDS) w->queues[i].count = 0;
    for (int c = 0; c < COLUMNS && left + c * LANES < k->width; c++)
        for (int y = 0; y < TILE && top + y < k->height; y++) draw_row(f, k, w, c, y / BLOCK_ROWS, y % BLOCK_ROWS);
    EACH(i, KINDS) finish(f, k, w, i);
    EACH(i, w->mixed_count) write_mixed(f, k, w, w->mixed[i]);
}

// All pixels of all tiles, shared by the threads.
void draw_pixels(Frame *f) {
    Work w;
    // lanes without a texture are computed, too
    memset(&w.one, 0, sizeof w.one);
    EACH(i, MOST_PLANES) w.planes[i].who = -1;
    int64_t *next = &f->stages[PIXELS].next;
    for (int64_t t; (t = __atomic_fetch_add(next, 1, __ATOMIC_RELAXED)) < f->tile_count;)
        draw_tile(f, f->cameras + f->tiles[t][0], t, &w);
}
