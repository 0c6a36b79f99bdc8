// Robots that are driven together over the ground, as `morse/kernel/driving.py` defines them.
#pragma once

#include <stdint.h>

enum { LEFT_OUT = 0, GLIDES = 1, TURNS = 2, SHIFTS = 4 };

typedef struct {
    int64_t count;                             // N robots
    const int64_t *slots;                      // (N)
    const double *forward, *aside, *rate;      // (N) commands, m/s and rad/s in the axes of the robot
    const uint8_t *shifts;                     // (N) 1: moved without momentum
    const uint8_t *ground;                     // (N) 1: keeps its vertical speed, its roll and pitch rates
    const int64_t *dofs;                       // (K) address of the velocity
    const double *speeds, *margins, *extents;  // (K) limits of gliding; a negative speed: no gliding
    const uint8_t *plain;                      // (K) 1: nothing else changes the commands of the robot
    const uint8_t *free;                       // (K) 1: a body with six degrees of freedom
    const uint8_t *sliding;                    // (K) 1: driven in the last tick
    const int32_t *trees, *asleep;             // (K) its tree or -1; (T) 0 or more for a sleeping tree
    const double *rotations, *positions;       // (K, 9), (K, 3)
    double period;                             // s
    const uint8_t *able;                       // (K) 1: may glide
    int64_t *ticks;                            // (K) stances: their tick
    const int64_t *until;                      // (K) first tick in which the robot may glide
    double *heights, *ups;                     // (K), (K, 3) stances
    double *velocities;                        // of the engine
    uint8_t *done;                             // (N) result, for `morse_glide_end`
    double *cosines, *sines;                   // (N) results
    int64_t *others;                           // (N) result: rows that have to be driven separately
    int64_t *settled;                          // (N) result: rows that have settled and may glide
    int64_t settled_count;                     // result
} Gliders;
