// Attributes of the surfaces at samples.
#pragma once
#include "draw_looks.h"

// The interpolated attributes of a triangle, from the cache or computed.
static const Planes *planes_of(const Frame *f, Planes *cache, int32_t who) {
    Planes *p = cache + (who & (MOST_PLANES - 1));
    if (p->who == who) return p;
    const Seen *s = f->seen + who;
    const Part *part = f->parts + s->part;
    const Vertex *base = f->vertices + f->clusters[part->cluster].vertex;
    const int32_t *c = f->triangles[s->triangle];
    const Vertex *v[3] = {base + c[0], base + c[1], base + c[2]};
    const float *turn = f->turns[part->instance], facing = s->back ? -1.0f : 1.0f;
    float n[3][3];
    EACH(a, 3) EACH(b, 3) {
        const float *row = turn + 3 * b;
        n[a][b] = (row[0] * v[a]->n[0] + row[1] * v[a]->n[1] + row[2] * v[a]->n[2]) * facing;
    }
    EACH(a, 3) {
        EACH(b, 3) p->normal[b][a] = s->e[0][a] * n[0][b] + s->e[1][a] * n[1][b] + s->e[2][a] * n[2][b];
        EACH(b, 2) p->uv[b][a] = s->e[0][a] * v[0]->uv[b] + s->e[1][a] * v[1]->uv[b] + s->e[2][a] * v[2]->uv[b];
        p->whole[a] = s->e[0][a] + s->e[1][a] + s->e[2][a];
    }
    p->who = who;
    return p;
}

// Eight samples without a surface; positions and shares are set already.
static inline void look_at_nothing(Looks *l) {
    l->nx = l->ny = l->r = l->g = l->b = l->er = l->eg = l->eb = l->metallic = splat(0);
    l->nz = l->inverse = l->roughness = splat(1);
    l->none = l->texture = splat_int(-1), l->plain = splat_int(0);
}

// Eight samples of the same triangle.
static inline void look_at_triangle(const Frame *f, Planes *cache, Looks *l, int32_t who) {
    const Surface *m = f->materials + f->seen[who].material;
    const Planes *p = planes_of(f, cache, who);
    const F8 x = l->x, y = l->y;
    l->inverse = at_points(f->seen[who].w, x, y);
    l->nx = at_points(p->normal[0], x, y), l->ny = at_points(p->normal[1], x, y), l->nz = at_points(p->normal[2], x, y);
    l->r = splat(m->color[0]), l->g = splat(m->color[1]), l->b = splat(m->color[2]);
    l->er = splat(m->emission[0]), l->eg = splat(m->emission[1]), l->eb = splat(m->emission[2]);
    l->metallic = splat(m->metallic), l->roughness = splat(m->roughness);
    l->none = splat_int(0), l->plain = splat_int(m->flags & SHADELESS ? -1 : 0), l->texture = splat_int(m->texture);
    if (m->texture < 0) return;
    const F8 w = 1 / at_points(p->whole, x, y), u = at_points(p->uv[0], x, y) * w, v = at_points(p->uv[1], x, y) * w;
    l->u = u, l->ux = (p->uv[0][0] - u * p->whole[0]) * w, l->uy = (p->uv[0][1] - u * p->whole[1]) * w;
    l->v = v, l->vx = (p->uv[1][0] - v * p->whole[0]) * w, l->vy = (p->uv[1][1] - v * p->whole[1]) * w;
}

// One sample, in a lane.
static inline void look_at(const Frame *f, Planes *cache, Looks *l, int j, float x, float y, int32_t who) {
    l->x[j] = x, l->y[j] = y;
    if (who < 0) {
        l->nx[j] = l->ny[j] = l->r[j] = l->g[j] = l->b[j] = l->er[j] = l->eg[j] = l->eb[j] = l->metallic[j] = 0;
        l->nz[j] = l->inverse[j] = l->roughness[j] = 1;
        l->none[j] = l->texture[j] = -1, l->plain[j] = 0;
        return;
    }
    const Surface *m = f->materials + f->seen[who].material;
    const Planes *p = planes_of(f, cache, who);
    l->inverse[j] = at_point(f->seen[who].w, x, y);
    l->nx[j] = at_point(p->normal[0], x, y), l->ny[j] = at_point(p->normal[1], x, y);
    l->nz[j] = at_point(p->normal[2], x, y);
    l->r[j] = m->color[0], l->g[j] = m->color[1], l->b[j] = m->color[2];
    l->er[j] = m->emission[0], l->eg[j] = m->emission[1], l->eb[j] = m->emission[2];
    l->metallic[j] = m->metallic, l->roughness[j] = m->roughness;
    l->none[j] = 0, l->plain[j] = m->flags & SHADELESS ? -1 : 0, l->texture[j] = m->texture;
    if (m->texture < 0) return;
    const float w = 1 / at_point(p->whole, x, y), u = at_point(p->uv[0], x, y) * w, v = at_point(p->uv[1], x, y) * w;
    l->u[j] = u, l->ux[j] = (p->uv[0][0] - u * p->whole[0]) * w, l->uy[j] = (p->uv[0][1] - u * p->whole[1]) * w;
    l->v[j] = v, l->vx[j] = (p->uv[1][0] - v * p->whole[0]) * w, l->vy[j] = (p->uv[1][1] - v * p->whole[1]) * w;
}
