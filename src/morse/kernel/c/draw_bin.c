// Finds the triangles that may be visible in each tile of the images.
#include <stdint.h>

#include "drawing.h"
#include "export.h"

MORSE_EXPORT void morse_draw_bin(Frame *f);

// Whether a triangle does not touch a tile.
static int misses(const Seen *s, float x, float y) {
    EACH(i, 3) {
        const float *e = s->e[i];
        if (e[0] * (e[0] > 0 ? x + TILE : x) + e[1] * (e[1] > 0 ? y + TILE : y) + e[2] < 0) return 1;
    }
    return 0;
}

// The triangles of each tile in their order: counted, or stored if there are members. Threads share the cameras.
void morse_draw_bin(Frame *f) {
    for (int64_t c; (c = take(f)) < f->camera_count;) {
        const int across = (f->cameras[c].width + TILE - 1) / TILE;
        int64_t *firsts = f->firsts + f->cameras[c].tile;
        EACH(j, f->job_count) {
            if (f->jobs[j][0] != c) continue;
            for (const Seen *s = f->seen + f->starts[j], *end = s + f->counts[j]; s < end; s++) {
                const int x0 = s->x0 / TILE, y0 = s->y0 / TILE, x1 = s->x1 / TILE, y1 = s->y1 / TILE;
                const int large = x1 - x0 + y1 - y0 > 1;
                for (int y = y0; y <= y1; y++)
                    for (int x = x0; x <= x1; x++) {
                        if (large && misses(s, (float)(x * TILE), (float)(y * TILE))) continue;
                        const int64_t at = firsts[y * across + x]++;
                        if (f->members) f->members[at] = (int32_t)(s - f->seen);
                    }
            }
        }
    }
}
