// Where rays enter and leave primitives: closed formulas, which `primitives.h` includes for one ray, and for four at
// once.
//
// Before, it defines: NUMBER, numbers of that many rays; HOLDS, what is true of them; OF(name), the names of functions;
// PICK(holds, a, b); ANY and ALL of what holds; ROOT and SIZE of numbers; ALIKE(value) for all rays.

typedef struct {
    NUMBER enter, leave;
} OF(Interval);

// Like minimum and maximum of numpy: NaN if either operand is NaN.
static inline NUMBER OF(larger)(NUMBER a, NUMBER b) { return PICK((a > b) | (a != a), a, b); }
static inline NUMBER OF(smaller)(NUMBER a, NUMBER b) { return PICK((a < b) | (a != a), a, b); }

static inline NUMBER OF(dot3)(const NUMBER *a, const NUMBER *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline OF(Interval) OF(nowhere)(void) { return (OF(Interval)){ALIKE(INFINITY), ALIKE(-INFINITY)}; }

// An interval where something holds.
static inline OF(Interval) OF(where)(HOLDS holds, OF(Interval) a) {
    return (OF(Interval)){PICK(holds, a.enter, ALIKE(INFINITY)), PICK(holds, a.leave, ALIKE(-INFINITY))};
}

// The intersection of two intervals.
static inline OF(Interval) OF(both)(OF(Interval) a, OF(Interval) b) {
    const OF(Interval) r = {OF(larger)(a.enter, b.enter), OF(smaller)(a.leave, b.leave)};
    return OF(where)(r.enter <= r.leave, r);
}

// Between the two planes at plus and minus `half` along one axis.
static inline OF(Interval) OF(slab)(NUMBER origin, NUMBER direction, double half) {
    const NUMBER step = PICK(SIZE(direction) < PARALLEL, ALIKE(PARALLEL), direction);
    const NUMBER inverse = 1.0 / step, middle = -origin * inverse, reach = SIZE(half * inverse);
    return (OF(Interval)){middle - reach, middle + reach};
}

// Around `middle`, up to the root of `rest`, over `scale`; empty if `rest` is negative.
static inline OF(Interval) OF(ball)(NUMBER middle, NUMBER rest, NUMBER scale) {
    const HOLDS met = rest >= 0.0;
    if (!ANY(met)) return OF(nowhere)();
    const NUMBER root = ROOT(rest);
    return OF(where)(met, (OF(Interval)){(middle - root) / scale, (middle + root) / scale});
}

static inline OF(Interval) OF(box_interval)(const NUMBER *o, const NUMBER *d, const double *size) {
    const OF(Interval) yz = OF(both)(OF(slab)(o[1], d[1], size[1]), OF(slab)(o[2], d[2], size[2]));
    return OF(both)(OF(slab)(o[0], d[0], size[0]), yz);
}

static inline OF(Interval) OF(sphere_interval)(const NUMBER *o, const NUMBER *d, double radius) {
    const NUMBER middle = -OF(dot3)(o, d);
    // the foot of the perpendicular, not o^2 - r^2: at large distances, that difference loses digits
    const NUMBER foot[3] = {o[0] + d[0] * middle, o[1] + d[1] * middle, o[2] + d[2] * middle};
    const NUMBER rest = radius * radius - OF(dot3)(foot, foot);
    const HOLDS met = rest >= 0.0;
    if (!ANY(met)) return OF(nowhere)();
    const NUMBER root = ROOT(rest);
    return OF(where)(met, (OF(Interval)){middle - root, middle + root});
}

static inline OF(Interval) OF(ellipsoid_interval)(const NUMBER *o, const NUMBER *d, const double *size) {
    NUMBER from[3], way[3];
    for (int k = 0; k < 3; k++) way[k] = d[k] / size[k];
    const NUMBER length = ROOT(OF(dot3)(way, way));
    for (int k = 0; k < 3; k++) {
        from[k] = o[k] / size[k];
        way[k] = way[k] / length;
    }
    const OF(Interval) unit = OF(sphere_interval)(from, way, 1.0);
    return (OF(Interval)){unit.enter / length, unit.leave / length};
}

// An infinite cylinder about the Z axis.
static inline OF(Interval) OF(tube)(const NUMBER *o, const NUMBER *d, double radius) {
    const NUMBER scale = d[0] * d[0] + d[1] * d[1];
    const HOLDS along = scale < 1e-20, inside = o[0] * o[0] + o[1] * o[1] <= radius * radius;
    const OF(Interval) whole = OF(where)(inside, (OF(Interval)){ALIKE(-INFINITY), ALIKE(INFINITY)});
    if (ALL(along)) return whole;
    // r^2 (u^2 + v^2) - (x v - y u)^2: the distance from the axis, as seen along the ray, keeps its digits
    const NUMBER side = o[0] * d[1] - o[1] * d[0];
    const OF(Interval) r = OF(ball)(-(o[0] * d[0] + o[1] * d[1]), radius * radius * scale - side * side, scale);
    return (OF(Interval)){PICK(along, whole.enter, r.enter), PICK(along, whole.leave, r.leave)};
}

static inline OF(Interval) OF(cylinder_interval)(const NUMBER *o, const NUMBER *d, const double *size) {
    return OF(both)(OF(tube)(o, d, size[0]), OF(slab)(o[2], d[2], size[1]));
}

static inline OF(Interval) OF(capsule_interval)(const NUMBER *o, const NUMBER *d, const double *size) {
    OF(Interval) r = OF(cylinder_interval)(o, d, size);
    const double ends[2] = {size[1], -size[1]};
    for (int k = 0; k < 2; k++) {
        const NUMBER from[3] = {o[0], o[1], o[2] - ends[k]};
        const OF(Interval) end = OF(sphere_interval)(from, d, size[0]);
        r.enter = OF(smaller)(r.enter, end.enter);
        r.leave = OF(larger)(r.leave, end.leave);
    }
    return r;
}

// Distance to the first surface ahead, from outside or inside; infinite if there is none.
static inline NUMBER OF(first_surface)(int32_t kind, const NUMBER *o, const NUMBER *d, const double *size) {
    OF(Interval) r;
    switch (kind) {
        case BOX:
            r = OF(box_interval)(o, d, size);
            break;
        case SPHERE:
            r = OF(sphere_interval)(o, d, size[0]);
            break;
        case CYLINDER:
            r = OF(cylinder_interval)(o, d, size);
            break;
        case CAPSULE:
            r = OF(capsule_interval)(o, d, size);
            break;
        case ELLIPSOID:
            r = OF(ellipsoid_interval)(o, d, size);
            break;
        default:
            return ALIKE(INFINITY);
    }
    const NUMBER distance = PICK(r.enter >= 0.0, r.enter, r.leave);
    // no -0.0: IEEE 754 does not define which zero a minimum returns
    return PICK(distance < 0.0, ALIKE(INFINITY), distance + 0.0);
}
