// The data that cameras draw; the twin of morse/kernel/drawing/structures.py.
#pragma once
#include <stdint.h>

#define TILE 32
#define MOST_SAMPLES 5
#define EACH(i, n) for (int i = 0; i < (n); i++)

enum { SUN_LAMP, POINT_LAMP, SPOT_LAMP, HEMISPHERE_LAMP };
enum { SHADELESS = 1, DOUBLE_SIDED = 2, MASKED = 4, DITHERED = 8 };
enum { MIRRORED = 2 };

// A pinhole camera. Axes are rows: right, down, forward. `pixel` is its first pixel, `tile` its first tile.
typedef struct {
    float fx, fy, cx, cy, near, far, axes[9], eye[3], exposure;
    int32_t width, height, tile, color, normals;
    int64_t pixel;
} Camera;

typedef struct {
    float color[4], emission[3], metallic, roughness;
    int32_t texture, flags, spare;
} Surface;

// Sizes are powers of two; `first` are the first texels of the levels, each half as large as the one before. Rows end
// with a copy of their first texel.
typedef struct {
    int32_t width, height, levels, spare, first[16];
} Texture;

typedef struct {
    float kind, place[3], towards[3], color[3], decay, outer, inner, ground[3];
} Lamp;

typedef struct {
    int32_t cluster, instance, slots, flags;
} Part;

typedef struct {
    int32_t vertex, vertices, triangle, triangles;
} Cluster;

typedef struct {
    float p[3], n[3], uv[2];
} Vertex;

// A triangle in the image of a camera: three edges and 1 / depth, each as a plane (d/dx, d/dy, at pixel 0, 0).
typedef struct {
    float e[3][3], w[3];
    int16_t x0, y0, x1, y1;
    int32_t triangle, part, material, back;
} Seen;

_Static_assert(sizeof(Seen) == 72, "SEEN_BYTES in morse/kernel/drawing/arrays.py");

// Everything that is drawn, for all cameras of a tick.
typedef struct {
    const Vertex *vertices;
    const int32_t (*triangles)[4];  // three vertices, relative to the first of the cluster, and the material slot
    const Cluster *clusters;
    const float (*spheres)[4];  // around clusters: centre, radius
    const Part *parts;
    const int32_t *slots;  // the material of each slot of each instance
    const Surface *materials;
    const int32_t *texels;
    const Texture *textures;
    const Lamp *lamps;
    const float *sky, *samples;
    const uint8_t *encoded;     // 4096 steps of linear light as sRGB
    const float (*models)[12];  // mesh to world, of each instance
    const float (*turns)[9];    // the same for normals
    const Camera *cameras;
    float *shadow;
    const float *sun;
    const float *near_shadow, *near_sun;    // a finer map of a part of the world
    const float *lamp_shadow, *lamp_frame;  // a perspective map of a spot lamp: minus the depths, m
    int32_t (*jobs)[2];                     // pairs of camera and part
    int64_t *starts, *counts;
    Seen *seen;
    int64_t *firsts;
    int32_t *members;
    const int32_t (*tiles)[4];
    uint8_t (*rgba)[4];
    float *depth;
    int32_t *ids;
    float (*normals)[3];  // unit vectors along the axes of the camera; null if no camera measures them
    int32_t part_count, lamp_count, sample_count, camera_count, job_count, tile_count, shadow_width, shadow_height;
    int32_t near_width, near_height, lamp_width, lamp_height;
    int64_t next;  // index of the next piece of work
} Frame;

static inline int64_t take(Frame *f) { return __atomic_fetch_add(&f->next, 1, __ATOMIC_RELAXED); }
