// Pictures of many worlds, each by one thread: shadow maps, and pictures of cameras.
//
// Worlds of a chain are drawn one after the other by the same thread: each picture takes over what the one before has
// kept. Chains are taken by any number of threads.
#include <stdint.h>

#include "draw_bounds.h"
#include "drawing.h"
#include "export.h"

// Farther than any surface, NO_SURFACE in morse/kernel/drawing/arrays.py.
#define NO_TEXEL -1e30f

enum { PICTURE, MAP_FROM_AFAR, MAP_FROM_NEAR };

// A picture, or a shadow map with its bounds, which may be null. `fresh`: what is kept is of another camera.
typedef struct {
    Frame frame;
    ShadowBlock *bounds;
    int32_t kind, fresh;
} World;

// The memory of a thread, for the largest of the pictures, and where it is: `first` to `end` are the worlds that are
// left of its chain, of which the first has `begun` if its members need more memory.
typedef struct {
    int32_t (*jobs)[2], (*found)[2];
    int64_t *starts, *counts;
    Chunk *chunks;
    int32_t *shares;
    Seen *seen;
    Bounds *bounds;
    int64_t *firsts;
    int32_t *members, (*tiles)[4];
    uint8_t *drawn;
    int32_t (*rectangles)[4], *ids;
    int64_t member_room, first, end, begun;
} Workspace;

MORSE_EXPORT int64_t morse_draw_worlds(World *worlds, const int64_t *chains, int64_t count, int64_t *next,
                                       Workspace *s);
int32_t morse_draw_find(Frame *f);
void morse_draw_picture(Frame *f);
void morse_draw_shadow(Frame *f, int32_t (*rectangles)[4]);
void morse_draw_bounds(const float *texels, int32_t width, int32_t height, ShadowBlock *bounds);

// The distances from a light in one direction.
static void draw_from_afar(World *w, Workspace *s) {
    Frame *f = &w->frame;
    for (int64_t i = 0; i < (int64_t)f->shadow_width * f->shadow_height; i++) f->shadow[i] = NO_TEXEL;
    EACH(p, f->part_count) s->jobs[p][0] = 0, s->jobs[p][1] = p;
    f->jobs = s->jobs, f->job_count = f->part_count;
    morse_draw_shadow(f, s->rectangles);
}

// Draws a picture; 0 if its members need more memory.
static int draw_picture(Frame *f, Workspace *s) {
    if (!s->begun) {
        f->jobs = s->jobs, f->found = s->found, f->starts = s->starts, f->counts = s->counts, f->chunks = s->chunks;
        f->shares = s->shares, f->seen = s->seen, f->bounds = s->bounds, f->firsts = s->firsts, f->tiles = s->tiles;
        f->drawn = s->drawn, f->thread_count = 1, f->arrived = 0;
        f->job_count = morse_draw_find(f);
    }
    f->members = s->members, f->member_room = s->member_room;
    morse_draw_picture(f);
    s->begun = f->member_count > f->member_room;
    return !s->begun;
}

static int draw_world(World *w, Workspace *s) {
    Frame *f = &w->frame;
    Kept *kept = f->kept ? *f->kept : NULL;
    if (w->kind == MAP_FROM_AFAR) {
        draw_from_afar(w, s);
    } else {
        if (kept && w->fresh && !s->begun) kept->is_complete = 0;
        if (w->kind == MAP_FROM_NEAR) f->ids = s->ids;
        if (!draw_picture(f, s)) return 0;
        if (kept) kept->lights = f->classic_lights, kept->is_complete = 1;
    }
    const Camera *k = f->cameras;
    if (w->kind == MAP_FROM_NEAR)
        for (int64_t i = 0; i < (int64_t)k->width * k->height; i++)
            f->depth[i] = f->depth[i] > 0 ? -f->depth[i] : NO_TEXEL;
    if (w->bounds && w->kind == MAP_FROM_AFAR)
        morse_draw_bounds(f->shadow, f->shadow_width, f->shadow_height, w->bounds);
    else if (w->bounds)
        morse_draw_bounds(f->depth, k->width, k->height, w->bounds);
    return 1;
}

// Draws chains: the worlds from one of the numbers to before the next one. Returns the number of members for which more
// memory is needed, after which the same thread calls again, or 0.
int64_t morse_draw_worlds(World *worlds, const int64_t *chains, int64_t count, int64_t *next, Workspace *s) {
    for (;;) {
        for (; s->first < s->end; s->first++)
            if (!draw_world(worlds + s->first, s)) return worlds[s->first].frame.member_count;
        const int64_t chain = __atomic_fetch_add(next, 1, __ATOMIC_RELAXED);
        if (chain >= count) return 0;
        s->first = chains[chain], s->end = chains[chain + 1];
    }
}
