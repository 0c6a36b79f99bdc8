// Builds a tree of boxes by the surface area heuristic with bins (Wald 2007).
#include <math.h>
#include <stdint.h>

#include "export.h"
#include "tree.h"

enum { BINS = 16, HALVED_FROM = 24 };

typedef struct {
    const Box *boxes;
    int32_t *members;  // indices of boxes, sorted during the build
    Node *nodes;
    int32_t *leaves;  // (leaves, most) indices of boxes, -1 for none
    int32_t node_count, leaf_count, most;
} Builder;

typedef struct {
    int32_t first, count;
    Box bounds;
} Range;

MORSE_EXPORT int32_t morse_tree_build(int32_t count, const Box *boxes, int32_t most, int32_t *members, Node *nodes,
                                      int32_t *leaves, int32_t *leaf_count);

static Box nothing(void) { return (Box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}}; }

static void include(Box *box, const Box *other) {
    for (int k = 0; k < 3; k++) {
        box->low[k] = other->low[k] < box->low[k] ? other->low[k] : box->low[k];
        box->high[k] = other->high[k] > box->high[k] ? other->high[k] : box->high[k];
    }
}

// Half of the surface; 0 for an empty box.
static float surface(const Box *box) {
    const float x = box->high[0] - box->low[0], y = box->high[1] - box->low[1], z = box->high[2] - box->low[2];
    return x < 0.0f ? 0.0f : x * y + y * z + z * x;
}

static float middle(const Box *box, int axis) { return 0.5f * box->low[axis] + 0.5f * box->high[axis]; }

static Box bounds_of(const Builder *b, int32_t first, int32_t count) {
    Box bounds = nothing();
    for (int32_t i = first; i < first + count; i++) include(&bounds, b->boxes + b->members[i]);
    return bounds;
}

static int bin_of(const Box *box, int axis, float low, float scale) {
    const float place = (middle(box, axis) - low) * scale;
    // written so that NaN gives a bin, too
    if (!(place > 0.0f)) return 0;
    return place < (float)BINS ? (int)place : BINS - 1;
}

typedef struct {
    int axis, bin;
    float low, scale;
} Cut;

// The cheapest split between two bins; the axis is -1 if there is none.
static Cut cheapest_cut(const Builder *b, const Range *range) {
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int32_t i = range->first; i < range->first + range->count; i++) {
        for (int k = 0; k < 3; k++) {
            const float at = middle(b->boxes + b->members[i], k);
            low[k] = at < low[k] ? at : low[k];
            high[k] = at > high[k] ? at : high[k];
        }
    }
    Cut best = {-1, 0, 0.0f, 0.0f};
    float least = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        const float extent = high[axis] - low[axis];
        if (!(extent > 0.0f) || !isfinite((float)BINS / extent)) continue;
        const float scale = (float)BINS / extent;
        Box bins[BINS];
        int32_t counts[BINS] = {0};
        for (int k = 0; k < BINS; k++) bins[k] = nothing();
        for (int32_t i = range->first; i < range->first + range->count; i++) {
            const Box *box = b->boxes + b->members[i];
            const int bin = bin_of(box, axis, low[axis], scale);
            include(bins + bin, box);
            counts[bin]++;
        }
        float costs[BINS];
        Box side = nothing();
        int32_t seen = 0;
        for (int k = BINS - 1; k > 0; k--) {
            include(&side, bins + k);
            seen += counts[k];
            costs[k] = surface(&side) * (float)seen;
        }
        side = nothing();
        seen = 0;
        for (int k = 1; k < BINS; k++) {
            include(&side, bins + k - 1);
            seen += counts[k - 1];
            const float cost = surface(&side) * (float)seen + costs[k];
            if (seen > 0 && seen < range->count && cost < least) {
                least = cost;
                best = (Cut){axis, k, low[axis], scale};
            }
        }
    }
    return best;
}

// Partitions the boxes of a range, and returns the number of boxes in the first part.
static int32_t divide(const Builder *b, const Range *range, int halve) {
    const Cut cut = halve ? (Cut){-1, 0, 0.0f, 0.0f} : cheapest_cut(b, range);
    if (cut.axis < 0) return range->count / 2;
    int32_t left = range->first, right = range->first + range->count - 1;
    while (left <= right) {
        const int32_t member = b->members[left];
        if (bin_of(b->boxes + member, cut.axis, cut.low, cut.scale) < cut.bin) {
            left++;
        } else {
            b->members[left] = b->members[right];
            b->members[right--] = member;
        }
    }
    return left - range->first;
}

static int32_t make_leaf(Builder *b, const Range *range) {
    int32_t *leaf = b->leaves + (int64_t)b->leaf_count * b->most;
    for (int32_t k = 0; k < b->most; k++) leaf[k] = k < range->count ? b->members[range->first + k] : -1;
    return -1 - b->leaf_count++;
}

static int32_t make_node(Builder *b, const Range *whole, int depth) {
    Range ranges[WIDTH] = {*whole};
    int count = 1;
    while (count < WIDTH) {
        int largest = -1;
        for (int k = 0; k < count; k++) {
            if (ranges[k].count <= b->most) continue;
            if (largest < 0 || surface(&ranges[k].bounds) > surface(&ranges[largest].bounds)) largest = k;
        }
        if (largest < 0) break;
        Range *one = ranges + largest, *other = ranges + count++;
        const int32_t left = divide(b, one, depth >= HALVED_FROM);
        *other = (Range){one->first + left, one->count - left, nothing()};
        one->count = left;
        one->bounds = bounds_of(b, one->first, one->count);
        other->bounds = bounds_of(b, other->first, other->count);
    }
    const int32_t number = b->node_count++;
    Node *node = b->nodes + number;
    for (int k = 0; k < WIDTH; k++) {
        const Box bounds = k < count ? ranges[k].bounds : nothing();
        for (int axis = 0; axis < 3; axis++) {
            node->sides[axis][k] = bounds.low[axis];
            node->sides[3 + axis][k] = bounds.high[axis];
        }
        node->children[k] = NO_CHILD;
    }
    for (int k = 0; k < count; k++) {
        const int32_t child =
            ranges[k].count <= b->most ? make_leaf(b, ranges + k) : make_node(b, ranges + k, depth + 1);
        node->children[k] = child;
    }
    return number;
}

// Builds a tree over `count` boxes with at most `most` of them in a leaf, and returns the number of its nodes, 0 if it
// is empty: boxes that are not finite or inverted are left out.
//
// The caller provides memory for `count` members, max(count - 1, 1) nodes and (count, most) indices in leaves.
int32_t build_tree(int32_t count, const Box *boxes, int32_t most, int32_t *members, Node *nodes, int32_t *leaves,
                   int32_t *leaf_count) {
    Builder b = {boxes, members, nodes, leaves, 0, 0, most};
    int32_t good = 0;
    for (int32_t i = 0; i < count; i++) {
        int fits = 1;
        for (int k = 0; k < 3; k++) {
            const float low = boxes[i].low[k], high = boxes[i].high[k];
            fits &= low <= high && isfinite(low) && isfinite(high);
        }
        if (fits) members[good++] = i;
    }
    *leaf_count = 0;
    if (good == 0) return 0;
    const Range all = {0, good, bounds_of(&b, 0, good)};
    make_node(&b, &all, 0);
    *leaf_count = b.leaf_count;
    return b.node_count;
}

int32_t morse_tree_build(int32_t count, const Box *boxes, int32_t most, int32_t *members, Node *nodes, int32_t *leaves,
                         int32_t *leaf_count) {
    return build_tree(count, boxes, most, members, nodes, leaves, leaf_count);
}
