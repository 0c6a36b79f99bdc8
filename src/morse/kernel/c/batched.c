// Rows of a batch: the ticks and the scans of many simulations in which robots only glide.
#include <stdint.h>
#include <string.h>

#include "course.h"
#include "export.h"
#include "placing.h"
#include "solids.h"

typedef struct {
    const Course *const *courses;   // (N) of the rows
    double *positions, *rotations;  // results (N, K, 3), (N, K, 9): the poses of all rigid groups
    int64_t groups;                 // K, of which the moving ones are the first
} Batched;

// A scan of a row.
typedef struct {
    const Placing *placing;
    const Gathering *moving;
    Solids *solids;
    Rays *rays;
    int64_t count;  // of all rays
} Lane;

MORSE_EXPORT void morse_batched_run(const Batched *all, const int64_t *rows, int64_t count, int64_t ticks,
                                    int64_t *done);
MORSE_EXPORT void morse_batched_cast(const Lane *lanes, const int64_t *rows, int64_t count);

// Runs ticks in some rows; `done` are their numbers, which are smaller if a robot does not glide.
void morse_batched_run(const Batched *all, const int64_t *rows, int64_t count, int64_t ticks, int64_t *done) {
    for (int64_t i = 0; i < count; i++) {
        const Course *course = all->courses[rows[i]];
        done[i] = morse_glide_ticks(course, ticks);
        const int64_t first = rows[i] * all->groups;
        memcpy(all->positions + 3 * first, course->positions, (size_t)course->count * 3 * sizeof(double));
        memcpy(all->rotations + 9 * first, course->rotations, (size_t)course->count * 9 * sizeof(double));
    }
}

// Places the moving solids of some rows, and casts the rays.
void morse_batched_cast(const Lane *lanes, const int64_t *rows, int64_t count) {
    for (int64_t i = 0; i < count; i++) {
        const Lane *lane = lanes + rows[i];
        const int32_t nodes = morse_rays_place(lane->placing, lane->moving);
        lane->solids->moving = nodes ? lane->moving->nodes : NULL;
        lane->solids->moving_leaves = lane->moving->leaves;
        lane->rays->next = 0;
        morse_rays_cast(lane->solids, lane->rays, lane->count, lane->count);
    }
}
