// The forces of water on the box of a vessel; the twin of `tests/kernel/twins/water.py`.
#include <math.h>
#include <stdint.h>

#include "export.h"

typedef struct {
    double cells[8][3];                   // middles of the parts of the box, in the frame of the body
    double swell[4], rise[4];             // surface above the calm one and its speed, for each column of two cells
    double centre[3], drag[3];            // of the box; force over the square of the speed along each axis
    double depth, half;                   // of the surface above the origin; half the height of the box
    double lift, most, bob;               // N per cell; kg/s; kg/s of a cell at the surface
    double up[3], linear[3], angular[3];  // in the frame of the body
    double force[3], torque[3];           // results
} Water;

MORSE_EXPORT void morse_water(Water *all);

static double resisted(double part, double speed, double drag, double most) {
    const double rate = fabs(speed) * drag;
    return part * speed * (most < rate ? most : rate);
}

void morse_water(Water *all) {
    const double *up = all->up, *v = all->linear, *w = all->angular, *m = all->centre;
    double fx = 0.0, fy = 0.0, fz = 0.0, tx = 0.0, ty = 0.0, tz = 0.0;
    for (int i = 0; i < 8; i++) {
        double x = all->cells[i][0], y = all->cells[i][1], z = all->cells[i][2];
        double share = (all->depth + all->swell[i / 2] - up[0] * x - up[1] * y - up[2] * z) / all->half + 0.5;
        share = share < 0.0 ? 0.0 : share > 1.0 ? 1.0 : share;
        const double part = -share / 8.0;
        const double sx = v[0] + w[1] * z - w[2] * y, sy = v[1] + w[2] * x - w[0] * z, sz = v[2] + w[0] * y - w[1] * x;
        const double rise = up[0] * sx + up[1] * sy + up[2] * sz - all->rise[i / 2];
        // a part at the surface makes waves
        const double pushed = all->lift * share - (0.0 < share && share < 1.0 ? all->bob * rise : 0.0);
        const double a = resisted(part, sx, all->drag[0], all->most) + pushed * up[0];
        const double b = resisted(part, sy, all->drag[1], all->most) + pushed * up[1];
        const double c = resisted(part, sz, all->drag[2], all->most) + pushed * up[2];
        fx += a, fy += b, fz += c;
        // the force acts at the centre of mass, approximated by the centre of the box
        x -= m[0], y -= m[1], z -= m[2];
        tx = tx + y * c - z * b, ty = ty + z * a - x * c, tz = tz + x * b - y * a;
    }
    all->force[0] = fx, all->force[1] = fy, all->force[2] = fz;
    all->torque[0] = tx, all->torque[1] = ty, all->torque[2] = tz;
}
