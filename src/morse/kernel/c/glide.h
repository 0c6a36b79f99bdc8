// One tick of robots that glide; see glide.c.
#pragma once

#include <stdint.h>

#include "export.h"
#include "gliders.h"

MORSE_EXPORT int64_t morse_glide_begin(const Gliders *all);
MORSE_EXPORT void morse_glide_end(const Gliders *all);
