// Samples of pixels that are shaded together with those of other triangles.
//
// The samples of several rows are collected, then those that are nearly on one plane are joined, then eight at a time
// are shaded.
#pragma once
#include <math.h>

#include "draw_blocks.h"
#include "draw_shown.h"

// Triangles of a material in a pixel are shaded together if the cosine of the angle between their normals is larger,
// and the relative difference of their 1 / depth is smaller.
#define ALIKE 0.95f
#define APART 0.125f

// Light is added up in integers, so that the result does not depend on the order: ONE_LIGHT of them are 1.
#define LIGHT_SHIFT 16
#define ONE_LIGHT (4095.0f * (1 << LIGHT_SHIFT))

// Maximum number of samples that are collected, of those in eight pixels, and of those of a kind that wait.
#define MOST_COLLECTED 256
#define MOST_OF_ROW (LANES * MOST_SAMPLES)
#define MOST_WAITING 256

// The samples of a triangle in a pixel: the first of them, and their number. The pixel is row * TILE + column.
typedef struct {
    int32_t who;
    uint16_t pixel;
    uint8_t sample, shares;
} Collected;

// Samples of a kind that wait to be shaded.
typedef struct {
    float x[MOST_WAITING], y[MOST_WAITING];  // position in the image
    float share[MOST_WAITING];               // of the light of the pixel
    uint16_t pixel[MOST_WAITING];
    int16_t place[MOST_WAITING];
    int32_t count;
} __attribute__((aligned(32))) Waiting;

typedef struct {
    Collected collected[MOST_COLLECTED];
    int32_t count;
    Waiting waiting[KINDS];
    float x[MOST_SAMPLES][TILE], y[MOST_SAMPLES][TILE];  // the positions of samples in the columns and rows of the tile
    float shares[MOST_SAMPLES + 1];                      // of some samples in the light of a pixel
} Samples;

// Sets the positions of the samples of a tile.
static inline void place_samples(const Frame *f, Samples *s, int left, int top, int samples) {
    s->count = 0;
    EACH(i, KINDS) s->waiting[i].count = 0;
    EACH(n, samples) EACH(i, TILE) {
        s->x[n][i] = (float)(left + i) + 0.5f + f->samples[2 * n];
        s->y[n][i] = (float)(top + i) + 0.5f + f->samples[2 * n + 1];
    }
    EACH(n, samples + 1) s->shares[n] = (float)n / (float)samples * ONE_LIGHT;
}

// Spreads eight bits over eight bytes, the lowest of each.
static inline uint64_t spread(unsigned bits) {
    return (((bits & 127) * 0x0002040810204081u) & 0x0101010101010101u) | (uint64_t)(bits >> 7) << 56;
}

// Collects the samples of the first pixels of a row of a block.
static inline void collect(Samples *s, const Tile *t, int block, int r, int first, int pixels) {
    I8 shares[MOST_SAMPLES];
    uint64_t kept = 0;  // a byte for each pixel, with a bit for each sample
    const int samples = t->samples;
    EACH(n, samples) {
        const I8 who = t->shown[block][n][r];
        I8 repeated = splat_int(0);
        shares[n] = splat_int(1);
        EACH(m, n) {
            const I8 same = t->shown[block][m][r] == who;
            shares[m] -= same, repeated |= same;
        }
        kept |= spread(lanes_of(~repeated) & ((1u << pixels) - 1)) << n;
    }
    for (; kept; kept &= kept - 1) {
        const int bit = __builtin_ctzll(kept), j = bit / 8, n = bit % 8;
        s->collected[s->count++] = (Collected){((const int32_t *)&t->shown[block][n][r])[j], (uint16_t)(first + j),
                                               (uint8_t)n, (uint8_t)((const int32_t *)(shares + n))[j]};
    }
}

// Whether two samples of a material are nearly on one plane.
static inline int on_a_plane(F8 a, F8 b) {
    const F8 ab = a * b, aa = a * a, bb = b * b;
    const float cosine = ab[0] + ab[1] + ab[2], most = (aa[0] + aa[1] + aa[2]) * (bb[0] + bb[1] + bb[2]);
    return cosine > 0 && cosine * cosine > ALIKE * ALIKE * most && fabsf(a[INVERSE] - b[INVERSE]) < APART * a[INVERSE];
}

// Whether the texture continues from one triangle to another: its coordinates change by less than in a pixel.
static inline int continues(const Planes *one, F8 a, F8 b) {
    const F8 whole_a = splat(a[WHOLE]), at = a / whole_a, apart = b / splat(b[WHOLE]) - at;
    const F8 right = one->across - at * one->across[WHOLE], down = one->down - at * one->down[WHOLE];
    const I8 near = absolute(apart) * absolute(whole_a) <= absolute(right) + absolute(down);
    return near[TEXTURE_U] & near[TEXTURE_V];
}

// The samples of a pixel, with the attributes of those that have been compared.
typedef struct {
    const Collected *of;
    const int16_t *places;
    const int32_t *materials;
    F8 values[MOST_SAMPLES];
    unsigned known;
} Pixel;

static inline F8 value_of(const Samples *s, const Shown *shown, Pixel *p, int n) {
    if (!(p->known >> n & 1)) {
        const unsigned pixel = p->of->pixel, sample = p->of[n].sample;
        p->values[n] = at_point(shown->planes + p->places[n], s->x[sample][pixel % TILE], s->y[sample][pixel / TILE]);
        p->known |= 1u << n;
    }
    return p->values[n];
}

// Whether a sample of a pixel can be shaded with another one.
static inline int alike(const Samples *s, const Shown *shown, Pixel *p, int n, int other) {
    if (p->materials[n] != p->materials[other] || p->materials[n] < 0) return 0;
    const F8 a = value_of(s, shown, p, n), b = value_of(s, shown, p, other);
    if (!on_a_plane(a, b)) return 0;
    const int place = p->places[n];
    return shown->kind[place] != TEXTURED_SURFACES || continues(shown->planes + place, a, b);
}
