// A ray in the form for tests with the boxes of a tree.
#pragma once

#include <math.h>

#include "tree.h"

typedef struct {
    double origin[3], direction[3];
} Ray;

// The ray in single precision, so that no box that the ray hits is missed: `origin_up` is an upper bound of the
// origin, `origin_down` a lower bound, and WIDER covers the rounding of four operations.
typedef struct {
    float near_origin[3], far_origin[3], inverse[3];
    int near_side[3], far_side[3];  // rows of `Node.sides`
} Slopes;

#define WIDER 1.000001f
#define FARTHEST 1e37f

static inline float limited(double x) {
    return x > (double)FARTHEST ? FARTHEST : x < -(double)FARTHEST ? -FARTHEST : (float)x;
}

static inline Slopes slopes_of(const Ray *ray) {
    Slopes s;
    for (int k = 0; k < 3; k++) {
        const float at = limited(ray->origin[k]), slack = fabsf(at) * 0x1p-22f + 1e-30f;
        const float d = limited(ray->direction[k]);
        // neither zero nor infinite: their product would be NaN, and missing children would be hit
        s.inverse[k] = 1.0f / (fabsf(d) < 1e-30f ? copysignf(1e-30f, d) : d);
        const int back = s.inverse[k] < 0.0f;
        s.near_side[k] = back ? 3 + k : k;
        s.far_side[k] = back ? k : 3 + k;
        s.near_origin[k] = back ? at - slack : at + slack;
        s.far_origin[k] = back ? at + slack : at - slack;
    }
    return s;
}

// The distance for tests with boxes: an upper bound of `limit`.
static inline float rounded_up(double limit) { return limited(limit) * WIDER; }

// The children of a node that a ray hits within a distance, and where it enters them.
static inline uint32_t met_children(const Node *node, const Slopes *s, float limit, Floats *enter) {
    Floats in = EACH(Floats, 0.0f), out = EACH(Floats, limit);
    for (int k = 0; k < 3; k++) {
        const Floats near = (node->sides[s->near_side[k]] - s->near_origin[k]) * s->inverse[k];
        const Floats far = (node->sides[s->far_side[k]] - s->far_origin[k]) * s->inverse[k];
        in = CHOSEN(near > in, near, in);
        out = CHOSEN(far < out, far, out);
    }
    *enter = in;
    const Ints met = in <= out * WIDER;
    return bits8(&met);
}

typedef struct {
    int32_t child;
    float enter;
} Waiting;

enum { MOST_WAITING = DEEPEST * (WIDTH - 1) + WIDTH };

// Visits the leaves that a ray hits, the nearest first. `visit` may lower `*limit`; it is inlined.
static inline __attribute__((always_inline)) void walk(const Node *nodes, const Slopes *s, const double *limit,
                                                       void (*visit)(void *, int32_t), void *what) {
    Waiting stack[MOST_WAITING];
    int32_t child = 0;
    int waiting = 0;
    float end = rounded_up(*limit);
    for (;;) {
        if (child >= 0) {
            Floats enter;
            const Node *node = nodes + child;
            uint32_t met = met_children(node, s, end, &enter);
            if (met) {
                const int first = __builtin_ctz(met);
                met &= met - 1;
                child = node->children[first];
                if (!met) continue;
                // the nearest child is next; the others are pushed, the nearest of them on top
                float nearest = enter[first];
                const int bottom = waiting;
                do {
                    const int k = __builtin_ctz(met);
                    met &= met - 1;
                    Waiting next = {node->children[k], enter[k]};
                    if (next.enter < nearest) {
                        const Waiting other = {child, nearest};
                        child = next.child;
                        nearest = next.enter;
                        next = other;
                    }
                    int place = waiting++;
                    for (; place > bottom && stack[place - 1].enter < next.enter; place--)
                        stack[place] = stack[place - 1];
                    stack[place] = next;
                } while (met);
                continue;
            }
        } else {
            visit(what, -1 - child);
            end = rounded_up(*limit);
        }
        do {
            if (waiting == 0) return;
            waiting--;
        } while (stack[waiting].enter > end);
        child = stack[waiting].child;
    }
}
