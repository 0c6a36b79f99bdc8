// Finds the parts that each camera may see.
//
// The nearest parts come first: they hide what is behind them before it takes time. The order has no other effect.
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "draw_corners.h"
#include "draw_kept.h"
#include "drawing.h"
#include "export.h"

// Clusters smaller than this many pixels are left out.
#define SMALLEST 0.25f
// The distances of parts are sorted by their exponents and their first four binary digits.
#define DISTANCE_SHIFT 19
#define DISTANCES 4096
// The number of chunks of a camera is at most one more; chunks are at least this many triangles.
#define CHUNKS 32
#define CHUNK_TRIANGLES 512

MORSE_EXPORT int32_t morse_draw_find(Frame *f);

// Whether a sphere may be visible. `nearest` receives the distance of the nearest point from the plane of the camera.
static int may_be_seen(const Camera *k, const float *m, const float *s, float *nearest) {
    const float *r = k->axes, fx = k->fx, fy = k->fy;
    const float side[4] = {k->cx, (float)k->width - k->cx, k->cy, (float)k->height - k->cy};
    float x[3], q[3], length[4];
    EACH(i, 3) x[i] = m[4 * i] * s[0] + m[4 * i + 1] * s[1] + m[4 * i + 2] * s[2] + m[4 * i + 3] - k->eye[i];
    EACH(i, 3) q[i] = r[3 * i] * x[0] + r[3 * i + 1] * x[1] + r[3 * i + 2] * x[2];
    const float size = s[3] * stretch_of(m), w = k->parallel ? 1 : q[2];
    *nearest = q[2] - size;
    if (!(q[2] >= k->near - size && q[2] <= k->far + size)) return 0;
    if (q[2] > size && (fx > fy ? fx : fy) * size < SMALLEST * w) return 0;
    EACH(i, 4) length[i] = sqrtf((i < 2 ? fx * fx : fy * fy) + (k->parallel ? 0 : side[i] * side[i]));
    if (side[0] * w + fx * q[0] < -size * length[0] || side[1] * w - fx * q[0] < -size * length[1]) return 0;
    return side[2] * w + fy * q[1] >= -size * length[2] && side[3] * w - fy * q[1] >= -size * length[3];
}

// Whether a box is beside the image or behind the camera, with all that is in it. In double precision: a sample is at
// least a tenth of a pixel from the border of the image, which is more than all rounding errors.
static int is_beside(const Camera *k, const float *m, const float *box) {
    double a[4][4], sides[5][4];
    projection(k, m, a);
    EACH(i, 4) {
        sides[0][i] = a[0][i], sides[1][i] = k->width * a[2][i] - a[0][i];
        sides[2][i] = a[1][i], sides[3][i] = k->height * a[2][i] - a[1][i];
        sides[4][i] = a[3][i] - (i == 3 ? (double)k->near : 0);
    }
    EACH(n, 5) {
        double most = sides[n][3];
        EACH(i, 3) most += sides[n][i] * (double)box[sides[n][i] > 0 ? i + 3 : i];
        if (most < 0) return 1;
    }
    return 0;
}

// Whether a cluster belongs to the level of detail that a camera sees: the error of the level is allowed, that of the
// next one is not.
static int is_level(const Camera *k, const float *m, const float *level) {
    const float *r = k->axes;
    float depth = 0;
    // most meshes are not simplified
    if (level[4] == 0 && level[5] == INFINITY) return 1;
    EACH(i, 3) {
        const float x = m[4 * i] * level[0] + m[4 * i + 1] * level[1] + m[4 * i + 2] * level[2] + m[4 * i + 3];
        depth += r[6 + i] * (x - k->eye[i]);
    }
    const float scale = scale_of(m), nearest = depth - level[3] * scale;
    // false for NaN
    const float allowed = nearest > k->near ? nearest * k->tolerance : 0;
    return level[4] * scale <= allowed && !(level[5] * scale <= allowed);
}

static int32_t rank_of(float nearest) {
    int32_t bits;
    // false for NaN
    if (!(nearest > 0)) return 0;
    memcpy(&bits, &nearest, sizeof bits);
    return bits >> DISTANCE_SHIFT;
}

static int32_t triangles_of(const Frame *f, int32_t part) { return f->clusters[f->parts[part].cluster].triangles; }

// Sets the jobs of a camera, from `first`; returns the end. `size` receives the number of triangles. `partly` if some
// tiles are not drawn.
static int32_t find(Frame *f, int32_t camera, int partly, int32_t first, int64_t *size) {
    int32_t places[DISTANCES + 1] = {0}, count = 0, end = first;
    *size = 0;
    EACH(p, f->part_count) {
        const Part *part = f->parts + p;
        float nearest;
        const float *m = f->models[part->instance];
        if (!is_level(f->cameras + camera, m, f->levels[part->cluster])) continue;
        if (!may_be_seen(f->cameras + camera, m, f->spheres[part->cluster], &nearest)) continue;
        if (is_beside(f->cameras + camera, m, f->boxes[part->cluster])) continue;
        if (partly && !is_in_drawn_tile(f, f->cameras + camera, m, f->spheres[part->cluster])) continue;
        f->found[count][0] = p, f->found[count][1] = rank_of(nearest);
        places[f->found[count++][1] + 1]++;
        *size += triangles_of(f, p);
    }
    EACH(d, DISTANCES) places[d + 1] += places[d];
    EACH(i, count) {
        const int32_t p = f->found[i][0], at = first + places[f->found[i][1]]++;
        f->jobs[at][0] = camera, f->jobs[at][1] = p, f->starts[at] = f->seen_count;
        f->seen_count += triangles_of(f, p), end++;
    }
    return end;
}

// Divides the jobs of a camera into chunks of about the same number of triangles.
static void divide(Frame *f, int32_t camera, int32_t first, int32_t end, int64_t size, int32_t tiles, int64_t *row) {
    const int64_t wanted = size / CHUNKS > CHUNK_TRIANGLES ? size / CHUNKS : CHUNK_TRIANGLES;
    for (int32_t j = first; j < end;) {
        Chunk *chunk = f->chunks + f->chunk_count++;
        *chunk = (Chunk){camera, j, j, 0, *row};
        *row += tiles;
        for (int64_t taken = 0; j < end && taken < wanted; j++) taken += triangles_of(f, f->jobs[j][1]);
        chunk->end = j;
    }
}

// Sets the tiles of the cameras, and the jobs in which each of them may see a part; returns the number of jobs. There
// is memory for a job for each camera and part, and for CHUNKS + 1 chunks for each camera.
int32_t morse_draw_find(Frame *f) {
    int32_t count = 0;
    int64_t row = 0;
    f->seen_count = f->chunk_count = 0, f->drawn_count = 0;
    EACH(c, f->camera_count) {
        const Camera *k = f->cameras + c;
        int64_t size;
        int32_t tile = k->tile;
        for (int32_t y = 0; y < k->height; y += TILE)
            for (int32_t x = 0; x < k->width; x += TILE, tile++)
                f->tiles[tile][0] = c, f->tiles[tile][1] = x, f->tiles[tile][2] = y;
        const int64_t drawn = draw_mark(f, c);
        f->drawn_count += drawn;
        if (!drawn) continue;
        const int32_t end = find(f, c, drawn < tile - k->tile, count, &size);
        divide(f, c, count, end, size, tile - k->tile, &row);
        count = end;
    }
    return count;
}
