// A tree of boxes with up to eight children a node, in single precision, rounded outward.
//
// What a tree holds is found whatever its form: rays test what is in a leaf exactly, and the boxes are never too small.
#pragma once

#include <stdint.h>

#include "vector.h"

enum { WIDTH = 8, DEEPEST = 56, NO_CHILD = INT32_MIN };

// `sides[axis]` are the lower, `sides[3 + axis]` the upper bounds. A child that is not negative is a node, else it is
// the leaf `-1 - child`. A child that is not there has bounds that no ray meets.
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
