// The robots of a world that glide for several ticks; see glide_ticks.c.
#pragma once

#include <stdint.h>

#include "export.h"
#include "gliders.h"

// Functions of the engine: mj_integratePos, mj_kinematics.
typedef void (*Integrate)(const void *model, double *qpos, const double *qvel, double period);
typedef void (*Kinematics)(const void *model, void *data);

typedef struct {
    const Gliders *robots;
    const void *model;
    void *data;
    Integrate integrate;
    Kinematics kinematics;
    double *qpos;                                 // of the engine
    const double *positions, *rotations;          // (K, 3), (K, 9) of the engine: bodies that move
    double *positions_before, *rotations_before;  // results: the same at the beginning of the last tick
    int64_t count;                                // K
} Course;

MORSE_EXPORT int64_t morse_glide_ticks(const Course *course, int64_t ticks);
