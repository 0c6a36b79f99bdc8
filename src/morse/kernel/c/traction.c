// Traction of robots on driven wheels; the twin of `tests/kernel/twins/driving.py`.
#include <math.h>
#include <stdint.h>

#include "export.h"
#include "turns.h"

typedef struct {
    int64_t count;                               // N robots
    const int64_t *first;                        // (N + 1) index of the first wheel of each robot
    const int64_t *geoms, *motors;               // (W) of the wheels
    const double *radii, *levers;                // (W)
    const int64_t *slots, *dofs;                 // (N)
    const double *axles, *frictions, *turnings;  // (N)
    const uint8_t *driven;                       // (N) 1: commanded as bodies
    int64_t pairs;                               // contacts
    const int32_t *touching;                     // (C, 2) geoms
    uint8_t *touched;                            // (G) scratch
    const double *controls, *rotations;          // of the engine; (K, 9)
    double period, gravity, creep;
    double *velocities;   // of the engine
    int32_t *dimensions;  // (G) of contacts
} Chassis;

MORSE_EXPORT void morse_traction(const Chassis *all);

static void pull(const Chassis *all, int64_t i) {
    const int64_t first = all->first[i], wheels = all->first[i + 1] - first;
    double speed = 0.0, rate = 0.0, share = 0.0;
    for (int64_t k = first; k < first + wheels; k++) {
        const double tread = all->controls[all->motors[k]] * all->radii[k];
        speed += tread;
        rate += tread * all->levers[k];
        share += all->touched[all->geoms[k]];
    }
    speed /= (double)wheels;
    share /= (double)wheels;
    const double *r = all->rotations + 9 * all->slots[i];
    double *v = all->velocities + all->dofs[i];
    const double ahead = r[0] * v[0] + r[3] * v[1] + r[6] * v[2];
    const double beside = r[1] * v[0] + r[4] * v[1] + r[7] * v[2];
    const double turning = v[5];
    const int stands =
        speed == 0.0 && rate == 0.0 && sqrt(ahead * ahead + beside * beside) < all->creep && fabs(turning) < all->creep;
    for (int64_t k = first; k < first + wheels; k++) all->dimensions[all->geoms[k]] = stands ? 3 : 1;
    if (stands || share == 0.0) return;
    // the axle moves straight ahead, as seen along the heading in the middle of the tick
    const Turn turn = turn_by(0.5 * rate * all->period);
    const double side = -rate * all->axles[i];
    // half of what the slope takes away within the tick is added in advance
    const double slope = 0.5 * all->period * all->gravity;
    double along = turn.cosine * speed - turn.sine * side - ahead + slope * r[6];
    double across = turn.sine * speed + turn.cosine * side - beside + slope * r[7];
    const double budget = all->frictions[i] * all->gravity * fabs(r[8]) * share * all->period;
    const double needed = sqrt(along * along + across * across);
    if (needed > budget) {
        along = along * budget / needed;
        across = across * budget / needed;
    }
    const double limit = budget * all->turnings[i];
    double change = rate - turning;
    if (change < -limit) change = -limit;
    if (change > limit) change = limit;
    v[0] += r[0] * along + r[1] * across;
    v[1] += r[3] * along + r[4] * across;
    v[2] += r[6] * along + r[7] * across;
    v[5] = turning + change;
}

// Moves the velocities of all robots closer to those of their treads.
void morse_traction(const Chassis *all) {
    for (int64_t k = 0; k < all->first[all->count]; k++) all->touched[all->geoms[k]] = 0;
    for (int64_t k = 0; k < 2 * all->pairs; k++)
        if (all->touching[k] >= 0) all->touched[all->touching[k]] = 1;
    for (int64_t i = 0; i < all->count; i++)
        if (!all->driven[i]) pull(all, i);
}
