// Finds the visible triangle of each pixel, then shades it, tile by tile.
#include <math.h>
#include <stdint.h>

#include "draw_light.h"
#include "draw_looks.h"
#include "draw_surface.h"
#include "draw_texture.h"
#include "drawing.h"
#include "export.h"
#include "simd.h"

MORSE_EXPORT void morse_draw_pixels(Frame *f);

typedef struct {
    float inverse[MOST_SAMPLES][TILE * TILE];  // 1 / depth
    int32_t shown[MOST_SAMPLES][TILE * TILE];  // index of the triangle, -1 for none
} __attribute__((aligned(32))) Tile;

static const F8 STEPS = {0, 1, 2, 3, 4, 5, 6, 7};
static const uint8_t BAYER[4][4] = {{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}};

static int texel_of(float coordinate, int32_t size) {
    const float at = floorf(coordinate * (float)size);
    // false for NaN
    return at > -FARTHEST_TEXEL && at < FARTHEST_TEXEL ? (int)at & (size - 1) : 0;
}

// Whether a pixel shows a surface with holes or a translucent surface.
static int opaque(const Frame *f, const Seen *s, float x, float y, int px, int py) {
    const Surface *m = f->materials + s->material;
    if (m->texture >= 0) {
        const Texture *t = f->textures + m->texture;
        const int32_t *c = f->triangles[s->triangle];
        const Vertex *v = f->vertices + f->clusters[f->parts[s->part].cluster].vertex;
        float e[3], uv[2];
        EACH(i, 3) e[i] = s->e[i][0] * x + s->e[i][1] * y + s->e[i][2];
        const float all = e[0] + e[1] + e[2];
        EACH(i, 2) uv[i] = (e[0] * v[c[0]].uv[i] + e[1] * v[c[1]].uv[i] + e[2] * v[c[2]].uv[i]) / all;
        const int32_t at = texel_of(uv[1], t->height) * t->width + texel_of(uv[0], t->width);
        if ((uint32_t)f->texels[t->first[0] + at] >> 30 < 2) return 0;
    }
    return m->color[3] > ((float)BAYER[py & 3][px & 3] + 0.5f) / 16;
}

// Writes a triangle into the samples of a tile where it is the nearest.
static void cover(const Frame *f, int32_t number, int left, int top, int sample, float nearest, Tile *tile) {
    const Seen *s = f->seen + number;
    const float *shift = f->samples + 2 * sample;
    const int x0 = (s->x0 > left ? s->x0 : left) - left;
    const int x1 = (s->x1 < left + TILE - 1 ? s->x1 : left + TILE - 1) - left;
    const int y0 = s->y0 > top ? s->y0 : top, y1 = s->y1 < top + TILE - 1 ? s->y1 : top + TILE - 1;
    const int holes = f->materials[s->material].flags & (MASKED | DITHERED);
    const F8 a0 = splat(s->e[0][0]), a1 = splat(s->e[1][0]), a2 = splat(s->e[2][0]), aw = splat(s->w[0]),
             zero = splat(0);
    for (int y = y0; y <= y1; y++) {
        const float fy = (float)y + 0.5f + shift[1];
        const F8 r0 = splat(s->e[0][1] * fy + s->e[0][2]), r1 = splat(s->e[1][1] * fy + s->e[1][2]);
        const F8 r2 = splat(s->e[2][1] * fy + s->e[2][2]), rw = splat(s->w[1] * fy + s->w[2]);
        for (int x = x0 & ~(LANES - 1); x <= x1; x += LANES) {
            F8 *at = (F8 *)(tile->inverse[sample] + (y - top) * TILE + x);
            I8 *who = (I8 *)(tile->shown[sample] + (y - top) * TILE + x);
            const F8 fx = STEPS + ((float)(left + x) + 0.5f + shift[0]), w = aw * fx + rw;
            I8 in = (a0 * fx + r0 >= zero) & (a1 * fx + r1 >= zero) & (a2 * fx + r2 >= zero);
            in &= (w > *at) & (w < splat(nearest));
            if (!any(in)) continue;
            if (holes) EACH_LANE(j)
            if (in[j] && !opaque(f, s, fx[j], fy, left + x + j + sample, y + 2 * sample)) in[j] = 0;
            *at = pick(in, w, *at), *who = pick_int(in, splat_int(number), *who);
        }
    }
}

// Shades some samples, and adds the colours to the pixels of a row by their shares.
static void add_colours(const Frame *f, const Camera *k, Looks *l, int count, float row[3][TILE]) {
    const float *r = k->axes, *sky = f->sky;
    for (int i = 0; i < count; i += LANES) {
        const I8 none = *(const I8 *)(l->who + i) < 0, plain = *(const I8 *)(l->plain + i);
        const F8 cx = (AT(x) - k->cx) * (1 / k->fx), cy = (AT(y) - k->cy) * (1 / k->fy), share = AT(share);
        const F8 depth = 1 / AT(inverse);
        const V3 ray = {r[0] * cx + r[3] * cy + r[6], r[1] * cx + r[4] * cy + r[7], r[2] * cx + r[5] * cy + r[8]};
        const V3 d = unit(ray);
        add_texture(f, l, i);
        const V3 base = {AT(r), AT(g), AT(b)};
        V3 c = base;
        if (any(~none & ~plain)) {
            const V3 place = sum(everywhere(k->eye), scaled(ray, depth)), n = unit((V3){AT(nx), AT(ny), AT(nz)});
            c = lit(f, place, n, scaled(d, splat(-1)), base, AT(metallic), AT(roughness));
            c = sum(c, (V3){AT(er), AT(eg), AT(eb)});
            if (sky[16] > 0) {
                const F8 t = within((depth - sky[15]) * (1 / sky[16]), 0, 1);
                c = mixed(c, everywhere(sky), t * t * (3 - 2 * t));
            }
        }
        if (any(none)) c = chosen(none, sky_in(sky, d), c);
        c = chosen(plain, base, tone(scaled(c, splat(k->exposure))));
        c = (V3){within(c.x, 0, 1) * share, within(c.y, 0, 1) * share, within(c.z, 0, 1) * share};
        EACH_LANE(j) if (i + j < count) {
            const int32_t at = l->column[i + j];
            row[0][at] += c.x[j], row[1][at] += c.y[j], row[2][at] += c.z[j];
        }
    }
}

// The samples to shade in a row of a tile: samples of a pixel that show the same triangle are merged.
static int gather(const Frame *f, const Tile *tile, int left, int y, int top, int width, Looks *l) {
    const int samples = f->sample_count;
    int count = 0;
    EACH(s, samples) EACH(x, width) {
        const int32_t at = y * TILE + x, who = tile->shown[s][at];
        int same = 1, known = 0;
        EACH(o, s) known |= tile->shown[o][at] == who;
        if (known) continue;
        for (int o = s + 1; o < samples; o++) same += tile->shown[o][at] == who;
        l->x[count] = (float)(left + x) + 0.5f + f->samples[2 * s];
        l->y[count] = (float)(top + y) + 0.5f + f->samples[2 * s + 1];
        l->share[count] = (float)same / (float)samples, l->who[count] = who, l->column[count++] = x;
    }
    for (int i = count; i & (LANES - 1); i++) {
        l->x[i] = l->x[count - 1], l->y[i] = l->y[count - 1], l->share[i] = 0, l->who[i] = l->who[count - 1];
    }
    return count;
}

static void draw_tile(const Frame *f, const Camera *k, int64_t t, Tile *tile, Looks *l) {
    const int left = f->tiles[t][1], top = f->tiles[t][2], samples = k->color ? f->sample_count : 1;
    EACH(s, samples) EACH(i, TILE * TILE) tile->inverse[s][i] = 1 / k->far, tile->shown[s][i] = -1;
    for (int64_t m = f->firsts[t]; m < f->firsts[t + 1]; m++)
        EACH(s, samples) cover(f, f->members[m], left, top, s, 1 / k->near, tile);
    const int width = k->width - left < TILE ? k->width - left : TILE;
    const int height = k->height - top < TILE ? k->height - top : TILE;
    EACH(y, height) {
        const int64_t pixel = k->pixel + (int64_t)(top + y) * k->width + left;
        EACH(x, width) {
            const int32_t who = tile->shown[0][y * TILE + x];
            f->ids[pixel + x] = who < 0 ? -1 : f->parts[f->seen[who].part].instance;
            f->depth[pixel + x] = who < 0 ? 0 : 1 / tile->inverse[0][y * TILE + x];
        }
        if (!k->color) continue;
        float row[3][TILE] = {{0}};
        const int count = gather(f, tile, left, y, top, width, l);
        look_at_surfaces(f, l, (count + LANES - 1) & ~(LANES - 1));
        add_colours(f, k, l, count, row);
        EACH(x, width) EACH(i, 3) f->rgb[3 * (pixel + x) + i] = f->encoded[(int)(row[i][x] * 4095.0f + 0.5f)];
    }
}

// All pixels of all tiles, shared by the threads.
void morse_draw_pixels(Frame *f) {
    Tile tile;
    Looks l;
    for (int64_t t; (t = take(f)) < f->tile_count;) draw_tile(f, f->cameras + f->tiles[t][0], t, &tile, &l);
}
