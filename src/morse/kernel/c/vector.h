// Eight numbers at once, by the vector extensions of GCC and Clang: the same source for SSE, AVX and NEON.
#pragma once

#include <stdint.h>
#include <string.h>

#ifdef __clang__
// knows the operator ?:, and makes one instruction of a minimum
typedef float Floats __attribute__((ext_vector_type(8)));
typedef int32_t Ints __attribute__((ext_vector_type(8)));
#define CHOSEN(holds, a, b) ((holds) ? (a) : (b))
#else
typedef float Floats __attribute__((vector_size(32)));
typedef int32_t Ints __attribute__((vector_size(32)));
#define CHOSEN(holds, a, b) ((Floats)(((Ints)(a) & (holds)) | ((Ints)(b) & ~(holds))))
#endif
typedef double Doubles __attribute__((vector_size(32)));
typedef int64_t Longs __attribute__((vector_size(32)));

#define EACH(type, value) ((type){0} + (value))

// One bit for each lane that is not zero; the lanes are 0 or -1.
#ifdef __clang__
typedef _Bool EightBools __attribute__((ext_vector_type(8)));
typedef _Bool FourBools __attribute__((ext_vector_type(4)));

static inline uint32_t bits8(const Ints *lanes) {
    const EightBools bools = __builtin_convertvector(*lanes, EightBools);
    uint8_t bits;
    memcpy(&bits, &bools, 1);
    return bits;
}

static inline uint32_t bits4(const Longs *lanes) {
    const FourBools bools = __builtin_convertvector(*lanes, FourBools);
    uint8_t bits;
    memcpy(&bits, &bools, 1);
    return bits & 15u;
}
#else
static inline uint32_t bits8(const Ints *lanes) {
    uint32_t bits = 0;
    for (int k = 0; k < 8; k++) bits |= ((uint32_t)(*lanes)[k] & 1u) << k;
    return bits;
}

static inline uint32_t bits4(const Longs *lanes) {
    uint32_t bits = 0;
    for (int k = 0; k < 4; k++) bits |= (uint32_t)((*lanes)[k] & 1) << k;
    return bits;
}
#endif
