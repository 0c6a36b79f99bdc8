// Attributes of the surfaces at samples.
#pragma once
#include "draw_looks.h"

static inline void look_at_nothing(Looks *l, int k) {
    l->nx[k] = l->ny[k] = l->r[k] = l->g[k] = l->b[k] = l->er[k] = l->eg[k] = l->eb[k] = l->metallic[k] = 0;
    l->nz[k] = l->inverse[k] = l->roughness[k] = 1;
    l->plain[k] = 0, l->texture[k] = -1;
}

static inline void look_at_texture(Looks *l, int k, const float uv[2][3], const float whole_plane[3]) {
    const float x = l->x[k], y = l->y[k], w = 1 / (whole_plane[0] * x + whole_plane[1] * y + whole_plane[2]);
    const float u = (uv[0][0] * x + uv[0][1] * y + uv[0][2]) * w, v = (uv[1][0] * x + uv[1][1] * y + uv[1][2]) * w;
    l->u[k] = u, l->ux[k] = (uv[0][0] - u * whole_plane[0]) * w, l->uy[k] = (uv[0][1] - u * whole_plane[1]) * w;
    l->v[k] = v, l->vx[k] = (uv[1][0] - v * whole_plane[0]) * w, l->vy[k] = (uv[1][1] - v * whole_plane[1]) * w;
}

// The interpolated attributes of a triangle, from the cache or computed.
static inline const Planes *planes_of(const Frame *f, Looks *l, int32_t who) {
    Planes *p = l->planes + (who & (MOST_PLANES - 1));
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

// Interpolated once for each run of samples with the same triangle.
static inline void look_at_surfaces(const Frame *f, Looks *l, int count) {
    for (int i = 0, end; i < count; i = end) {
        const int32_t who = l->who[i];
        for (end = i + 1; end < count && l->who[end] == who; end++) {
        }
        if (who < 0) {
            for (int k = i; k < end; k++) look_at_nothing(l, k);
            continue;
        }
        const Planes p = *planes_of(f, l, who);
        const Surface m = f->materials[f->seen[who].material];
        const float *given = f->seen[who].w, w[3] = {given[0], given[1], given[2]};
        const int32_t plain = m.flags & SHADELESS ? -1 : 0;
        for (int k = i; k < end; k++) {
            const float x = l->x[k], y = l->y[k];
            l->inverse[k] = w[0] * x + w[1] * y + w[2];
            l->nx[k] = p.normal[0][0] * x + p.normal[0][1] * y + p.normal[0][2];  // not normalised
            l->ny[k] = p.normal[1][0] * x + p.normal[1][1] * y + p.normal[1][2];
            l->nz[k] = p.normal[2][0] * x + p.normal[2][1] * y + p.normal[2][2];
            l->r[k] = m.color[0], l->g[k] = m.color[1], l->b[k] = m.color[2];
            l->er[k] = m.emission[0], l->eg[k] = m.emission[1], l->eb[k] = m.emission[2];
            l->metallic[k] = m.metallic, l->roughness[k] = m.roughness;
            l->plain[k] = plain, l->texture[k] = m.texture;
        }
        if (m.texture < 0) continue;
        for (int k = i; k < end; k++) look_at_texture(l, k, p.uv, p.whole);
    }
}
