// Robots that glide over a level floor: their motion, their poses, and ticks in which nothing else happens.
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "course.h"
#include "glide.h"
#include "turns.h"

// Sets the coordinates of robots that move for a time with constant velocities, linear in the axes of the world and
// angular in their own axes. `from` are the coordinates of the engine at the beginning.
void morse_glide_move(const Placed *all, const double *from, const double *velocities, double period) {
    for (int64_t i = 0; i < all->count; i++) {
        const double *p = from + all->places[i], *v = velocities + all->dofs[i];
        double *to = all->qpos + all->places[i], q[4];
        const double size = 1.0 / sqrt(p[3] * p[3] + p[4] * p[4] + p[5] * p[5] + p[6] * p[6]);
        for (int k = 0; k < 4; k++) q[k] = size * p[3 + k];
        for (int k = 0; k < 3; k++) to[k] = p[k] + v[k] * period;
        const double rate = sqrt(v[3] * v[3] + v[4] * v[4] + v[5] * v[5]);
        if (!(rate > 0.0)) {
            memcpy(to + 3, q, sizeof q);
            continue;
        }
        const Turn half = turn_by(0.5 * rate * period);
        const double share = half.sine / rate, w = half.cosine;
        const double x = share * v[3], y = share * v[4], z = share * v[5];
        to[3] = q[0] * w - q[1] * x - q[2] * y - q[3] * z;
        to[4] = q[0] * x + q[1] * w + q[2] * z - q[3] * y;
        to[5] = q[0] * y - q[1] * z + q[2] * w + q[3] * x;
        to[6] = q[0] * z + q[1] * y - q[2] * x + q[3] * w;
    }
}

// Writes the poses of robots. They are these and not those of the engine in any kind of tick, so that the bits do not
// depend on how the engine was compiled.
void morse_glide_poses(const Placed *all, double *positions, double *rotations) {
    for (int64_t i = 0; i < all->count; i++) {
        const double *p = all->qpos + all->places[i];
        const double *q = p + 3;  // a unit quaternion: `morse_glide_move` has set it
        double *r = rotations + 9 * all->slots[i];
        memcpy(positions + 3 * all->slots[i], p, 3 * sizeof(double));
        const double ww = q[0] * q[0], xx = q[1] * q[1], yy = q[2] * q[2], zz = q[3] * q[3];
        const double wx = q[0] * q[1], wy = q[0] * q[2], wz = q[0] * q[3];
        const double xy = q[1] * q[2], xz = q[1] * q[3], yz = q[2] * q[3];
        r[0] = ww + xx - yy - zz, r[1] = 2.0 * (xy - wz), r[2] = 2.0 * (xz + wy);
        r[3] = 2.0 * (xy + wz), r[4] = ww - xx + yy - zz, r[5] = 2.0 * (yz - wx);
        r[6] = 2.0 * (xz - wy), r[7] = 2.0 * (yz + wx), r[8] = ww - xx - yy + zz;
    }
}

// Runs ticks; returns their number, which is smaller if a robot does not glide.
int64_t morse_glide_ticks(const Course *course, int64_t ticks) {
    Gliders robots = *course->robots;
    robots.rotations = course->rotations;
    for (int64_t tick = 0; tick < ticks; tick++) {
        memcpy(course->positions_before, course->positions, (size_t)course->count * 3 * sizeof(double));
        memcpy(course->rotations_before, course->rotations, (size_t)course->count * 9 * sizeof(double));
        if (morse_glide_begin(&robots)) return tick;
        morse_glide_move(course->placed, course->placed->qpos, robots.velocities, robots.period);
        morse_glide_end(&robots);
        morse_glide_poses(course->placed, course->positions, course->rotations);
    }
    return ticks;
}
