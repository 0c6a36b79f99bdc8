// Distances of many rays to many primitives, one primitive per ray.
#include "primitives.h"

#include "export.h"

MORSE_EXPORT void morse_first_surfaces(int64_t count, const int32_t *kinds, const double *origins,
                                       const double *directions, const double *sizes, double *distances);

// `origins`, `directions` and `sizes` are (count, 3) and in the frames of the primitives.
void morse_first_surfaces(int64_t count, const int32_t *kinds, const double *origins, const double *directions,
                          const double *sizes, double *distances) {
    for (int64_t i = 0; i < count; i++) {
        distances[i] = first_surface(kinds[i], origins + 3 * i, directions + 3 * i, sizes + 3 * i);
    }
}
