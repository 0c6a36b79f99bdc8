// A tree of boxes with up to eight children per node, in single precision, rounded outward.
//
// Results do not depend on the shape of the tree: rays test the solids of a leaf exactly, and no box is too small.
#pragma once

#include <stdint.h>

#include "vector.h"

enum { WIDTH = 8, DEEPEST = 56, NO_CHILD = INT32_MIN };

// `sides[axis]` are the lower, `sides[3 + axis]` the upper bounds. A child that is not negative is a node, else
// the leaf `-1 - child`. A missing child has bounds that no ray hits.
typedef struct {
    Floats sides[6];
    int32_t children[WIDTH];
} __attribute__((aligned(32))) Node;

_Static_assert(sizeof(Node) == 224, "Python allocates nodes of that size");

// A corner of a box and the opposite one.
typedef struct {
    float low[3], high[3];
} Box;

int32_t build_tree(int32_t count, const Box *boxes, int32_t most, int32_t *members, Node *nodes, int32_t *leaves,
                   int32_t *leaf_count);
