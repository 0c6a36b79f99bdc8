// Where a ray enters and leaves a primitive: the closed formulas of `tests/kernel/twins/primitives.py`, for one ray,
// and for four rays at once.
//
// Each operation is the same as there and in the same order, so that all give bit-identical results. Rays are given in
// the frame of the primitive, whose axis is Z. A ray that misses enters at infinity and leaves at minus infinity.
#pragma once

#include <math.h>
#include <stdint.h>

#include "vector.h"

// The order of `morse.scene.ShapeKind`; meshes are not primitives.
enum { BOX, SPHERE, CYLINDER, CAPSULE, ELLIPSOID, MESH };

// Replaces a direction component of 0: finite quotients, no NaN.
static const double PARALLEL = 1e-200;

#define NUMBER double
#define HOLDS int
#define OF(name) name
#define PICK(holds, a, b) ((holds) ? (a) : (b))
#define ANY(holds) (holds)
#define ALL(holds) (holds)
#define ROOT(a) sqrt(a)
#define SIZE(a) fabs(a)
#define ALIKE(value) (value)
#include "intervals.h"
#undef NUMBER
#undef HOLDS
#undef OF
#undef PICK
#undef ANY
#undef ALL
#undef ROOT
#undef SIZE
#undef ALIKE

static inline Doubles picked4(Longs holds, Doubles a, Doubles b) {
    return (Doubles)(((Longs)a & holds) | ((Longs)b & ~holds));
}

static inline Doubles root4(Doubles a) {
    Doubles root;
    for (int k = 0; k < 4; k++) root[k] = sqrt(a[k]);
    return root;
}

static inline Doubles size4(Doubles a) { return (Doubles)((Longs)a & INT64_MAX); }

#define NUMBER Doubles
#define HOLDS Longs
#define OF(name) name##4
#define PICK(holds, a, b) picked4(holds, a, b)
#define ANY(holds) (bits4(&(holds)) != 0)
#define ALL(holds) (bits4(&(holds)) == 15)
#define ROOT(a) root4(a)
#define SIZE(a) size4(a)
#define ALIKE(value) EACH(Doubles, value)
#include "intervals.h"
