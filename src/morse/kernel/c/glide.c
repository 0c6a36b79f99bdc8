// Robots that are driven together over a level floor; the twin of `tests/kernel/twins/driving.py`.
#include "glide.h"

#include <math.h>
#include <stdint.h>

#include "turns.h"

// Writes the velocities of a tick; returns the number of rows in `others`.
int64_t morse_glide_begin(const Gliders *all) {
    int64_t left = 0;
    for (int64_t i = 0; i < all->count; i++) {
        const int64_t slot = all->slots[i];
        double x = all->forward[i], y = all->aside[i], rate = all->rate[i];
        all->done[i] = LEFT_OUT;
        const int rests = x == 0.0 && y == 0.0 && rate == 0.0;
        const int32_t tree = all->trees[slot];
        if (rests && tree >= 0 && all->asleep[tree] >= 0 && !all->sliding[slot]) continue;
        const double speed = sqrt(x * x + y * y);
        const double nearer = 2.0 * (speed + fabs(rate) * all->extents[slot]) * all->period;
        if (rests || !all->plain[slot] || !(speed <= all->speeds[slot]) || !(nearer <= all->margins[slot])) {
            all->others[left++] = i;
            continue;
        }
        const double *r = all->rotations + 9 * slot;
        double *v = all->velocities + all->dofs[slot];
        const double half = 0.5 * rate * all->period;
        const Turn turn = arc(&x, &y, half);
        const double about = rate * r[8];
        v[0] = r[0] * x + r[1] * y;
        v[1] = r[3] * x + r[4] * y;
        v[2] = 0.0;
        v[3] = r[6] * about;
        v[4] = r[7] * about;
        v[5] = r[8] * about;
        all->cosines[i] = turn.cosine;
        all->sines[i] = turn.sine;
        all->done[i] = (uint8_t)(GLIDES | (rate != 0.0 ? TURNS : 0) | (all->shifts[i] ? SHIFTS : 0));
    }
    return left;
}

// After the tick: a shift leaves no momentum, a velocity points along the new heading.
void morse_glide_end(const Gliders *all) {
    for (int64_t i = 0; i < all->count; i++) {
        double *v = all->velocities + all->dofs[all->slots[i]];
        if (all->done[i] & SHIFTS) {
            v[0] = v[1] = v[5] = 0.0;
        } else if (all->done[i] & TURNS) {
            const double x = v[0], y = v[1], c = all->cosines[i], s = all->sines[i];
            v[0] = c * x - s * y;
            v[1] = s * x + c * y;
        }
    }
}
