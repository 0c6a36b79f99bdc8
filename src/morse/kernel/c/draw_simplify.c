// Simplifies a mesh within a bound of its error; the twin of tests/kernel/twins/simplify.py.
//
// Vertices are moved onto neighbours, which removes two triangles each time. Before and after, the triangles around a
// vertex cover the same polygon, seen along their mean normal: the largest distance between them is at a vertex, or
// where edges cross (C. L. Bajaj and D. R. Schikore, "Error-bounded reduction of triangle meshes with multivariate
// data", 1996). Errors add up.
#include <math.h>
#include <stdint.h>

#include "drawing.h"
#include "export.h"

// Maximum number of triangles around a vertex that is removed, and of passes over all vertices.
#define MOST_AROUND 24
#define MOST_PASSES 16
// Smallest height of a new triangle, relative to its longest edge.
#define SLIVER 1e-3
// Triangles that are higher than WIDE errors keep their planes, within FLAT errors: surfaces that lie closely above
// each other remain in their order.
#define WIDE 6.0
#define FLAT 0.05
// Error of a wrong normal, relative to its difference times the size of the surface.
#define SHADE 0.25

// A mesh, and memory. A triangle has three corners; a corner has a vertex and a look, the row of its attributes.
typedef struct {
    const double (*points)[3];
    const double (*looks)[5];  // unit normal, texture coordinates
    const int32_t *slots;      // the material slot of each look
    int32_t *vertices;         // of corners
    int32_t *look;             // of corners
    double *errors;            // of triangles, m
    uint8_t *alive;            // triangles that remain
    int32_t *first, *next;     // the first corner of each vertex, and the next corner of the vertex of a corner
    uint8_t *open, *touched;   // vertices to try, and vertices whose surroundings have changed in a pass
    double limit;              // of the error, m
    int64_t vertex_count, triangle_count, textured;
} Simplification;

// The triangles around a vertex: (centre, ring j, ring j + 1).
typedef struct {
    int32_t count, corner[MOST_AROUND], ring[MOST_AROUND];
    double at[MOST_AROUND][2], height[MOST_AROUND];  // relative to the centre, along and above the mean plane
    double reach, widest, error;
} Star;

// A change of a star: the error that it adds, and the looks of the corners at the centre.
typedef struct {
    double error;
    int32_t looks[MOST_AROUND];
} Move;

MORSE_EXPORT int64_t morse_draw_simplify(Simplification *s);

static int32_t beside(int32_t corner, int by) { return corner - corner % 3 + (corner + by) % 3; }
static double dot3(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static double across(const double *a, const double *b) { return a[0] * b[1] - a[1] * b[0]; }
static double larger(double a, double b) { return a > b ? a : b; }

static void cross3(const double *a, const double *b, double *to) {
    EACH(i, 3) to[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

// Sets the corners and the ring; 0 if the triangles do not surround the vertex.
static int surround(const Simplification *s, int32_t vertex, Star *r) {
    r->count = 0;
    for (int32_t c = s->first[vertex]; c >= 0; c = s->next[c]) {
        if (!s->alive[c / 3]) continue;
        if (r->count == MOST_AROUND) return 0;
        r->corner[r->count] = c, r->ring[r->count++] = s->vertices[beside(c, 1)];
    }
    if (r->count < 3) return 0;
    // the triangle at j + 1 begins where that at j ends
    for (int j = 0; j < r->count; j++) {
        const int32_t end = s->vertices[beside(r->corner[j], 2)];
        int found = -1;
        EACH(i, r->count) {
            if (r->ring[i] != end) continue;
            if (found >= 0) return 0;
            found = i;
        }
        const int place = (j + 1) % r->count;
        if (found < 0 || (found <= j && found != place)) return 0;
        const int32_t corner = r->corner[place], ring = r->ring[place];
        r->corner[place] = r->corner[found], r->ring[place] = r->ring[found];
        r->corner[found] = corner, r->ring[found] = ring;
    }
    return 1;
}

// The height of a triangle above its longest edge, from twice its area and the squares of its edges.
static double height_of(double area, double a, double b, double c) { return area / sqrt(larger(larger(a, b), c)); }

// Projects a star along its mean normal; 0 if triangles overlap.
static int project_star(const Simplification *s, int32_t vertex, Star *r) {
    double apart[MOST_AROUND][3], normal[3] = {0, 0, 0}, x[3], y[3], most = 0;
    const double *centre = s->points[vertex];
    EACH(j, r->count) {
        EACH(i, 3) apart[j][i] = s->points[r->ring[j]][i] - centre[i];
        most = larger(most, dot3(apart[j], apart[j]));
    }
    r->reach = sqrt(most), r->widest = r->error = 0;
    EACH(j, r->count) {
        double area[3];
        cross3(apart[j], apart[(j + 1) % r->count], area);
        EACH(i, 3) normal[i] += area[i];
        r->error = larger(r->error, s->errors[r->corner[j] / 3]);
    }
    const double length = sqrt(dot3(normal, normal));
    if (!(length > 0)) return 0;
    EACH(i, 3) normal[i] /= length;
    int least = 0;
    for (int i = 1; i < 3; i++) least = fabs(normal[i]) < fabs(normal[least]) ? i : least;
    const double axis[3] = {least == 0, least == 1, least == 2};
    cross3(axis, normal, x);
    const double size = sqrt(dot3(x, x));
    EACH(i, 3) x[i] /= size;
    cross3(normal, x, y);
    EACH(j, r->count) {
        r->at[j][0] = dot3(apart[j], x), r->at[j][1] = dot3(apart[j], y), r->height[j] = dot3(apart[j], normal);
    }
    EACH(j, r->count) {
        const double *a = r->at[j], *b = r->at[(j + 1) % r->count], d[2] = {b[0] - a[0], b[1] - a[1]};
        const double area = across(a, b);
        if (!(area > 0)) return 0;
        r->widest = larger(r->widest, height_of(area, a[0] * a[0] + a[1] * a[1], b[0] * b[0] + b[1] * b[1],
                                                d[0] * d[0] + d[1] * d[1]));
    }
    return 1;
}

// Whether the mesh remains a surface when the centre moves onto a vertex of the ring.
static int keeps_surface(const Simplification *s, const Star *r, int32_t centre, int m) {
    const int k = r->count, before = (m + k - 1) % k, after = (m + 1) % k;
    for (int32_t c = s->first[r->ring[m]]; c >= 0; c = s->next[c]) {
        const int32_t a = s->vertices[beside(c, 1)], b = s->vertices[beside(c, 2)];
        if (!s->alive[c / 3] || a == centre || b == centre) continue;
        int shared = 0;
        EACH(j, k) {
            if (r->ring[j] != a && r->ring[j] != b) continue;
            if (j != before && j != after) return 0;
            shared++;
        }
        if (shared == 2 && k == 3) return 0;
    }
    return 1;
}

// The distance between two normals.
static double turn(const double *a, const double *b) {
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return sqrt(dot3(d, d));
}

// How far borders between materials, or between pieces of a texture, move when the centre moves onto vertex `m`.
static double error_of_borders(const Simplification *s, const Star *r, int m) {
    const int k = r->count;
    const double *to = r->at[m], away = sqrt(to[0] * to[0] + to[1] * to[1] + r->height[m] * r->height[m]);
    int borders = 0, along = 0, other = m;
    EACH(j, k) {
        const int32_t a = s->look[r->corner[j]], b = s->look[r->corner[(j + k - 1) % k]];
        if (s->textured ? a == b : s->slots[a] == s->slots[b]) continue;
        borders++;
        if (j == m)
            along = 1;
        else
            other = j;
    }
    if (!borders) return 0;
    if (borders != 2 || !along) return away;
    // a border from the vertex through the centre to another vertex becomes straight
    const double d[2] = {r->at[other][0] - to[0], r->at[other][1] - to[1]};
    return fabs(across(to, r->at[other])) / sqrt(d[0] * d[0] + d[1] * d[1]);
}

// Sets the new looks of the corners at the centre; returns the error of those that have no counterpart.
static double choose_looks(const Simplification *s, const Star *r, int m, Move *move) {
    const int k = r->count, before = (m + k - 1) % k;
    const int32_t ends[2] = {r->corner[m], r->corner[before]};
    const int32_t old[2] = {s->look[ends[0]], s->look[ends[1]]};
    const int32_t new[2] = {s->look[beside(ends[0], 1)], s->look[beside(ends[1], 2)]};
    const double *at = r->at[m], away = sqrt(at[0] * at[0] + at[1] * at[1] + r->height[m] * r->height[m]);
    double error = 0;
    EACH(j, k) {
        const int32_t own = move->looks[j] = s->look[r->corner[j]];
        if (j == m || j == before) continue;
        if (own == old[0] || own == old[1]) {
            move->looks[j] = own == old[0] ? new[0] : new[1];
            continue;
        }
        double least = away;
        EACH(n, 2) {
            if (s->textured || s->slots[own] != s->slots[old[n]]) continue;
            const double here = SHADE * turn(s->looks[own], s->looks[old[n]]) * r->reach;
            least = here < least ? here : least;
        }
        error = larger(error, least);
    }
    return error;
}

// The error of the attributes at the centre in the triangle at j that covers it, from its weights.
static double error_of_look(const Simplification *s, const Star *r, int j, const Move *move, const double *weight) {
    const int32_t c = r->corner[j], from[3] = {move->looks[j], s->look[beside(c, 1)], s->look[beside(c, 2)]};
    const double *own = s->looks[s->look[c]], *a = s->looks[from[1]], *b = s->looks[from[2]];
    double mean[5];
    if (from[0] == s->look[c]) return 0;
    EACH(i, 5) mean[i] = weight[0] * s->looks[from[0]][i] + weight[1] * a[i] + weight[2] * b[i];
    const double length = sqrt(dot3(mean, mean));
    if (!(length > 0)) return INFINITY;
    EACH(i, 3) mean[i] /= length;
    const double error = SHADE * turn(mean, own) * r->reach;
    if (!s->textured) return error;
    const double *p = r->at[j], *q = r->at[(j + 1) % r->count], d[2] = {q[0] - p[0], q[1] - p[1]};
    const double u[2] = {b[3] - a[3], b[4] - a[4]}, v[2] = {mean[3] - own[3], mean[4] - own[4]};
    const double whole = u[0] * u[0] + u[1] * u[1], part = v[0] * v[0] + v[1] * v[1];
    if (!(whole > 0)) return part > 0 ? INFINITY : error;
    return larger(error, sqrt(part * (d[0] * d[0] + d[1] * d[1]) / whole));
}

// The largest distance between both surfaces where an old edge crosses a new one.
static double error_of_edges(const Star *r, int m) {
    const int k = r->count, before = (m + k - 1) % k, after = (m + 1) % k;
    const double *from = r->at[m];
    double error = 0;
    EACH(j, k) {
        if (j == m || j == before || j == after) continue;
        const double d[2] = {r->at[j][0] - from[0], r->at[j][1] - from[1]}, over = across(from, d);
        EACH(i, k) {
            const double under = across(r->at[i], d);
            if (i == m || i == j || under == 0) continue;
            const double a = over / under, b = across(from, r->at[i]) / under;
            if (!(a > 0 && a < 1 && b > 0 && b < 1)) continue;
            const double apart = a * r->height[i] - (r->height[m] + b * (r->height[j] - r->height[m]));
            error = larger(error, fabs(apart));
        }
    }
    return error;
}

// The error that a star gets when its centre moves onto vertex `m` of its ring; infinite if it must not.
static void try_move(const Simplification *s, const Star *r, int32_t centre, int m, Move *move) {
    const int k = r->count, before = (m + k - 1) % k;
    const double *to = r->at[m];
    double error = INFINITY, widest = r->widest, weight[3] = {0, 0, 0};
    int over = -1;
    move->error = INFINITY;
    EACH(j, k) {
        if (j == m || j == before) continue;
        const int n = (j + 1) % k;
        const double *a = r->at[j], *b = r->at[n], p[2] = {a[0] - to[0], a[1] - to[1]};
        const double q[2] = {b[0] - to[0], b[1] - to[1]}, d[2] = {b[0] - a[0], b[1] - a[1]}, area = across(p, q);
        const double height =
            height_of(area, p[0] * p[0] + p[1] * p[1], q[0] * q[0] + q[1] * q[1], d[0] * d[0] + d[1] * d[1]);
        if (!(area > 0 && height * height > SLIVER * area)) return;
        widest = larger(widest, height);
        const double w[3] = {across(a, b), across(b, to), across(to, a)};
        if (over >= 0 || w[1] < 0 || w[2] < 0) continue;
        over = j;
        EACH(i, 3) weight[i] = w[i] / area;
        error = fabs(weight[0] * r->height[m] + weight[1] * r->height[j] + weight[2] * r->height[n]);
    }
    const double flat = widest > WIDE * s->limit ? FLAT * s->limit : s->limit;
    if (over < 0 || !(error <= flat) || !(r->error + error <= s->limit) || !keeps_surface(s, r, centre, m)) return;
    error = larger(error, error_of_edges(r, m));
    if (!(error <= flat)) return;
    error = larger(error, error_of_borders(s, r, m));
    error = larger(error, choose_looks(s, r, m, move));
    error = larger(error, error_of_look(s, r, over, move, weight));
    if (r->error + error <= s->limit) move->error = error;
}

static void apply(Simplification *s, const Star *r, int32_t centre, int m, const Move *move) {
    const int k = r->count, before = (m + k - 1) % k;
    EACH(j, k) {
        const int32_t c = r->corner[j], vertex = r->ring[m];
        s->open[r->ring[j]] = s->touched[r->ring[j]] = 1;
        s->errors[c / 3] = r->error + move->error;
        if (j == m || j == before)
            s->alive[c / 3] = 0;
        else
            s->vertices[c] = vertex, s->look[c] = move->looks[j], s->next[c] = s->first[vertex], s->first[vertex] = c;
    }
    s->first[centre] = -1;
}

// Moves a vertex onto the neighbour where the error is smallest; 0 if there is none.
static int remove_vertex(Simplification *s, int32_t vertex) {
    Star r;
    Move best = {.error = INFINITY}, move;
    int onto = -1;
    if (!surround(s, vertex, &r) || !project_star(s, vertex, &r)) return 0;
    EACH(m, r.count) {
        try_move(s, &r, vertex, m, &move);
        if (move.error < best.error) best = move, onto = m;
    }
    if (onto < 0) return 0;
    apply(s, &r, vertex, onto, &best);
    return 1;
}

// Simplifies a mesh up to a limit of the error; returns the number of triangles that remain. The next call, with a
// larger limit, goes on.
int64_t morse_draw_simplify(Simplification *s) {
    int64_t left = 0, changes = 1;
    for (int64_t v = 0; v < s->vertex_count; v++) s->first[v] = -1, s->open[v] = 1;
    for (int64_t c = 3 * s->triangle_count - 1; c >= 0; c--) {
        if (!s->alive[c / 3]) continue;
        s->next[c] = s->first[s->vertices[c]], s->first[s->vertices[c]] = (int32_t)c;
    }
    for (int pass = 0; pass < MOST_PASSES && changes; pass++) {
        changes = 0;
        for (int64_t v = 0; v < s->vertex_count; v++) s->touched[v] = 0;
        for (int32_t v = 0; v < s->vertex_count; v++) {
            if (s->first[v] < 0 || !s->open[v] || s->touched[v]) continue;
            if (remove_vertex(s, v))
                changes++;
            else
                s->open[v] = 0;
        }
    }
    for (int64_t t = 0; t < s->triangle_count; t++) left += s->alive[t];
    return left;
}
