// Sine and cosine, bit-identical on all platforms: sums and products only, as in `tests/kernel/twins/driving.py`.
#pragma once

#include <math.h>

#define TWO_OVER_PI 0.63661977236758134308
// pi/2 in three parts; the product of the first part and a number below 2^20 is exact
#define HALF_PI_1 0x1.921fb544p+0
#define HALF_PI_2 0x1.0b4611a6p-34
#define HALF_PI_3 0x1.3198a2e037073p-69

typedef struct {
    double cosine, sine;
} Turn;

static inline Turn turn_by(double angle) {
    angle += 0.0;  // no negative zero
    const double quarters = rint(angle * TWO_OVER_PI);
    const double x = ((angle - quarters * HALF_PI_1) - quarters * HALF_PI_2) - quarters * HALF_PI_3;
    const double z = x * x;
    // Taylor series; within an eighth of a turn, the next terms are below the last bit
    double s = 1.0 - z / 272.0;
    s = 1.0 - z / 210.0 * s;
    s = 1.0 - z / 156.0 * s;
    s = 1.0 - z / 110.0 * s;
    s = 1.0 - z / 72.0 * s;
    s = 1.0 - z / 42.0 * s;
    s = 1.0 - z / 20.0 * s;
    s = x - x * (z / 6.0 * s);
    double c = 1.0 - z / 306.0;
    c = 1.0 - z / 240.0 * c;
    c = 1.0 - z / 182.0 * c;
    c = 1.0 - z / 132.0 * c;
    c = 1.0 - z / 90.0 * c;
    c = 1.0 - z / 56.0 * c;
    c = 1.0 - z / 30.0 * c;
    c = 1.0 - z / 12.0 * c;
    c = 1.0 - z / 2.0 * c;
    const double odd = quarters - 4.0 * floor(quarters / 4.0);
    if (odd == 1.0) return (Turn){-s, c};
    if (odd == 2.0) return (Turn){-c, -s};
    if (odd == 3.0) return (Turn){s, -c};
    return (Turn){c, s};
}

// Turns the velocity (x, y) into the chord of an arc; returns cosine and sine of half the turning angle.
static inline Turn arc(double *x, double *y, double half) {
    if (!(fabs(half) > 1e-9)) return (Turn){1.0, 0.0};
    const Turn turn = turn_by(half);
    const double chord = turn.sine / half, before = *x;
    *x = chord * (turn.cosine * *x - turn.sine * *y);
    *y = chord * (turn.sine * before + turn.cosine * *y);
    return turn;
}
