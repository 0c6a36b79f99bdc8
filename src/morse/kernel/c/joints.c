// Rows of a batch in which motors move joints: what happens before and after the steps of the engine.
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "export.h"

// The states of N rows.
typedef struct {
    int64_t rows, size;                               // N, and the numbers of a state
    double *state, *before;                           // (N, size) at present, and before the last call
    int64_t positions, places, speeds, dofs, motors;  // first numbers in a state, and how many there are
    const int32_t *contacts;                          // (N)
    int32_t *warnings;                                // (N, W, 2)
    int64_t kinds;                                    // W
    const int64_t *most;                              // (N) numbers of contacts
    double farthest, fastest;                         // squares of the limits of all positions and speeds
    int64_t most_objects;                             // M
    const int64_t *objects;                           // (N, M) speeds of objects in a state; -1 for none
    double slip;                                      // m/s, above which an object slides
    uint8_t *going;                                   // (N) rows that take part; those that have to stop are removed
    int64_t *missed, *last;                           // (N) ticks before the last call, and those of it
    const int64_t *ticks;                             // (N) ticks before these
    const double *rates, *origins;                    // (N) Hz, s
    double *times;                                    // (N) result: s
    int64_t groups, most_free;                        // K, F
    const int64_t *free_groups, *free_places;         // (N, F) of free bodies; -1 for none
    const uint8_t *alone;                             // (N) whether their poses are to be computed
    double *at, *turned;                              // (N, K, 3), (N, K, 9) poses of all groups
    const double *lowest;                             // (N) m
    double (*normalize)(double *quaternion);          // of the engine, so that poses have its bits
    void (*matrix)(double *rotation, const double *quaternion);
} Rows;

// The setpoints of the motors of an actuator in all rows.
typedef struct {
    int64_t joints;                          // J
    double *targets, *goals, *values;        // (N, J) setpoints; within their limits; of the last tick
    double *targets_before, *values_before;  // (N, J)
    const double *low, *high, *steps;        // (N, J) limits, and what a tick changes at most
    const int64_t *channels;                 // (N, J) numbers of the motors; -1 for none
} Motors;

// Numbers of states that become data.
typedef struct {
    int64_t count;          // F
    const int64_t *places;  // (N, F) in a state; -1 for the time
    double *data;           // (N, F)
} Gathered;

MORSE_EXPORT void morse_joints_begin(const Rows *all, int64_t ticks);
MORSE_EXPORT void morse_joints_keep(const Rows *all, const Motors *motors);
MORSE_EXPORT void morse_joints_tell(const Rows *all, const Motors *motors, const int64_t *rows, int64_t count,
                                    const int64_t *fields, int64_t width, const double *values);
MORSE_EXPORT void morse_joints_act(const Rows *all, const Motors *motors);
MORSE_EXPORT void morse_joints_check(const Rows *all, int64_t is_last);
MORSE_EXPORT void morse_joints_settle(const Rows *all, int64_t ticks);
MORSE_EXPORT void morse_joints_gather(const Rows *all, const Gathered *gathered);

// Whether an object slides in the next tick, which changes its contacts.
static int slides(const Rows *all, int64_t row) {
    const int64_t *objects = all->objects + row * all->most_objects;
    for (int64_t k = 0; k < all->most_objects && objects[k] >= 0; k++) {
        const double *speed = all->state + row * all->size + objects[k];
        for (int axis = 0; axis < 3; axis++) {
            if (fabs(speed[axis]) > all->slip) return 1;
        }
    }
    return 0;
}

// Begins a call of some ticks. Rows in which an object slides are removed.
void morse_joints_begin(const Rows *all, int64_t ticks) {
    for (int64_t i = 0; i < all->rows; i++) {
        if (!all->going[i]) continue;
        all->missed[i] += all->last[i];
        all->last[i] = ticks;
        memcpy(all->before + i * all->size, all->state + i * all->size, (size_t)all->size * sizeof(double));
        all->going[i] = (uint8_t)!slides(all, i);
    }
}

// Keeps the setpoints from before a call.
void morse_joints_keep(const Rows *all, const Motors *motors) {
    const int64_t count = motors->joints;
    for (int64_t i = 0; i < all->rows; i++) {
        if (!all->going[i]) continue;
        memcpy(motors->targets_before + i * count, motors->targets + i * count, (size_t)count * sizeof(double));
        memcpy(motors->values_before + i * count, motors->values + i * count, (size_t)count * sizeof(double));
    }
}

// Takes commands (N, F) for some rows; all of them, those that go on as others.
void morse_joints_tell(const Rows *all, const Motors *motors, const int64_t *rows, int64_t count, const int64_t *fields,
                       int64_t width, const double *values) {
    for (int64_t i = 0; i < count; i++) {
        if (!all->going[rows[i]]) continue;
        for (int64_t k = 0; k < width; k++) {
            const int64_t j = rows[i] * motors->joints + fields[k];
            const double target = values[rows[i] * width + k], low = motors->low[j], high = motors->high[j];
            motors->targets[j] = target;
            motors->goals[j] = target < low ? low : target > high ? high : target;
        }
    }
}

static double next_value(double here, double goal, double step) {
    // what has no limit goes to its setpoint, so that no infinite number remains
    if (step == INFINITY) return goal;
    const double way = goal - here;
    if (-step <= way && way <= step) return goal;
    return way > 0.0 ? here + step : here - step;
}

// Moves the joints toward their setpoints by one tick.
void morse_joints_act(const Rows *all, const Motors *motors) {
    const int64_t count = motors->joints;
    for (int64_t i = 0; i < all->rows; i++) {
        const double *goals = motors->goals + i * count, *steps = motors->steps + i * count;
        double *values = motors->values + i * count, *commands = all->state + i * all->size + all->motors;
        int differs = 0;
        if (!all->going[i]) continue;
        for (int64_t j = 0; j < count; j++) differs |= goals[j] != values[j];
        // all or none, because 0.0 and -0.0 are equal
        for (int64_t j = 0; differs && j < count; j++) {
            const double value = next_value(values[j], goals[j], steps[j]);
            const int64_t channel = motors->channels[i * count + j];
            if (value != values[j] && channel >= 0) commands[channel] = value;
            values[j] = value;
        }
    }
}

static double squares(const double *numbers, int64_t count) {
    double sum = 0.0;
    for (int64_t k = 0; k < count; k++) sum += numbers[k] * numbers[k];
    return sum;
}

// Removes the rows in which something has happened that the world itself has to deal with, in this tick or, unless it
// is the last one, in the next.
void morse_joints_check(const Rows *all, int64_t is_last) {
    for (int64_t i = 0; i < all->rows; i++) {
        int32_t *warnings = all->warnings + 2 * i * all->kinds;
        int fine = 1;
        for (int64_t k = 0; k < all->kinds; k++) fine &= !warnings[2 * k + 1];
        if (!fine) memset(warnings, 0, 2 * (size_t)all->kinds * sizeof(int32_t));
        if (!all->going[i]) continue;
        const double *state = all->state + i * all->size;
        // not true of NaN
        fine &= squares(state + all->speeds, all->dofs) < all->fastest;
        fine &= squares(state + all->positions, all->places) < all->farthest;
        fine &= all->contacts[i] <= all->most[i];
        fine &= is_last || !slides(all, i);
        all->going[i] = (uint8_t)fine;
    }
}

// Ends a call: computes the poses of the free bodies and the times. Rows in which one of these has fallen out of its
// world are removed.
void morse_joints_settle(const Rows *all, int64_t ticks) {
    for (int64_t i = 0; i < all->rows; i++) {
        if (!all->going[i]) continue;
        for (int64_t k = 0; k < all->most_free; k++) {
            const int64_t group = all->free_groups[i * all->most_free + k];
            if (group < 0) break;
            double *at = all->at + 3 * (i * all->groups + group);
            if (all->alone[i]) {
                const double *joint =
                    all->state + i * all->size + all->positions + all->free_places[i * all->most_free + k];
                double quaternion[4];
                memcpy(at, joint, 3 * sizeof(double));
                memcpy(quaternion, joint + 3, sizeof quaternion);
                all->normalize(quaternion);
                all->matrix(all->turned + 9 * (i * all->groups + group), quaternion);
            }
            if (!(at[2] >= all->lowest[i])) all->going[i] = 0;
        }
        all->times[i] = all->origins[i] + (double)(all->ticks[i] + all->missed[i] + ticks) / all->rates[i];
    }
}

// Copies numbers of the states.
void morse_joints_gather(const Rows *all, const Gathered *gathered) {
    for (int64_t i = 0; i < all->rows; i++) {
        const double *state = all->state + i * all->size;
        const int64_t *places = gathered->places + i * gathered->count;
        double *data = gathered->data + i * gathered->count;
        if (!all->going[i]) continue;
        for (int64_t k = 0; k < gathered->count; k++) data[k] = places[k] < 0 ? all->times[i] : state[places[k]];
    }
}
