// Finds the vertices of each cluster that have the same position: vertices of flat faces differ in their normals only.
// The box around them is smaller than the sphere of the cluster.
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "drawing.h"
#include "export.h"

// Size of the hash table, a power of two.
#define PLACES 2048

MORSE_EXPORT void morse_draw_points(Frame *f);

static unsigned hash_of(const float *p) {
    uint32_t bits[3];
    memcpy(bits, p, sizeof bits);
    const uint32_t mixed = bits[0] * 2654435761u ^ bits[1] * 2246822519u ^ bits[2] * 3266489917u;
    return (mixed ^ mixed >> 15) % PLACES;
}

// Positions without repetitions; `index` receives the position of each vertex. Returns their number.
static int32_t distinct(const Vertex *v, int count, float (*points)[3], uint16_t *index) {
    uint16_t table[PLACES];  // numbers of positions plus one, 0 for none
    int32_t known = 0;
    memset(table, 0, sizeof table);
    EACH(i, count) {
        unsigned at = hash_of(v[i].p);
        while (table[at] && memcmp(points[table[at] - 1], v[i].p, sizeof *points)) at = (at + 1) % PLACES;
        if (!table[at]) {
            memcpy(points[known], v[i].p, sizeof *points);
            table[at] = (uint16_t)++known;
        }
        index[i] = (uint16_t)(table[at] - 1);
    }
    return known;
}

static void surround(const float (*points)[3], int count, float *box) {
    EACH(i, 3) box[i] = INFINITY, box[i + 3] = -INFINITY;
    EACH(n, count) EACH(i, 3) {
        // NaN has no effect: triangles with it are not drawn
        if (points[n][i] < box[i]) box[i] = points[n][i];
        if (points[n][i] > box[i + 3]) box[i + 3] = points[n][i];
    }
}

// Sets the points and the boxes of all clusters.
void morse_draw_points(Frame *f) {
    uint16_t index[MOST_VERTICES];
    EACH(c, f->cluster_count) {
        const Cluster *k = f->clusters + c;
        f->point_counts[c] = distinct(f->vertices + k->vertex, k->vertices, f->points + k->vertex, index);
        surround((const float (*)[3])(f->points + k->vertex), f->point_counts[c], f->boxes[c]);
        for (int t = k->triangle; t < k->triangle + k->triangles; t++) {
            EACH(i, 3) f->corners[t][i] = index[f->triangles[t][i]];
        }
    }
}
