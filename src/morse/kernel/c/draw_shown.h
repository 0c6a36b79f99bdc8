// The triangles that the pixels of a tile show, with the planes of their attributes.
#pragma once
#include "draw_classic.h"
#include "draw_surface.h"

// Maximum number of triangles at a time.
#define MOST_SHOWN 320
// Size of the table in which triangles are found again; a triangle that is not found is there twice.
#define SHOWN_TABLE 1024

// Samples are shaded with others of their kind.
enum { NO_SURFACES, PLAIN_SURFACES, TEXTURED_SURFACES, KINDS };

typedef struct {
    Planes planes[MOST_SHOWN];
    int32_t who[MOST_SHOWN], material[MOST_SHOWN], kind[MOST_SHOWN];
    int32_t count, complete;  // all of them, and the number of those whose planes are known
    int16_t table[SHOWN_TABLE];
    Corners corners[MOST_SHOWN];  // in the classic look
} Shown;

// The place of a triangle, which may be new.
static inline int place_of(const Frame *f, Shown *s, int32_t who) {
    int16_t *at = s->table + (who & (SHOWN_TABLE - 1));
    if (*at < s->count && s->who[*at] == who) return *at;
    *at = (int16_t)s->count, s->who[s->count] = who;
    __builtin_prefetch(f->triangles + f->seen[who].triangle);
    return s->count++;
}

// Computes the planes of new triangles: one after the other, so that the processor waits for the memory of several at
// once.
static inline void complete(const Frame *f, const Camera *k, Shown *s) {
    for (int i = s->complete; i < s->count; i++) {
        const Seen *seen = f->seen + s->who[i];
        const Vertex *base = f->vertices + f->clusters[f->parts[seen->part].cluster].vertex;
        EACH(n, 3) __builtin_prefetch(base + f->triangles[seen->triangle][n]);
    }
    const Seen *lit[2];
    Corners *corners[2];
    int waiting = 0;
    for (int i = s->complete; i < s->count; i++) {
        const Seen *seen = f->seen + s->who[i];
        s->planes[i] = planes_of(f, seen), s->material[i] = seen->material;
        if (f->classic) memcpy(s->corners[i].e, seen->e, sizeof seen->e);
        // others are lit at each pixel
        if (f->classic && !(f->materials[seen->material].flags & FINE)) {
            lit[waiting] = seen, corners[waiting++] = s->corners + i;
            if (waiting == 2) light_corners(f, k, lit, corners), waiting = 0;
        }
        s->kind[i] = f->materials[seen->material].texture >= 0 ? TEXTURED_SURFACES : PLAIN_SURFACES;
    }
    if (waiting) lit[1] = lit[0], corners[1] = corners[0], light_corners(f, k, lit, corners);
    s->complete = s->count;
}
