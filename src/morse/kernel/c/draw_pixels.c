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

// What a thread needs for a tile.
typedef struct {
    Tile tile;
    Looks one;                 // samples of the same triangle
    Points some[MOST_GROUPS];  // samples of different triangles
    int32_t some_count;
    F8 total[3][COLUMNS * LANES * BLOCK_ROWS];  // colours of the pixels of rows with different triangles
    uint8_t mixed[COLUMNS * LANES * BLOCK_ROWS];
    int32_t mixed_count;
    Planes planes[MOST_PLANES];
} __attribute__((aligned(64))) Work;

// The light of eight samples, 0 to 1.
static __attribute__((noinline)) V3 shade(const Frame *f, const Camera *k, Looks *l) {
    const float *r = k->axes, *sky = f->sky;
    const F8 cx = (l->x - k->cx) * (1 / k->fx), cy = (l->y - k->cy) * (1 / k->fy), depth = 1 / l->inverse;
    const V3 ray = {r[0] * cx + r[3] * cy + r[6], r[1] * cx + r[4] * cy + r[7], r[2] * cx + r[5] * cy + r[8]};
    const V3 d = unit(ray);
    add_textures(f, l);
    const V3 base = {l->r, l->g, l->b};
    V3 c = base;
    if (any(~l->none & ~l->plain)) {
        const V3 place = sum(everywhere(k->eye), scaled(ray, depth)), n = unit((V3){l->nx, l->ny, l->nz});
        c = lit(f, place, n, scaled(d, splat(-1)), base, l->metallic, l->roughness);
        c = sum(c, (V3){l->er, l->eg, l->eb});
        if (sky[16] > 0) {
            const F8 t = within((depth - sky[15]) * (1 / sky[16]), 0, 1);
            c = mixed(c, everywhere(sky), t * t * (3 - 2 * t));
        }
    }
    if (any(l->none)) c = chosen(l->none, sky_in(sky, d), c);
    c = chosen(l->plain, base, tone(scaled(c, splat(k->exposure))));
    return (V3){within(c.x, 0, 1), within(c.y, 0, 1), within(c.z, 0, 1)};
}

// Eight pixels as sRGB, opaque.
static inline void write_colours(const Frame *f, V3 c, int count, uint8_t (*to)[4]) {
    const I8 r = to_int(c.x * 4095.0f + 0.5f), g = to_int(c.y * 4095.0f + 0.5f), b = to_int(c.z * 4095.0f + 0.5f);
    EACH(j, count) {
        const uint8_t pixel[4] = {f->encoded[r[j]], f->encoded[g[j]], f->encoded[b[j]], 255};
        memcpy(to[j], pixel, sizeof pixel);
    }
}

// The attributes of a sample.
static inline void set_point(const Frame *f, Work *w, int number, int32_t who, float x, float y) {
    Points *p = w->some + number / LANES;
    const int j = number % LANES;
    p->x[j] = x, p->y[j] = y;
    if (who < 0) {
        p->value[j] = NO_ATTRIBUTES, p->across[j] = p->down[j] = splat(0);
        p->material[j] = -1;
        return;
    }
    const Planes *plane = planes_of(f, w->planes, who);
    p->value[j] = at_point(plane, x, y), p->across[j] = plane->across, p->down[j] = plane->down;
    p->material[j] = plane->material;
}

// Shades the collected samples, and adds them to their pixels.
static void finish(const Frame *f, const Camera *k, Work *w) {
    const int count = w->some_count;
    for (int j = count; j % LANES; j++) set_point(f, w, j, -1, w->some[j / LANES].x[0], w->some[j / LANES].y[0]);
    for (int i = 0; i < count; i += LANES) {
        const Points *p = w->some + i / LANES;
        Looks l;
        look_at_points(f, &l, p);
        const V3 c = shade(f, k, &l);
        EACH(j, count - i < LANES ? count - i : LANES) {
            const int row = p->pixel[j] / LANES, lane = p->pixel[j] % LANES;
            const float share = p->share[j];
            w->total[0][row][lane] += c.x[j] * share, w->total[1][row][lane] += c.y[j] * share;
            w->total[2][row][lane] += c.z[j] * share;
        }
    }
    w->some_count = 0;
}

// Whether two samples of a material are nearly on one plane.
static inline int alike(const float *a, const float *b) {
    const float cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const float most = (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) * (b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
    return cosine > 0 && cosine * cosine > ALIKE * ALIKE * most && fabsf(a[INVERSE] - b[INVERSE]) < APART * a[INVERSE];
}

// The first of the samples from `first` to `end` with which the sample at `end` is shaded; `end` if none is.
static int shaded_with(const Frame *f, const Work *w, int first, int end) {
    const int32_t material = w->some[end / LANES].material[end % LANES];
    if (material < 0 || f->materials[material].texture >= 0) return end;
    const float *mine = (const float *)&w->some[end / LANES].value[end % LANES];
    for (int n = first; n < end; n++) {
        const Points *p = w->some + n / LANES;
        if (p->material[n % LANES] == material && alike((const float *)&p->value[n % LANES], mine)) return n;
    }
    return end;
}

// Collects the samples of a pixel that shows different triangles.
static void collect_pixel(const Frame *f, Work *w, int pixel, float x, float y, const int32_t *who) {
    int32_t kinds[MOST_SAMPLES], shares[MOST_SAMPLES];
    const int first = w->some_count, samples = f->sample_count;
    int end = first;
    EACH(n, samples) {
        int at = first;
        while (at < end && kinds[at - first] != who[n]) at++;
        if (at == end) {
            const float *by = f->samples + 2 * n;
            set_point(f, w, end, who[n], x + by[0], y + by[1]);
            at = shaded_with(f, w, first, end);
        }
        if (at < end)
            shares[at - first]++;
        else
            kinds[end - first] = who[n], shares[end - first] = 1, end++;
    }
    for (int n = first; n < end; n++) {
        Points *p = w->some + n / LANES;
        p->pixel[n % LANES] = pixel, p->share[n % LANES] = (float)shares[n - first] / (float)samples;
    }
    w->some_count = end;
}

// Eight pixels of different triangles.
static void collect(const Frame *f, const Camera *k, Work *w, int block, int r, int x, int y, int count) {
    const Tile *t = &w->tile;
    const int row = block * BLOCK_ROWS + r, samples = t->samples;
    w->mixed[w->mixed_count++] = (uint8_t)row;
    EACH(i, 3) w->total[i][row] = splat(0);
    I8 other = splat_int(0);
    for (int n = 1; n < samples; n++) other |= t->shown[block][n][r] ^ t->shown[block][0][r];
    EACH(j, count) {
        const float px = (float)(x + j) + 0.5f, py = (float)y + 0.5f;
        if (w->some_count + MOST_SAMPLES > MOST_GROUPS * LANES) finish(f, k, w);
        int32_t who[MOST_SAMPLES];
        EACH(n, samples) who[n] = t->shown[block][n][r][j];
        if (other[j]) {
            collect_pixel(f, w, row * LANES + j, px, py, who);
            continue;
        }
        const int at = w->some_count++;
        set_point(f, w, at, who[0], px + f->samples[0], py + f->samples[1]);
        Points *p = w->some + at / LANES;
        p->pixel[at % LANES] = row * LANES + j, p->share[at % LANES] = 1;
    }
}

// Eight pixels in a row of the only triangle that they show.
static inline void draw_same(const Frame *f, const Camera *k, Work *w, int32_t who, int x, int y, int count,
                             uint8_t (*to)[4]) {
    Looks *l = &w->one;
    l->x = STEPS + ((float)x + 0.5f + f->samples[0]), l->y = splat((float)y + 0.5f + f->samples[1]);
    if (who < 0)
        look_at_nothing(l);
    else
        look_at_triangle(f, w->planes, l, who);
    write_colours(f, shade(f, k, l), count, to);
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

static void draw_tile(const Frame *f, const Camera *k, int64_t tile, Work *w) {
    Tile *t = &w->tile;
    const int left = f->tiles[tile][1], top = f->tiles[tile][2], samples = k->color ? f->sample_count : 1;
    clear(f, t, left, top, samples, k->near, k->far);
    for (int64_t m = f->firsts[tile], end = f->firsts[tile + 1]; m < end; m++) {
        const int32_t ahead = f->members[m + AHEAD < end ? m + AHEAD : m];
        __builtin_prefetch(f->seen + ahead), __builtin_prefetch(f->bounds + ahead);
        cover(f, k, f->members[m], t);
    }
    w->mixed_count = w->some_count = 0;
    for (int c = 0; c < COLUMNS && left + c * LANES < k->width; c++)
        for (int y = 0; y < TILE && top + y < k->height; y++) draw_row(f, k, w, c, y / BLOCK_ROWS, y % BLOCK_ROWS);
    finish(f, k, w);
    EACH(i, w->mixed_count) {
        const int row = w->mixed[i], block = row / BLOCK_ROWS;
        const int x = left + block / LANES * LANES, y = top + block % LANES * BLOCK_ROWS + row % BLOCK_ROWS;
        const V3 c = {w->total[0][row], w->total[1][row], w->total[2][row]};
        const int count = k->width - x < LANES ? k->width - x : LANES;
        write_colours(f, c, count, f->rgba + (k->pixel + (int64_t)y * k->width + x));
    }
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
