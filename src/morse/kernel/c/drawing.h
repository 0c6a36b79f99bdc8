// The data that cameras draw; the twin of morse/kernel/drawing/native.py.
#pragma once
#include <stdint.h>

#define TILE 32
#define MOST_SAMPLES 5
// Maximum numbers of triangles and vertices of a cluster.
#define MOST_TRIANGLES 256
#define MOST_VERTICES (3 * MOST_TRIANGLES)
// Side of a block of a shadow map: 1 << SHADOW_SHIFT texels.
#define SHADOW_SHIFT 3
#define EACH(i, n) for (int i = 0; i < (n); i++)

enum { SUN_LAMP, POINT_LAMP, SPOT_LAMP, HEMISPHERE_LAMP };
enum { SHADELESS = 1, DOUBLE_SIDED = 2, MASKED = 4, DITHERED = 8, HAZED = 16, FINE = 32 };
enum { MIRRORED = 2, SOLID = 4 };
// Closed parts of a mesh: of one material, and of several.
enum { CLOSED = 1, MIXED = 2 };

// A camera. Axes are rows: right, down, forward. `pixel` is its first pixel, `tile` its first tile. `tolerance` is the
// allowed error of surfaces, relative to their depth. The rays of pinholes begin at the eye, those of `parallel`
// cameras in a plane through it: `fx` and `fy` are pixels per m then.
typedef struct {
    float fx, fy, cx, cy, near, far, axes[9], eye[3], exposure, tolerance;
    int32_t width, height, tile, color, normals;
    int64_t pixel;
    int32_t parallel;
} Camera;

// The sum of the depths of the planes between which parallel rays see.
static inline float reach_of(const Camera *k) { return k->near + k->far; }

// In the classic look, FINE surfaces are lit at each pixel, as if their triangles were small, `metallic` is the
// specular coefficient and `roughness` the exponent of highlights.
typedef struct {
    float color[4], emission[3], metallic, roughness;
    int32_t texture, flags, spare;  // in this order, they are read together
} Surface;

// Sizes are powers of two; `first` are the first texels of the levels, each half as large as the one before. Rows end
// with a copy of their first texel. In the classic look, `spare` is the share of the true size as a float, 0 for all.
typedef struct {
    int32_t width, height, levels, spare, first[16];
} Texture;

typedef struct {
    float kind, place[3], towards[3], color[3], decay, outer, inner, ground[3];
} Lamp;

// Maximum number of lights of the classic look that cast shadows.
#define MOST_SHADOWS 4
// Lights of a corner: of all lights without shadows, then of those with shadows; red, green and blue of each.
#define CORNER_LIGHTS (3 * (1 + MOST_SHADOWS))

// All texels that are read for a point in a block of a shadow map are between two planes: their changes to the right
// and down, and their values at its first texel.
typedef struct {
    float across, down, low, high;
} ShadowBlock;

// A light of the classic look, as OpenGL has it. `cutoff` is a cosine, -1 for light in all directions. Lights that cast
// shadows are numbered from 1 in `number`, the others have 0. `width` is 0 without a shadow map, as no shadow is seen.
// `version` is another one for each map. Maps of a light that stands differ by the size of a texel, frame[12], and
// their origin: see `origin_of`.
typedef struct {
    float place[3], towards[3], ambient[3], diffuse[3], specular[3], attenuation[3], cutoff, exponent, frame[16];
    int32_t directional, number, width, height;
    const float *shadow;
    const ShadowBlock *bounds;  // of each block of the map
    int64_t version;
} ClassicLight;

_Static_assert(sizeof(ClassicLight) == 184, "CLASSIC_LIGHT in morse/kernel/drawing/arrays.py");

// The rest of the classic look. `sky` is the first of six textures: +X, -X, +Y, -Y, +Z and -Z; -1 without. The haze is
// a ring of radius `far` around the camera on a plane (its normal and its offset), the border of the plane, which
// becomes opaque outward over the share `ring` of the radius, and vanishes from there to the horizon.
typedef struct {
    int32_t light_count, shadow_count, sky, hazy, foggy;
    float haze[3], ring, far, plane[4], background[3], fog[3], fog_start, fog_end;
} Classic;

typedef struct {
    int32_t cluster, instance, slots, flags;
} Part;

typedef struct {
    int32_t vertex, vertices, triangle, triangles;
} Cluster;

typedef struct {
    float p[3], n[3], uv[2];
} Vertex;

// A triangle in the image of a camera: three edges and 1 / depth, each as a plane (d/dx, d/dy, at pixel 0, 0). It fills
// a line of the cache.
typedef struct {
    float e[3][3], w[3];
    int32_t triangle, part, material, back;
} Seen;

_Static_assert(sizeof(Seen) == 64, "SEEN in morse/kernel/drawing/arrays.py");

// The pixels whose samples a triangle may contain, inclusive.
typedef struct {
    int16_t x0, y0, x1, y1;
} Bounds;

// Jobs of a camera that a thread takes at once: `first` to before `end`. `row` is its first number in Frame.shares.
typedef struct {
    int32_t camera, first, end, spare;
    int64_t row;
} Chunk;

// The shadow maps.
enum { SUN_MAP, NEAR_MAP, LAMP_MAP, MAPS };
// Rectangles of texels that are read for a tile: of each of them, or of each light with shadows of the classic look.
#define READS MOST_SHADOWS
_Static_assert((int)MAPS <= (int)READS, "each map has a rectangle");

// What is kept of the last image of a camera; `_Kept` in morse/kernel/drawing/native.py.
typedef struct {
    uint8_t (*rgba)[4];
    float *depth;
    int32_t *ids;
    float (*normals)[3];
    float (*models)[12], (*turns)[9];  // of all instances, in this image
    const float *lamp_shadow;          // the map of this image
    int32_t (*reads)[READS][4];        // texels that are read for each tile: x0, y0, x1, y1, one past the end
    const ClassicLight *lights;        // the lights of this image in the classic look
    int64_t change;                    // Frame.change at this image
    int32_t instances, is_complete;
} Kept;

// Pieces of work that two threads share, one from the front and one from the back: pieces that are near each other need
// the same data, which are then in the cache of one processor. The numbers of pieces that have been taken.
typedef struct {
    int64_t taken, front, back;
} Range;

// Maximum number of ranges of a stage.
#define RANGES 4

// Work that threads share, and the number of pieces that are complete.
typedef struct {
    Range ranges[RANGES];
    int64_t done;
} Stage;

enum { PROJECT, SUM, BIN, PIXELS, STAGES };

_Static_assert(sizeof(Chunk) == 24, "CHUNK in morse/kernel/drawing/arrays.py");

// Everything that is drawn, for all cameras of a tick.
typedef struct {
    const Vertex *vertices;
    const int32_t (*triangles)[4];  // three vertices, relative to the first of the cluster, and the material slot
    const Cluster *clusters;
    const float (*spheres)[4];  // around clusters: centre, radius
    const Part *parts;
    const int32_t *slots;  // the material of each slot of each instance
    const Surface *materials;
    const float (*maps)[4];  // of each material: factors and offsets of u and v; may be null
    const int32_t *texels;
    const Texture *textures;
    const Lamp *lamps;
    const float *sky, *samples;
    const uint8_t *encoded;     // 4096 steps of linear light as sRGB
    const uint8_t *closed;      // CLOSED or MIXED for triangles of closed parts
    const float *guards;        // radii of spheres around these parts, with the centres of `spheres`
    const float (*levels)[6];   // spheres around meshes, and the errors of levels of detail
    const float (*models)[12];  // mesh to world, of each instance
    const float (*turns)[9];    // the same for normals
    const Camera *cameras;
    float *shadow;
    const float *sun;
    const float *near_shadow, *near_sun;    // a finer map of a part of the world
    const float *lamp_shadow, *lamp_frame;  // a perspective map of a spot lamp: minus the depths, m
    const Classic *classic;                 // null for the look of scenes
    const ClassicLight *classic_lights;
    const ShadowBlock *shadow_bounds, *near_bounds, *lamp_bounds;  // of each block of these maps; may be null
    // the last change of each block of texels of the two maps, then the last of all; null if changes are not counted
    const int64_t *shadow_changes, *near_changes;
    float (*points)[3];      // the positions of the vertices of each cluster without repetitions, from its first vertex
    uint16_t (*corners)[3];  // three of them for each triangle
    int32_t *point_counts;   // of each cluster
    float (*boxes)[6];       // around the points of each cluster: the lowest and the highest coordinates
    int32_t (*jobs)[2];      // pairs of camera and part, the nearest parts of each camera first
    int32_t (*found)[2];     // pairs of part and distance, for one camera
    int64_t *starts, *counts;  // the triangles of each job in `seen` and `bounds`; in the order of parts
    Chunk *chunks;
    int32_t *shares;  // the triangles of each chunk in each tile: their number, then the place of the next one
    Seen *seen;
    Bounds *bounds;
    int64_t *firsts;  // the first triangle of each tile in `members`
    int32_t *members;
    int32_t (*tiles)[4];  // camera, left, top
    uint8_t *drawn;       // whether each tile is drawn: the others are those of the last image
    Kept **kept;          // of each camera, or null; may be null
    uint8_t (*rgba)[4];
    float *depth;
    int32_t *ids;
    float (*normals)[3];  // unit vectors along the axes of the camera; null if no camera measures them
    int32_t part_count, lamp_count, sample_count, camera_count, job_count, tile_count, shadow_width, shadow_height;
    int32_t near_width, near_height, lamp_width, lamp_height, cluster_count, chunk_count, thread_count;
    int64_t seen_count, member_count, member_room;
    int64_t drawn_count, change;  // number of tiles that are drawn; number of changes of shadow maps
    Stage stages[STAGES];
    int64_t arrived;  // the number of threads that have begun
} Frame;

// The stages of an image; `piece` is a chunk or a tile.
void draw_project(Frame *f, int64_t piece);
void draw_sum(Frame *f, int64_t piece);
void draw_bin(Frame *f, int64_t piece);
void draw_pixels(Frame *f, int64_t thread);

// The next piece of a stage for a thread; -1 if there are no more. A thread whose range is empty continues with others.
static inline int64_t take_piece(Frame *f, int stage, int64_t thread, int64_t pieces) {
    const int64_t pairs = (f->thread_count + 1) / 2, count = pairs < RANGES ? pairs : RANGES;
    for (int64_t i = 0; i < count; i++) {
        const int64_t n = (thread / 2 + i) % count, first = pieces * n / count, end = pieces * (n + 1) / count;
        Range *range = f->stages[stage].ranges + n;
        if (__atomic_fetch_add(&range->taken, 1, __ATOMIC_RELAXED) >= end - first) continue;
        if (thread & 1) return end - 1 - __atomic_fetch_add(&range->back, 1, __ATOMIC_RELAXED);
        return first + __atomic_fetch_add(&range->front, 1, __ATOMIC_RELAXED);
    }
    return -1;
}
