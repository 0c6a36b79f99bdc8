// Bones, the objects attached to them, and the collision shapes of these objects; the twin of
// `tests/kernel/twins/linkage.py`.
#include <math.h>
#include <stdint.h>

#include "export.h"

enum { FIXED, REVOLUTE, PRISMATIC };

typedef struct {
    int64_t bones;
    const int64_t *parents, *kinds, *axes;  // (B)
    const double *places, *turns;           // (B, 3), (B, 9) at joint value 0
    const double *moves;                    // (B, 2) cosine and sine of revolute joints; value of prismatic ones
    double *frames;                         // (B, 12) result: position and rotation
    int64_t objects;
    const int64_t *outers, *hooks;              // (N) outer object, or -1; bone, or -1
    const double *held;                         // (N, 12) in the frame of the bone, or of the outer object
    double *locals, *poses;                     // (N, 12) results: in the frame of the outer object, of the body
    int64_t shapes;                             // S shapes
    const int64_t *geoms, *owners;              // (S)
    const double *mounts;                       // (S, 12) in the frame of the owner
    double *geom_positions, *geom_quaternions;  // of the engine
    const double *geom_radii, *geom_boxes;      // of the engine; boxes: (G, 6) centre and half sizes
    int64_t all_shapes;
    const int64_t *all_geoms;  // of the body
    const double *base;        // (12) of the armature in the body
    const double *up;          // (3) of the world, in the frame of the body
    double reach, lowest;      // results
} Linkage;

MORSE_EXPORT void morse_linkage(Linkage *all);

static void product(const double *a, const double *b, double *out) {
    for (int i = 0; i < 9; i += 3)
        for (int j = 0; j < 3; j++) out[i + j] = a[i] * b[j] + a[i + 1] * b[j + 3] + a[i + 2] * b[j + 6];
}

static void compose(const double *outer, const double *inner, double *out) {
    const double *r = outer + 3;
    const double x = inner[0], y = inner[1], z = inner[2];
    for (int i = 0; i < 3; i++) out[i] = outer[i] + (r[3 * i] * x + r[3 * i + 1] * y + r[3 * i + 2] * z);
    product(r, inner + 3, out + 3);
}

static int differ(const double *a, const double *b, int count) {
    for (int i = 0; i < count; i++) {
        const double d = a[i] - b[i];
        if (!(-1e-14 <= d && d <= 1e-14)) return 1;
    }
    return 0;
}

static const double NOWHERE[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};

static void move_bone(const Linkage *all, int64_t i) {
    const double *outer = all->parents[i] < 0 ? NOWHERE : all->frames + 12 * all->parents[i];
    double inner[12], *frame = all->frames + 12 * i;
    for (int k = 0; k < 3; k++) inner[k] = all->places[3 * i + k];
    for (int k = 0; k < 9; k++) inner[3 + k] = all->turns[9 * i + k];
    compose(outer, inner, frame);
    const int64_t axis = all->axes[i];
    double *r = frame + 3;
    if (all->kinds[i] == PRISMATIC) {
        for (int k = 0; k < 3; k++) frame[k] = frame[k] + all->moves[2 * i] * r[axis + 3 * k];
    } else if (all->kinds[i] == REVOLUTE) {
        const double c = all->moves[2 * i], s = all->moves[2 * i + 1];
        const int64_t one = (axis + 1) % 3, other = (axis + 2) % 3;
        for (int row = 0; row < 9; row += 3) {
            const double a = r[row + one], b = r[row + other];
            r[row + one] = c * a + s * b;
            r[row + other] = c * b - s * a;
        }
    }
}

static void quaternion(const double *r, double *q) {
    const double trace = r[0] + r[4] + r[8];
    if (trace > 0.0) {
        const double s = 2.0 * sqrt(trace + 1.0);
        q[0] = 0.25 * s, q[1] = (r[7] - r[5]) / s, q[2] = (r[2] - r[6]) / s, q[3] = (r[3] - r[1]) / s;
    } else if (r[0] > r[4] && r[0] > r[8]) {
        const double s = 2.0 * sqrt(1.0 + r[0] - r[4] - r[8]);
        q[0] = (r[7] - r[5]) / s, q[1] = 0.25 * s, q[2] = (r[1] + r[3]) / s, q[3] = (r[2] + r[6]) / s;
    } else if (r[4] > r[8]) {
        const double s = 2.0 * sqrt(1.0 + r[4] - r[0] - r[8]);
        q[0] = (r[2] - r[6]) / s, q[1] = (r[1] + r[3]) / s, q[2] = 0.25 * s, q[3] = (r[5] + r[7]) / s;
    } else {
        const double s = 2.0 * sqrt(1.0 + r[8] - r[0] - r[4]);
        q[0] = (r[3] - r[1]) / s, q[1] = (r[2] + r[6]) / s, q[2] = (r[5] + r[7]) / s, q[3] = 0.25 * s;
    }
}

static void place_object(const Linkage *all, int64_t i) {
    const double *held = all->held + 12 * i;
    double *local = all->locals + 12 * i, *pose = all->poses + 12 * i;
    if (all->hooks[i] < 0)
        for (int k = 0; k < 12; k++) local[k] = held[k];
    else
        compose(all->frames + 12 * all->hooks[i], held, local);
    compose(all->outers[i] < 0 ? all->base : all->poses + 12 * all->outers[i], local, pose);
    // as in `Mounting.of`: a pose equal to that of the body within rounding errors is replaced by it
    if (!differ(pose + 3, NOWHERE + 3, 9) && !differ(pose, NOWHERE, 3))
        for (int k = 0; k < 12; k++) pose[k] = NOWHERE[k];
}

// Moves everything to the values of the joints.
void morse_linkage(Linkage *all) {
    for (int64_t i = 0; i < all->bones; i++) move_bone(all, i);
    for (int64_t i = 0; i < all->objects; i++) place_object(all, i);
    all->lowest = INFINITY;
    for (int64_t i = 0; i < all->shapes; i++) {
        double placed[12], *p = all->geom_positions + 3 * all->geoms[i];
        compose(all->poses + 12 * all->owners[i], all->mounts + 12 * i, placed);
        for (int k = 0; k < 3; k++) p[k] = placed[k];
        quaternion(placed + 3, all->geom_quaternions + 4 * all->geoms[i]);
        const double *r = placed + 3, *up = all->up, *box = all->geom_boxes + 6 * all->geoms[i];
        double height = up[0] * p[0] + up[1] * p[1] + up[2] * p[2];
        for (int k = 0; k < 3; k++) {
            const double along = up[0] * r[k] + up[1] * r[k + 3] + up[2] * r[k + 6];
            height = height + along * box[k] - fabs(along) * box[k + 3];
        }
        if (height < all->lowest) all->lowest = height;
    }
    all->reach = 0.0;
    for (int64_t i = 0; i < all->all_shapes; i++) {
        const double *p = all->geom_positions + 3 * all->all_geoms[i];
        const double far = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) + all->geom_radii[all->all_geoms[i]];
        if (far > all->reach) all->reach = far;
    }
}
