// Where a ray enters and leaves a primitive: the closed formulas of `tests/kernel/twins/primitives.py`, one ray at a
// time.
//
// Each operation is the same as there and in the same order, so that both give bit-identical results. Rays are given in
// the frame of the primitive, whose axis is Z. A ray that misses enters at infinity and leaves at minus infinity.
#pragma once

#include <math.h>
#include <stdint.h>

// The order of `morse.scene.ShapeKind`; meshes are not primitives.
enum { BOX, SPHERE, CYLINDER, CAPSULE, ELLIPSOID, MESH };

typedef struct {
    double enter, leave;
} Interval;

// Replaces a direction component of 0: finite quotients, no NaN.
static const double PARALLEL = 1e-200;

// Like minimum and maximum of numpy: NaN if either operand is NaN.
static inline double larger(double a, double b) { return a > b || a != a ? a : b; }
static inline double smaller(double a, double b) { return a < b || a != a ? a : b; }

static inline double dot3(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline Interval nowhere(void) { return (Interval){INFINITY, -INFINITY}; }

// The intersection of two intervals.
static inline Interval both(Interval a, Interval b) {
    const Interval r = {larger(a.enter, b.enter), smaller(a.leave, b.leave)};
    return r.enter <= r.leave ? r : nowhere();
}

// Between the two planes at plus and minus `half` along one axis.
static inline Interval slab(double origin, double direction, double half) {
    const double step = fabs(direction) < PARALLEL ? PARALLEL : direction;
    const double inverse = 1.0 / step, middle = -origin * inverse, reach = fabs(half * inverse);
    return (Interval){middle - reach, middle + reach};
}

// Around `middle`, up to the root of `rest`, over `scale`; empty if `rest` is negative.
static inline Interval ball(double middle, double rest, double scale) {
    if (!(rest >= 0.0)) return nowhere();
    const double root = sqrt(rest);
    return (Interval){(middle - root) / scale, (middle + root) / scale};
}

static inline Interval box_interval(const double *o, const double *d, const double *size) {
    const Interval yz = both(slab(o[1], d[1], size[1]), slab(o[2], d[2], size[2]));
    return both(slab(o[0], d[0], size[0]), yz);
}

static inline Interval sphere_interval(const double *o, const double *d, double radius) {
    const double middle = -dot3(o, d);
    // the foot of the perpendicular, not o^2 - r^2: at large distances, that difference loses digits
    const double foot[3] = {o[0] + d[0] * middle, o[1] + d[1] * middle, o[2] + d[2] * middle};
    return ball(middle, radius * radius - dot3(foot, foot), 1.0);
}

static inline Interval ellipsoid_interval(const double *o, const double *d, const double *size) {
    double from[3], way[3];
    for (int k = 0; k < 3; k++) way[k] = d[k] / size[k];
    const double length = sqrt(dot3(way, way));
    for (int k = 0; k < 3; k++) {
        from[k] = o[k] / size[k];
        way[k] = way[k] / length;
    }
    const Interval unit = sphere_interval(from, way, 1.0);
    return (Interval){unit.enter / length, unit.leave / length};
}

// An infinite cylinder about the Z axis.
static inline Interval tube(const double *o, const double *d, double radius) {
    const double scale = d[0] * d[0] + d[1] * d[1];
    if (scale < 1e-20) {
        const int inside = o[0] * o[0] + o[1] * o[1] <= radius * radius;
        return inside ? (Interval){-INFINITY, INFINITY} : nowhere();
    }
    // r^2 (u^2 + v^2) - (x v - y u)^2: the distance from the axis, as seen along the ray, keeps its digits
    const double side = o[0] * d[1] - o[1] * d[0];
    return ball(-(o[0] * d[0] + o[1] * d[1]), radius * radius * scale - side * side, scale);
}

static inline Interval cylinder_interval(const double *o, const double *d, const double *size) {
    return both(tube(o, d, size[0]), slab(o[2], d[2], size[1]));
}

static inline Interval capsule_interval(const double *o, const double *d, const double *size) {
    Interval r = cylinder_interval(o, d, size);
    const double ends[2] = {size[1], -size[1]};
    for (int k = 0; k < 2; k++) {
        const double from[3] = {o[0], o[1], o[2] - ends[k]};
        const Interval end = sphere_interval(from, d, size[0]);
        r.enter = smaller(r.enter, end.enter);
        r.leave = larger(r.leave, end.leave);
    }
    return r;
}

// Distance to the first surface ahead, from outside or inside; infinite if there is none.
static inline double first_surface(int32_t kind, const double *o, const double *d, const double *size) {
    Interval r;
    switch (kind) {
        case BOX:
            r = box_interval(o, d, size);
            break;
        case SPHERE:
            r = sphere_interval(o, d, size[0]);
            break;
        case CYLINDER:
            r = cylinder_interval(o, d, size);
            break;
        case CAPSULE:
            r = capsule_interval(o, d, size);
            break;
        case ELLIPSOID:
            r = ellipsoid_interval(o, d, size);
            break;
        default:
            return INFINITY;
    }
    const double distance = r.enter >= 0.0 ? r.enter : r.leave;
    // no -0.0: IEEE 754 does not define which zero a minimum returns
    return distance < 0.0 ? INFINITY : distance + 0.0;
}
