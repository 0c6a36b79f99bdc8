// All stages of the images of a tick, for any number of threads at once.
//
// A stage begins when the one before is complete. A thread that comes late finds no more work: no thread waits for it.
#include <stdint.h>

#include "drawing.h"
#include "export.h"
#include "waiting.h"

MORSE_EXPORT void morse_draw_picture(Frame *f);

// Takes pieces of a stage until there are no more, then waits for those of other threads.
static void share(Frame *f, int number, int64_t thread, int64_t pieces, void (*work)(Frame *f, int64_t piece)) {
    Stage *stage = f->stages + number;
    for (int64_t i; (i = take_piece(f, number, thread, pieces)) >= 0;) {
        work(f, i);
        __atomic_fetch_add(&stage->done, 1, __ATOMIC_RELEASE);
    }
    for (int n = 0; __atomic_load_n(&stage->done, __ATOMIC_ACQUIRE) < pieces; n += n < INT32_MAX) pass_time(n);
}

// Draws the images, unless the members of the tiles need more memory than there is. With more memory, the next call
// goes on from there.
void morse_draw_picture(Frame *f) {
    const int64_t thread = __atomic_fetch_add(&f->arrived, 1, __ATOMIC_RELAXED);
    share(f, PROJECT, thread, f->chunk_count, draw_project);
    share(f, SUM, thread, 1, draw_sum);
    if (f->member_count > f->member_room) return;
    share(f, BIN, thread, f->chunk_count, draw_bin);
    draw_pixels(f, thread);
}
