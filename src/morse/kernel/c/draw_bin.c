// Finds the triangles that may be visible in each tile of the images.
#include "draw_bin.h"

#include <stdint.h>

// The places of the triangles of each chunk in each tile, from their numbers.
void draw_sum(Frame *f, int64_t piece) {
    (void)piece;
    EACH(t, f->tile_count) f->firsts[t] = 0;
    EACH(c, f->chunk_count) {
        const Camera *k = f->cameras + f->chunks[c].camera;
        int32_t *share = f->shares + f->chunks[c].row;
        int64_t *whole = f->firsts + k->tile;
        const int32_t tiles = tiles_of(k);
        EACH(t, tiles) {
            const int32_t own = share[t];
            share[t] = (int32_t)whole[t], whole[t] += own;
        }
    }
    f->member_count = 0;
    EACH(t, f->tile_count) {
        const int64_t whole = f->firsts[t];
        f->firsts[t] = f->member_count, f->member_count += whole;
    }
    f->firsts[f->tile_count] = f->member_count;
}

// Lists the triangles of a chunk, in their order.
void draw_bin(Frame *f, int64_t piece) {
    const Chunk *chunk = f->chunks + piece;
    const Camera *k = f->cameras + chunk->camera;
    for (int32_t j = chunk->first; j < chunk->end; j++) {
        for (int64_t s = f->starts[j], end = s + f->counts[j]; s < end; s++) {
            add_to_tiles(f, k, s, f->shares + chunk->row, f->firsts + k->tile);
        }
    }
}
