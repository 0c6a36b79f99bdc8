// Whether the shadow of a part is out of sight of all cameras: it is then not drawn into the map of the sun.
//
// A shadow is everything behind a part, seen from the sun. It is beside an image if the part is, and if the light leads
// away from the image.
#pragma once
#include <math.h>

#include "drawing.h"

// With more cameras, most shadows are in sight of one of them.
#define MOST_VIEWS 16
#define SIDES 5
// Texels around a part for which its shadow is read: offsets along normals, the texels around a point, and the rounding
// errors.
#define SHADOW_MARGIN 12.0
// Smallest sine of the angle between the light and a side of an image, which is larger than its rounding error.
#define LEAST_ANGLE 1e-4

// The sides of an image from which the light leads away: their normals, which point into the image, and their offsets.
// They are shifted by the margin.
typedef struct {
    double side[SIDES][4];
    int count;
} View;

static inline View view_of(const Camera *k, const float *sun) {
    const float *r = k->axes;
    const double factors[SIDES][4] = {{k->fx, 0, k->cx, 0},
                                      {-k->fx, 0, (double)k->width - k->cx, 0},
                                      {0, k->fy, k->cy, 0},
                                      {0, -k->fy, (double)k->height - k->cy, 0},
                                      {0, 0, 1, -k->near}};
    View v = {.count = 0};
    EACH(n, SIDES) {
        double *side = v.side[v.count], square = 0, away = 0;
        side[3] = factors[n][3];
        EACH(i, 3) {
            side[i] = factors[n][0] * r[i] + factors[n][1] * r[3 + i] + factors[n][2] * r[6 + i];
            square += side[i] * side[i], away += side[i] * sun[8 + i], side[3] -= side[i] * k->eye[i];
        }
        const double length = sqrt(square);
        side[3] += length * SHADOW_MARGIN * sun[12];
        v.count += away > length * LEAST_ANGLE;
    }
    return v;
}

// The images in which shadows may be seen; returns their number, or -1 if shadows are in sight everywhere.
static inline int views_of(const Frame *f, View *to) {
    int count = 0;
    if (!f->camera_count || f->camera_count > MOST_VIEWS) return -1;
    EACH(c, f->camera_count) if (f->cameras[c].color) to[count++] = view_of(f->cameras + c, f->sun);
    return count;
}

// Whether the shadow of a box at a model is beside an image.
static inline int is_shadow_beside(const View *v, const float *m, const float *box) {
    EACH(n, v->count) {
        const double *s = v->side[n];
        double most = s[0] * m[3] + s[1] * m[7] + s[2] * m[11] + s[3];
        EACH(i, 3) {
            const double a = s[0] * m[i] + s[1] * m[4 + i] + s[2] * m[8 + i];
            most += a * (double)box[a > 0 ? i + 3 : i];
        }
        if (most < 0) return 1;
    }
    return 0;
}

static inline int is_out_of_sight(const View *views, int count, const float *m, const float *box) {
    if (count < 0) return 0;
    EACH(n, count) if (!is_shadow_beside(views + n, m, box)) return 0;
    return 1;
}
