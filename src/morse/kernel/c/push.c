// Driven robots that do not glide, because they push something or have just started; the twin of
// `tests/kernel/twins/pushing.py`.
#include <math.h>
#include <stdint.h>

#include "export.h"
#include "gliders.h"
#include "turns.h"

// changes of height (m) and tilt per tick below which a robot has settled
#define SETTLED 1e-9

MORSE_EXPORT int64_t morse_push(Gliders *all, int64_t left, int64_t tick);

static void write_velocity(double *v, const double *r, double x, double y, double rate, int ground, int shift) {
    // the zeros are the vertical speed, and the roll and pitch rates of the command
    const double vx = r[0] * x + r[1] * y + r[2] * 0.0, vy = r[3] * x + r[4] * y + r[5] * 0.0;
    const double vz = r[6] * x + r[7] * y + r[8] * 0.0;
    v[0] = vx;
    v[1] = vy;
    if (ground) {
        const double turning = r[6] * v[3] + r[7] * v[4] + r[8] * v[5];
        const double change = r[6] * 0.0 + r[7] * 0.0 + r[8] * rate - turning;
        v[3] += r[6] * change;
        v[4] += r[7] * change;
        v[5] += r[8] * change;
    } else if (shift) {
        if (vz != 0.0) v[2] = vz;
        v[5] = rate;
    } else {
        v[2] = vz;
        v[3] = v[4] = 0.0;
        v[5] = rate;
    }
}

// Records the stance of a robot; returns whether it has settled since the last tick and may glide.
static int stands_still(const Gliders *all, int64_t slot, int64_t tick) {
    const double height = all->positions[3 * slot + 2], *up = all->rotations + 9 * slot + 6;
    double *before = all->ups + 3 * slot;
    const int still = all->ticks[slot] == tick - 1 && fabs(height - all->heights[slot]) < SETTLED &&
                      fabs(up[0] - before[0]) < SETTLED && fabs(up[1] - before[1]) < SETTLED &&
                      fabs(up[2] - before[2]) < SETTLED;
    all->ticks[slot] = tick;
    all->heights[slot] = height;
    for (int k = 0; k < 3; k++) before[k] = up[k];
    return still && tick >= all->until[slot];
}

// Drives the first rows of `others` as far as possible; returns the number of the remaining ones.
int64_t morse_push(Gliders *all, int64_t left, int64_t tick) {
    int64_t remaining = 0;
    all->settled_count = 0;
    for (int64_t k = 0; k < left; k++) {
        const int64_t i = all->others[k], slot = all->slots[i];
        double x = all->forward[i], y = all->aside[i];
        const double rate = all->rate[i];
        const int moves = x != 0.0 || y != 0.0 || rate != 0.0;
        if (!all->plain[slot] || !all->free[slot] || all->speeds[slot] >= 0.0 || moves != all->sliding[slot]) {
            all->others[remaining++] = i;
            continue;
        }
        const int ground = all->ground[i], shift = all->shifts[i];
        const Turn turn = arc(&x, &y, 0.5 * rate * all->period);
        write_velocity(all->velocities + all->dofs[slot], all->rotations + 9 * slot, x, y, rate, ground, shift);
        all->cosines[i] = turn.cosine;
        all->sines[i] = turn.sine;
        all->done[i] = (uint8_t)((rate != 0.0 ? TURNS : 0) | (shift ? SHIFTS : 0));
        if (moves && ground && all->able[slot] && stands_still(all, slot, tick)) all->settled[all->settled_count++] = i;
    }
    return remaining;
}
