// Attributes of the surfaces at samples.
#pragma once
#include <string.h>

#include "draw_looks.h"

// The attributes of a vertex, with the normal in the world.
static inline F8 attributes_of(const Vertex *v, F8 x, F8 y, F8 z, float facing) {
    F8 a = (x * v->n[0] + y * v->n[1] + z * v->n[2]) * facing;
    a[TEXTURE_U] = v->uv[0], a[TEXTURE_V] = v->uv[1], a[WHOLE] = 1;
    return a;
}

// The planes of a triangle.
static inline Planes planes_of(const Frame *f, const Seen *s) {
    const Part *part = f->parts + s->part;
    const Vertex *base = f->vertices + f->clusters[part->cluster].vertex;
    const int32_t *c = f->triangles[s->triangle];
    const float *t = f->turns[part->instance], facing = s->back ? -1.0f : 1.0f;
    const F8 x = {t[0], t[3], t[6]}, y = {t[1], t[4], t[7]}, z = {t[2], t[5], t[8]};
    F8 corner[3];
    EACH(i, 3) corner[i] = attributes_of(base + c[i], x, y, z, facing);
    Planes p;
    F8 *plane[3] = {&p.across, &p.down, &p.start};
    EACH(i, 3) {
        *plane[i] = s->e[0][i] * corner[0] + s->e[1][i] * corner[1] + s->e[2][i] * corner[2];
        (*plane[i])[INVERSE] = s->w[i];
    }
    return p;
}

// Eight samples of the same material.
static inline void set_surface(Looks *l, const Surface *m) {
    l->r = splat(m->color[0]), l->g = splat(m->color[1]), l->b = splat(m->color[2]);
    l->er = splat(m->emission[0]), l->eg = splat(m->emission[1]), l->eb = splat(m->emission[2]);
    l->metallic = splat(m->metallic), l->roughness = splat(m->roughness);
    l->plain = splat_int(m->flags & SHADELESS ? -1 : 0), l->texture = splat_int(m->texture);
    l->hazed = splat_int(m->flags & HAZED ? -1 : 0), l->fine = splat_int(m->flags & FINE ? -1 : 0);
}

// Scales and shifts texture coordinates.
static inline void map_texture(Looks *l, const F8 *by) {
    l->u = l->u * by[0] + by[2], l->ux *= by[0], l->uy *= by[0];
    l->v = l->v * by[1] + by[3], l->vx *= by[1], l->vy *= by[1];
}

// Eight samples of the same triangle.
static inline void look_at_triangle(const Frame *f, Looks *l, const Planes *p, int32_t material) {
    const Surface *m = f->materials + material;
    const F8 x = l->x, y = l->y;
    l->inverse = at_points(p, INVERSE, x, y);
    l->nx = at_points(p, NORMAL_X, x, y), l->ny = at_points(p, NORMAL_Y, x, y), l->nz = at_points(p, NORMAL_Z, x, y);
    set_surface(l, m);
    if (m->texture < 0) return;
    const F8 w = 1 / at_points(p, WHOLE, x, y), u = at_points(p, TEXTURE_U, x, y) * w,
             v = at_points(p, TEXTURE_V, x, y) * w;
    l->u = u, l->ux = (p->across[TEXTURE_U] - u * p->across[WHOLE]) * w,
    l->uy = (p->down[TEXTURE_U] - u * p->down[WHOLE]) * w;
    l->v = v, l->vx = (p->across[TEXTURE_V] - v * p->across[WHOLE]) * w,
    l->vy = (p->down[TEXTURE_V] - v * p->down[WHOLE]) * w;
    if (!f->maps) return;
    F8 by[4];
    EACH(i, 4) by[i] = splat(f->maps[material][i]);
    map_texture(l, by);
}

// Rows become columns.
static inline void transpose(const F8 *from, F8 *to) {
    F8 a[LANES], b[LANES];
    EACH(i, 4) {
        a[2 * i] = __builtin_shufflevector(from[2 * i], from[2 * i + 1], 0, 8, 1, 9, 4, 12, 5, 13);
        a[2 * i + 1] = __builtin_shufflevector(from[2 * i], from[2 * i + 1], 2, 10, 3, 11, 6, 14, 7, 15);
    }
    EACH(i, 2) EACH(k, 2) {
        b[4 * i + 2 * k] = __builtin_shufflevector(a[4 * i + k], a[4 * i + k + 2], 0, 1, 8, 9, 4, 5, 12, 13);
        b[4 * i + 2 * k + 1] = __builtin_shufflevector(a[4 * i + k], a[4 * i + k + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    }
    EACH(i, 4) {
        to[i] = __builtin_shufflevector(b[i], b[i + 4], 0, 1, 2, 3, 8, 9, 10, 11);
        to[i + 4] = __builtin_shufflevector(b[i], b[i + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    }
}

// The materials of eight samples.
static inline void set_surfaces(const Frame *f, Looks *l, const int32_t *materials) {
    const Surface *m[LANES];
    int same = 1;
    EACH_LANE(j) same &= materials[j] == materials[0];
    EACH_LANE(j) m[j] = f->materials + materials[j];
    if (same) {
        set_surface(l, m[0]);
        return;
    }
    F8 rows[LANES], columns[LANES];
    // colour with opacity, emission, and metallic, which are in this order in memory
    EACH_LANE(j) memcpy(rows + j, m[j], sizeof rows[j]);
    transpose(rows, columns);
    l->r = columns[0], l->g = columns[1], l->b = columns[2];
    l->er = columns[4], l->eg = columns[5], l->eb = columns[6], l->metallic = columns[7];
    // roughness, texture and flags
    F4 others[LANES];
    F8 last[4];
    EACH_LANE(j) memcpy(others + j, &m[j]->roughness, sizeof others[j]);
    columns_of(others, last);
    l->roughness = last[0], l->texture = bits_of(last[1]), l->plain = (bits_of(last[2]) & SHADELESS) != 0;
    l->hazed = (bits_of(last[2]) & HAZED) != 0, l->fine = (bits_of(last[2]) & FINE) != 0;
}

// Eight samples of different triangles.
static inline void look_at_samples(const Frame *f, Looks *l, const Planes *const *planes, const int32_t *materials,
                                   int textured) {
    F8 rows[LANES], at[LANES], across[LANES], down[LANES];
    EACH_LANE(j) rows[j] = at_point(planes[j], l->x[j], l->y[j]);
    transpose(rows, at);
    l->inverse = at[INVERSE], l->nx = at[NORMAL_X], l->ny = at[NORMAL_Y], l->nz = at[NORMAL_Z];
    set_surfaces(f, l, materials);
    if (!textured) return;
    EACH_LANE(j) rows[j] = planes[j]->across;
    transpose(rows, across);
    EACH_LANE(j) rows[j] = planes[j]->down;
    transpose(rows, down);
    const F8 w = 1 / at[WHOLE], u = at[TEXTURE_U] * w, v = at[TEXTURE_V] * w;
    l->u = u, l->ux = (across[TEXTURE_U] - u * across[WHOLE]) * w, l->uy = (down[TEXTURE_U] - u * down[WHOLE]) * w;
    l->v = v, l->vx = (across[TEXTURE_V] - v * across[WHOLE]) * w, l->vy = (down[TEXTURE_V] - v * down[WHOLE]) * w;
    if (!f->maps) return;
    F4 by[LANES];
    F8 columns[4];
    EACH_LANE(j) memcpy(by + j, f->maps + materials[j], sizeof by[j]);
    columns_of(by, columns);
    map_texture(l, columns);
}
