// Finds the closed parts of a mesh; the twin of tests/kernel/twins/closed.py.
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "drawing.h"
#include "export.h"

// A mesh, and memory for the search. The sizes of the tables are powers of two, at least twice the number of vertices
// and of edges. Edge 3 t + i of triangle t is that from its vertex i to the next one.
typedef struct {
    const float (*points)[3];
    const int32_t (*triangles)[3];
    int32_t *points_table, *edges_table;
    int32_t *welded;  // the first vertex with the same position, of each vertex
    int32_t *beside;  // the other edge of each edge
    int32_t *labels;  // the first triangle of the part of each triangle; the result: -1 if it is not closed
    double *volumes;
    int64_t points_size, edges_size, vertex_count, triangle_count;
} ClosedSearch;

enum { NONE = -1, SEVERAL = -2 };

MORSE_EXPORT void morse_draw_closed(ClosedSearch *s);

static uint64_t mixed(uint64_t a) {
    a *= 0x9E3779B97F4A7C15u;
    return a ^ a >> 32;
}

static void weld(const ClosedSearch *s) {
    for (int64_t i = 0; i < s->points_size; i++) s->points_table[i] = NONE;
    for (int32_t v = 0; v < s->vertex_count; v++) {
        uint32_t bits[3];
        memcpy(bits, s->points[v], sizeof bits);
        uint64_t at = mixed(mixed(bits[0] + mixed(bits[1])) + bits[2]);
        for (;; at++) {
            int32_t *known = s->points_table + (at & (uint64_t)(s->points_size - 1));
            if (*known < 0) *known = v;
            if (memcmp(s->points[*known], s->points[v], sizeof bits)) continue;
            s->welded[v] = *known;
            break;
        }
    }
}

static int32_t start_of(const ClosedSearch *s, int32_t edge) { return s->welded[s->triangles[edge / 3][edge % 3]]; }
static int32_t end_of(const ClosedSearch *s, int32_t edge) { return s->welded[s->triangles[edge / 3][(edge + 1) % 3]]; }

// The other edge with the same ends, if it is the only one and has the opposite direction.
static void pair(const ClosedSearch *s) {
    const int32_t edges = (int32_t)(3 * s->triangle_count);
    for (int64_t i = 0; i < s->edges_size; i++) s->edges_table[i] = NONE;
    for (int32_t e = 0; e < edges; e++) {
        const int32_t a = start_of(s, e), b = end_of(s, e), low = a < b ? a : b, high = a < b ? b : a;
        s->beside[e] = NONE;
        for (uint64_t at = mixed((uint64_t)low << 32 | (uint64_t)high);; at++) {
            int32_t *known = s->edges_table + (at & (uint64_t)(s->edges_size - 1));
            if (*known < 0) *known = e;
            const int32_t k = *known, c = start_of(s, k), d = end_of(s, k);
            if ((c != low || d != high) && (c != high || d != low)) continue;
            if (k != e) s->beside[k] = s->beside[k] == NONE ? e : SEVERAL;
            break;
        }
    }
    for (int32_t e = 0; e < edges; e++) {
        const int32_t other = s->beside[e];
        // set from the first of them already
        if (other < e && other >= 0) continue;
        if (other >= 0 && start_of(s, e) == end_of(s, other) && start_of(s, e) != end_of(s, e))
            s->beside[other] = e;
        else
            s->beside[e] = NONE;
    }
}

static int32_t root_of(int32_t *labels, int32_t t) {
    while (labels[t] != t) t = labels[t] = labels[labels[t]];
    return t;
}

// Six times the volume between a triangle and a point.
static double volume_of(const ClosedSearch *s, int32_t t, const float *origin) {
    double p[3][3];
    EACH(n, 3) EACH(i, 3) p[n][i] = (double)s->points[s->triangles[t][n]][i] - origin[i];
    return p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) + p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
           p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
}

// Sets the labels. The vertices of triangles exist, and are finite.
void morse_draw_closed(ClosedSearch *s) {
    const int32_t count = (int32_t)s->triangle_count;
    weld(s), pair(s);
    for (int32_t t = 0; t < count; t++) s->labels[t] = t, s->volumes[t] = 0;
    for (int32_t e = 0; e < 3 * count; e++) {
        if (s->beside[e] < 0) continue;
        const int32_t a = root_of(s->labels, e / 3), b = root_of(s->labels, s->beside[e] / 3);
        s->labels[a > b ? a : b] = a < b ? a : b;
    }
    for (int32_t t = 0; t < count; t++)
        s->volumes[root_of(s->labels, t)] += volume_of(s, t, s->points[s->triangles[0][0]]);
    for (int32_t e = 0; e < 3 * count; e++)
        if (s->beside[e] < 0) s->volumes[root_of(s->labels, e / 3)] = -INFINITY;
    for (int32_t t = 0; t < count; t++) s->labels[t] = root_of(s->labels, t);
    for (int32_t t = 0; t < count; t++)
        if (!(s->volumes[s->labels[t]] > 0)) s->labels[t] = NONE;
}
