// Finds the visible triangle of each pixel, then shades it, tile by tile.
#include <math.h>
#include <stdint.h>

#include "draw_cover.h"
#include "draw_light.h"
#include "draw_looks.h"
#include "draw_surface.h"
#include "draw_texture.h"
#include "drawing.h"
#include "export.h"
#include "simd.h"

// Number of triangles between a prefetch and its use.
#define AHEAD 6

MORSE_EXPORT void morse_draw_pixels(Frame *f);

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
    int32_t mixed_up[TILE];
    int any_mixed_up = 0;
    EACH(x, TILE) {
        int32_t other = 0;
        for (int o = 1; o < samples; o++) other |= tile->shown[0][y * TILE + x] ^ tile->shown[o][y * TILE + x];
        mixed_up[x] = other, any_mixed_up |= other;
    }
    EACH(s, any_mixed_up ? samples : 1) EACH(x, width) {
        const int32_t at = y * TILE + x, who = tile->shown[s][at];
        if (!mixed_up[x]) {
            if (s) continue;
            l->x[count] = (float)(left + x) + 0.5f + f->samples[0],
            l->y[count] = (float)(top + y) + 0.5f + f->samples[1];
            l->share[count] = 1, l->who[count] = who, l->column[count++] = x;
            continue;
        }
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

// The unit normals of the pixels of a row along the axes of the camera; 0 without a surface.
static void write_normals(const Frame *f, const Camera *k, const Tile *tile, int y, int width, Looks *l) {
    const float *r = k->axes, fy = (float)(tile->top + y) + 0.5f;
    float (*to)[3] = f->normals + k->pixel + (int64_t)(tile->top + y) * k->width + tile->left;
    EACH(x, width) {
        const int32_t who = tile->shown[0][y * TILE + x];
        float n[3] = {0, 0, 0};
        if (who >= 0) {
            const Planes *p = planes_of(f, l, who);
            const float fx = (float)(tile->left + x) + 0.5f;
            EACH(i, 3) n[i] = p->normal[i][0] * fx + p->normal[i][1] * fy + p->normal[i][2];
        }
        const float square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        const float factor = 1 / sqrtf(square > 1e-30f ? square : 1e-30f);
        EACH(i, 3) n[i] *= factor;
        EACH(i, 3) to[x][i] = r[3 * i] * n[0] + r[3 * i + 1] * n[1] + r[3 * i + 2] * n[2];
    }
}

static void draw_tile(const Frame *f, const Camera *k, int64_t t, Tile *tile, Looks *l) {
    const int left = f->tiles[t][1], top = f->tiles[t][2], samples = k->color ? f->sample_count : 1;
    clear(f, tile, left, top, samples, k->near, k->far);
    for (int64_t m = f->firsts[t], end = f->firsts[t + 1]; m < end; m++) {
        const char *ahead = (const char *)(f->seen + f->members[m + AHEAD < end ? m + AHEAD : m]);
        __builtin_prefetch(ahead), __builtin_prefetch(ahead + 64);
        cover(f, f->members[m], tile);
    }
    const int width = k->width - left < TILE ? k->width - left : TILE;
    const int height = k->height - top < TILE ? k->height - top : TILE;
    EACH(y, height) {
        const int64_t pixel = k->pixel + (int64_t)(top + y) * k->width + left;
        int32_t last = -1, instance = -1;
        EACH(x, width) {
            const int32_t who = tile->shown[0][y * TILE + x];
            if (who != last) last = who, instance = who < 0 ? -1 : f->parts[f->seen[who].part].instance;
            f->ids[pixel + x] = instance;
            f->depth[pixel + x] = who < 0 ? 0 : 1 / tile->inverse[0][y * TILE + x];
        }
        if (k->normals) write_normals(f, k, tile, y, width, l);
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
    EACH(i, MOST_PLANES) l.planes[i].who = -1;
    for (int64_t t; (t = take(f)) < f->tile_count;) draw_tile(f, f->cameras + f->tiles[t][0], t, &tile, &l);
}
