// Ticks in which nothing happens but that robots glide over a level floor.
#include <stdint.h>
#include <string.h>

#include "course.h"
#include "glide.h"

// Runs ticks, in each the functions that Python calls in a tick; returns their number, 0 if a robot does not glide.
int64_t morse_glide_ticks(const Course *course, int64_t ticks) {
    Gliders robots = *course->robots;
    robots.rotations = course->rotations;
    for (int64_t tick = 0; tick < ticks; tick++) {
        memcpy(course->positions_before, course->positions, (size_t)course->count * 3 * sizeof(double));
        memcpy(course->rotations_before, course->rotations, (size_t)course->count * 9 * sizeof(double));
        if (morse_glide_begin(&robots)) return tick;
        course->integrate(course->model, course->qpos, robots.velocities, robots.period);
        morse_glide_end(&robots);
        course->kinematics(course->model, course->data);
    }
    return ticks;
}
