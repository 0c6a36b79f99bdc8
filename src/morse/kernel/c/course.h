// The robots of a world that glide; see glide_ticks.c.
#pragma once

#include <stdint.h>

#include "export.h"
#include "gliders.h"

// Their places in the arrays of the engine and of the world.
typedef struct {
    int64_t count;                 // M robots that glide
    const int64_t *places, *dofs;  // (M) addresses of their coordinates and velocities in the engine
    const int64_t *slots;          // (M) their rows among the poses of the world
    double *qpos;                  // coordinates of the engine
} Placed;

typedef struct {
    const Gliders *robots;
    const Placed *placed;
    double *positions, *rotations;                // (K, 3), (K, 9) results: the poses of all bodies that move
    double *positions_before, *rotations_before;  // results: the same at the beginning of the last tick
    int64_t count;                                // K
} Course;

MORSE_EXPORT void morse_glide_move(const Placed *all, const double *from, const double *velocities, double period);
MORSE_EXPORT void morse_glide_poses(const Placed *all, double *positions, double *rotations);
MORSE_EXPORT int64_t morse_glide_ticks(const Course *course, int64_t ticks);
