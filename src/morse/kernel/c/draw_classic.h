// The look of MuJoCo's own renderer, the fixed pipeline of OpenGL: light is computed at the corners of triangles, each
// light with shadows by itself, and added up without gamma correction.
#pragma once
#include <math.h>

#include "draw_light.h"
#include "draw_looks.h"
#include "draw_surface.h"
#include "draw_texture.h"
#include "drawing.h"
#include "simd.h"

// The light at the corners of a triangle, and its edges, which are its barycentric coordinates.
typedef struct {
    float e[3][3], lights[3][2 * LANES];
} Corners;

_Static_assert(CORNER_LIGHTS <= 2 * LANES, "the lights of a corner are read as two groups");

// The smallest number whose logarithm is computed.
#define LEAST_COSINE 1e-20f

// The light at eight points with unit normals: of the lights that cast no shadows and of each light that does. As in
// the passes of OpenGL, each of these is limited to 1.
static ALWAYS_INLINE void light_points(const Frame *f, const Camera *k, const Looks *l, V3 color, V3 *lights) {
    const V3 view = unit(difference(everywhere(k->eye), l->place));
    const F8 zero = splat(0), one = splat(1), least = splat(LEAST_COSINE);
    const int shines = any(l->metallic > zero);
    lights[0] = (V3){l->er, l->eg, l->eb};
    for (int i = 1; i <= MOST_SHADOWS; i++) lights[i] = grey(0);
    EACH(j, f->classic->light_count) {
        const ClassicLight *m = f->classic_lights + j;
        V3 way = everywhere(m->towards);
        F8 share = one, shine = zero;
        if (!m->directional) {
            way = (V3){m->place[0] - l->place.x, m->place[1] - l->place.y, m->place[2] - l->place.z};
            const F8 far = root(dot(way, way));
            const float *a = m->attenuation;
            way = scaled(way, 1 / greater(far, splat(1e-12f)));
            const F8 fall = a[0] + far * (a[1] + far * a[2]);
            share = pick(fall > splat(1e-9f), 1 / fall, zero);
            if (m->cutoff > -1) {
                const F8 cosine = dot(way, everywhere(m->towards));
                const I8 out = cosine < splat(m->cutoff);
                share = pick(out, zero, m->exponent > 0 ? share * power(greater(cosine, least), m->exponent) : share);
            }
        }
        const F8 facing = greater(dot(l->normal, way), zero);
        if (shines && any(facing > zero)) {
            const F8 both = greater(dot(l->normal, unit(sum(way, view))), least);
            shine = pick(facing > zero, l->metallic * powers(both, l->roughness), zero);
        }
        const V3 diffuse = sum(everywhere(m->ambient), scaled(everywhere(m->diffuse), facing));
        const V3 light = sum(product(diffuse, color), scaled(everywhere(m->specular), shine));
        lights[m->number] = sum(lights[m->number], scaled(light, share));
    }
    EACH(i, 1 + MOST_SHADOWS)
    lights[i] = (V3){lesser(lights[i].x, one), lesser(lights[i].y, one), lesser(lights[i].z, one)};
}

// The corners of a triangle in four lanes, of which the last one is that of the first.
typedef struct {
    F4 place[3], normal[3];
} Lanes;

static inline Lanes lanes_in(const Frame *f, const Seen *s) {
    const Part *part = f->parts + s->part;
    const Vertex *base = f->vertices + f->clusters[part->cluster].vertex;
    const int32_t *index = f->triangles[s->triangle];
    const float *m = f->models[part->instance], *t = f->turns[part->instance], facing = s->back ? -1.0f : 1.0f;
    F4 p[3], n[3];
    EACH(j, 4) {
        const Vertex *v = base + index[j < 3 ? j : 0];
        EACH(i, 3) p[i][j] = v->p[i], n[i][j] = v->n[i] * facing;
    }
    Lanes l;
    EACH(i, 3) {
        l.place[i] = m[4 * i] * p[0] + m[4 * i + 1] * p[1] + m[4 * i + 2] * p[2] + m[4 * i + 3];
        l.normal[i] = t[3 * i] * n[0] + t[3 * i + 1] * n[1] + t[3 * i + 2] * n[2];
    }
    return l;
}

static inline F8 beside(F4 a, F4 b) { return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7); }

static inline F8 halves(float a, float b) { return (F8){a, a, a, a, b, b, b, b}; }

// The light at the corners of two triangles, which are six of eight points.
static inline void light_corners(const Frame *f, const Camera *k, const Seen *const *s, Corners *const *to) {
    const Lanes a = lanes_in(f, s[0]), b = lanes_in(f, s[1]);
    const Surface *m = f->materials + s[0]->material, *n = f->materials + s[1]->material;
    Looks l;
    V3 lights[1 + MOST_SHADOWS];
    l.place = (V3){beside(a.place[0], b.place[0]), beside(a.place[1], b.place[1]), beside(a.place[2], b.place[2])};
    l.normal = unit(
        (V3){beside(a.normal[0], b.normal[0]), beside(a.normal[1], b.normal[1]), beside(a.normal[2], b.normal[2])});
    l.metallic = halves(m->metallic, n->metallic), l.roughness = halves(m->roughness, n->roughness);
    l.er = halves(m->emission[0], n->emission[0]), l.eg = halves(m->emission[1], n->emission[1]);
    l.eb = halves(m->emission[2], n->emission[2]);
    const V3 color = {halves(m->color[0], n->color[0]), halves(m->color[1], n->color[1]),
                      halves(m->color[2], n->color[2])};
    light_points(f, k, &l, color, lights);
    EACH(i, 1 + f->classic->shadow_count) EACH(j, 3) EACH(which, 2) {
        float *light = to[which]->lights[j] + 3 * i;
        light[0] = lights[i].x[4 * which + j], light[1] = lights[i].y[4 * which + j];
        light[2] = lights[i].z[4 * which + j];
    }
}

// Eight samples of different triangles. The light includes the colour of the material: the colour of the samples
// becomes that of the texture alone.
static inline void interpolate(const Frame *f, Looks *l, const Corners *const *corners) {
    F8 rows[LANES], e[LANES + 1], b[3], lights[2 * LANES];
    l->red = l->r, l->green = l->g, l->blue = l->b;
    l->r = l->g = l->b = splat(1);
    EACH_LANE(j) memcpy(rows + j, corners[j]->e, sizeof *rows);
    transpose(rows, e);
    EACH_LANE(j) e[LANES][j] = corners[j]->e[2][2];
    EACH(i, 3) b[i] = e[3 * i] * l->x + e[3 * i + 1] * l->y + e[3 * i + 2];
    const F8 scale = 1 / (b[0] + b[1] + b[2]);
    EACH(i, 3) b[i] *= scale;
    const int count = 1 + f->classic->shadow_count;
    for (int first = 0; first < 3 * count; first += LANES) {
        EACH_LANE(j) {
            F8 light[3];
            EACH(i, 3) memcpy(light + i, corners[j]->lights[i] + first, sizeof *light);
            rows[j] = b[0][j] * light[0] + b[1][j] * light[1] + b[2][j] * light[2];
        }
        transpose(rows, lights + first);
    }
    EACH(n, count) l->lights[n] = (V3){lights[3 * n], lights[3 * n + 1], lights[3 * n + 2]};
}

// The same of samples of one triangle.
static inline void interpolate_one(const Frame *f, Looks *l, const Corners *c) {
    F8 b[3];
    l->red = l->r, l->green = l->g, l->blue = l->b;
    l->r = l->g = l->b = splat(1);
    EACH(i, 3) b[i] = c->e[i][0] * l->x + c->e[i][1] * l->y + c->e[i][2];
    const F8 scale = 1 / (b[0] + b[1] + b[2]);
    EACH(i, 3) b[i] *= scale;
    EACH(n, 1 + f->classic->shadow_count) {
        F8 light[3];
        EACH(i, 3) {
            const int at = 3 * n + i;
            light[i] = b[0] * c->lights[0][at] + b[1] * c->lights[1][at] + b[2] * c->lights[2][at];
        }
        l->lights[n] = (V3){light[0], light[1], light[2]};
    }
}

// The share of a light that reaches eight points.
static inline F8 classic_share(const ClassicLight *l, V3 place, V3 n) {
    const ShadowMap m = {l->shadow, l->frame, l->bounds, l->width, l->height};
    F8 share = splat(-1);
    if (l->directional) {
        look_up(&m, place, n, &share);
    } else {
        const float *s = l->frame;
        const F8 texel = greater(along(s + 8, place, 0), splat(1e-3f)) * s[12];
        const V3 p = sum(place, scaled(n, texel * 1.3f));
        const F8 depth = along(s + 8, p, 0), ahead = greater(depth, splat(1e-3f)), scale = 1 / ahead;
        share = pick(depth > splat(1e-3f), share, splat(1));
        read_map(&m, along(s, p, 0) * scale - 0.5f, along(s + 4, p, 0) * scale - 0.5f, texel * 1.5f - ahead, &share);
    }
    return pick(share < splat(0), splat(1), share);
}

static inline V3 hazy(const Classic *c, V3 light, F8 share) {
    return mixed(light, everywhere(c->haze), within(share, 0, 1));
}

// The light of eight samples of surfaces that are lit at each pixel.
static __attribute__((noinline)) void light_pixels(const Frame *f, const Camera *k, Looks *l) {
    V3 lights[1 + MOST_SHADOWS];
    light_points(f, k, l, (V3){l->red, l->green, l->blue}, lights);
    EACH(i, 1 + MOST_SHADOWS) l->lights[i] = chosen(l->fine, lights[i], l->lights[i]);
}

// The light of surfaces in eight samples.
static inline V3 classic_light(const Frame *f, const Camera *k, Looks *l) {
    const Classic *c = f->classic;
    if (any(l->fine)) light_pixels(f, k, l);
    V3 total = l->lights[0];
    EACH(j, c->light_count) {
        const ClassicLight *light = f->classic_lights + j;
        const V3 own = l->lights[light->number];
        // most triangles face away from some light
        if (!light->number || !any((own.x > splat(0)) | (own.y > splat(0)) | (own.z > splat(0)))) continue;
        total = sum(total, light->width ? scaled(own, classic_share(light, l->place, l->normal)) : own);
    }
    total = product(total, (V3){l->r, l->g, l->b});
    if (c->hazy && any(l->hazed)) {
        const V3 way = difference(l->place, everywhere(k->eye));
        const F8 up = dot(way, everywhere(c->plane)), far = root(greater(dot(way, way) - up * up, splat(0)));
        const F8 clear = (c->far - far) / (c->ring * (far + c->ring * c->far));
        total = chosen(l->hazed & (up < splat(0)), hazy(c, total, 1 - clear), total);
    }
    if (c->foggy) {
        const F8 t = within((l->depth - c->fog_start) * (1 / (c->fog_end - c->fog_start)), 0, 1);
        total = mixed(total, everywhere(c->fog), t);
    }
    return total;
}

// Whether the background has one colour.
static inline int has_plain_sky(const Classic *c) { return c->foggy || (c->sky < 0 && !c->hazy); }

static inline V3 plain_sky(const Classic *c) { return everywhere(c->foggy ? c->fog : c->background); }

// The background in eight samples: a cube of textures, and the haze above the horizon.
static inline V3 classic_sky(const Frame *f, const Camera *k, Looks *l, V3 ray) {
    const Classic *c = f->classic;
    V3 light = everywhere(c->background), aside = grey(0);
    if (k->parallel) {
        // parallel rays begin beside the camera, and meet a sphere around it
        const V3 forward = everywhere(k->axes + 6);
        aside = aside_of(k, l->x, l->y);
        const F8 left = splat(c->far * c->far) - dot(aside, aside);
        ray = sum(aside, scaled(forward, root(greater(left, splat(0)))));
    }
    if (c->sky >= 0) {
        // the axes of cube maps of OpenGL, with Y up
        const V3 d = {ray.x, ray.z, -ray.y};
        const F8 ax = absolute(d.x), ay = absolute(d.y), az = absolute(d.z), zero = splat(0);
        const I8 on_x = (ax >= ay) & (ax >= az), on_y = ~on_x & (ay >= az);
        const F8 most = pick(on_x, ax, pick(on_y, ay, az)), scale = 0.5f / greater(most, splat(1e-30f));
        const I8 less = pick_int(on_x, d.x < zero, pick_int(on_y, d.y < zero, d.z < zero));
        l->texture = c->sky + pick_int(on_x, splat_int(0), pick_int(on_y, splat_int(2), splat_int(4))) - less;
        l->u = pick(on_x, pick(less, d.z, -d.z), pick(on_y, d.x, pick(less, -d.x, d.x))) * scale + 0.5f;
        l->v = pick(on_y, pick(less, -d.z, d.z), -d.y) * scale + 0.5f;
        const Textures t = textures_of(f, l->texture);
        const F8 half_u = 0.5f / to_float(t.width), half_v = 0.5f / to_float(t.height);
        l->u = greater(lesser(l->u, 1 - half_u), half_u), l->v = greater(lesser(l->v, 1 - half_v), half_v);
        l->ux = splat(0.5f / k->fx), l->vy = splat(0.5f / k->fy), l->uy = l->vx = splat(0);
        l->r = l->g = l->b = splat(1);
        add_textures(f, l);
        light = (V3){l->r, l->g, l->b};
    }
    if (c->hazy) {
        const V3 way = k->parallel ? everywhere(k->axes + 6) : ray;
        const F8 up = dot(way, everywhere(c->plane));
        const F8 flat = root(greater(dot(way, way) - up * up, splat(1e-12f)));
        const F8 above = dot(everywhere(k->eye), everywhere(c->plane)) - c->plane[3];
        // how much higher a parallel ray is at the place of the camera, and how far it has to go to the border
        const F8 side = dot(aside, everywhere(c->plane)), along = (dot(aside, way) - side * up) / flat;
        const F8 higher = side - up * along / flat, across = dot(aside, aside) - side * side - along * along;
        const F8 border = k->parallel ? root(greater(c->far * c->far - across, splat(0))) : splat(c->far);
        const F8 slope = up / flat * border;
        // from the border of the plane to the horizon; from below there is no haze
        const F8 clear = (above + slope + higher) / greater(above - slope * c->ring, splat(1e-12f));
        const I8 in = (above > splat(0)) & (above + slope + higher >= splat(0)) & (slope + higher < splat(0));
        light = chosen(in, hazy(c, light, 1 - clear), light);
    }
    return light;
}
