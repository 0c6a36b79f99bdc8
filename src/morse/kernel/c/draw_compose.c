// Adds reflections and translucent surfaces to pictures; numbers are codes, 0 to 255. Depths and objects of pictures.
#include <stdint.h>

#include "export.h"

// A part of a picture, and another picture of it. `total` are the codes of the whole picture with a fraction, or null
// if these are `first`.
typedef struct {
    int32_t width, left, top, columns, rows, mirrored;  // of the whole picture; of the part
    uint8_t (*first)[4];
    float (*total)[3];
    const int32_t *ids;         // of the whole picture, -1 for nothing
    const uint8_t (*image)[4];  // of the part, with columns from right to left if it is mirrored
    const int32_t *image_ids;
    const uint8_t *chosen;  // of each instance
    float share;
} Overlay;

MORSE_EXPORT int64_t morse_draw_extent(const int32_t *ids, int32_t width, int32_t height, const uint8_t *chosen,
                                       int32_t *box);
MORSE_EXPORT void morse_draw_reflect(const Overlay *o);
MORSE_EXPORT void morse_draw_over(const Overlay *o);
MORSE_EXPORT void morse_draw_codes(const uint8_t (*first)[4], const float (*total)[3], int64_t count, uint8_t (*to)[3]);
MORSE_EXPORT void morse_draw_depths(const float *depths, int64_t count, float background, float *to);
MORSE_EXPORT void morse_draw_objects(const int32_t *ids, int64_t count, const int32_t (*objects)[2], int32_t (*to)[2]);

static inline int is_chosen(const uint8_t *chosen, int32_t id) { return id >= 0 && chosen[id]; }

static inline uint8_t code_of(float value) {
    const float low = value > 0.0f ? value : 0.0f, within = low < 255.0f ? low : 255.0f;
    return (uint8_t)(within + 0.5f);
}

// The pixels that show chosen instances: the first column and row, and those after the last ones; returns their number.
int64_t morse_draw_extent(const int32_t *ids, int32_t width, int32_t height, const uint8_t *chosen, int32_t *box) {
    int64_t count = 0;
    box[0] = width, box[1] = height, box[2] = box[3] = 0;
    for (int32_t y = 0; y < height; y++) {
        const int32_t *row = ids + (int64_t)y * width;
        int32_t first = width, last = -1;
        for (int32_t x = 0; x < width; x++) {
            if (!is_chosen(chosen, row[x])) continue;
            first = x < first ? x : first, last = x, count++;
        }
        if (last < 0) continue;
        if (first < box[0]) box[0] = first;
        if (last + 1 > box[2]) box[2] = last + 1;
        if (y < box[1]) box[1] = y;
        box[3] = y + 1;
    }
    return count;
}

// Adds a share of what a mirror shows, where it is seen.
void morse_draw_reflect(const Overlay *o) {
    for (int32_t y = 0; y < o->rows; y++) {
        const int64_t row = (int64_t)(o->top + y) * o->width + o->left, own = (int64_t)y * o->columns;
        for (int32_t x = 0; x < o->columns; x++) {
            const int64_t at = own + (o->mirrored ? o->columns - 1 - x : x), to = row + x;
            if (o->image_ids[at] < 0 || !is_chosen(o->chosen, o->ids[to])) continue;
            for (int k = 0; k < 3; k++) {
                const float light = o->share * (float)o->image[at][k];
                if (o->total)
                    o->total[to][k] += light;
                else
                    o->first[to][k] = code_of((float)o->first[to][k] + light);
            }
        }
    }
}

// Draws translucent surfaces over a picture: `image` is that without reflections, with the surfaces, which are opaque.
void morse_draw_over(const Overlay *o) {
    for (int32_t y = 0; y < o->rows; y++) {
        const int64_t row = (int64_t)(o->top + y) * o->width + o->left, own = (int64_t)y * o->columns;
        for (int32_t x = 0; x < o->columns; x++) {
            const int64_t at = own + x, to = row + x;
            const float covers = is_chosen(o->chosen, o->image_ids[at]) ? 1.0f : 0.0f;
            for (int k = 0; k < 3; k++) {
                const float first = (float)o->first[to][k], image = (float)o->image[at][k];
                o->total[to][k] += o->share * (image - first + covers * (first - o->total[to][k]));
            }
        }
    }
}

// The colours of all pixels.
void morse_draw_codes(const uint8_t (*first)[4], const float (*total)[3], int64_t count, uint8_t (*to)[3]) {
    for (int64_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) to[i][k] = total ? code_of(total[i][k]) : first[i][k];
}

// Depths; pixels without a surface have that of the background.
void morse_draw_depths(const float *depths, int64_t count, float background, float *to) {
    for (int64_t i = 0; i < count; i++) to[i] = depths[i] > 0.0f ? depths[i] : background;
}

// The objects that instances belong to, -1 and -1 for nothing.
void morse_draw_objects(const int32_t *ids, int64_t count, const int32_t (*objects)[2], int32_t (*to)[2]) {
    for (int64_t i = 0; i < count; i++)
        for (int k = 0; k < 2; k++) to[i][k] = ids[i] < 0 ? -1 : objects[ids[i]][k];
}
