// Operations on eight numbers at a time, the same for every compiler and every register width.
#pragma once
#include <math.h>
#include <stdint.h>
#include <string.h>

typedef float F8 __attribute__((vector_size(32)));
typedef int32_t I8 __attribute__((vector_size(32)));
typedef float F4 __attribute__((vector_size(16)));
typedef int32_t I4 __attribute__((vector_size(16)));
typedef int64_t L4 __attribute__((vector_size(32)));

#define LANES 8
// Prevents masked stores, which are many times slower than a load, a selection and a store.
#define NO_MASKED_STORE __asm__ volatile("" ::: "memory")
#define ALWAYS_INLINE inline __attribute__((always_inline))
#define EACH_LANE(j) for (int j = 0; j < LANES; j++)

static inline F8 splat(float a) { return (F8){a, a, a, a, a, a, a, a}; }
static inline I8 splat_int(int32_t a) { return (I8){a, a, a, a, a, a, a, a}; }
static inline I8 bits_of(F8 a) { return (I8)a; }
static inline F8 from_bits(I8 a) { return (F8)a; }
static inline I8 pick_int(I8 mask, I8 a, I8 b) { return (mask & a) | (~mask & b); }
static inline F8 pick(I8 mask, F8 a, F8 b) { return from_bits(pick_int(mask, bits_of(a), bits_of(b))); }
// `b` where `a` is NaN: pass the operand that is known to be finite second.
static inline F8 lesser(F8 a, F8 b) { return pick(a < b, a, b); }
static inline F8 greater(F8 a, F8 b) { return pick(a > b, a, b); }
static inline F8 within(F8 a, float low, float high) { return greater(lesser(a, splat(high)), splat(low)); }
static inline I8 greater_int(I8 a, I8 b) { return pick_int(a > b, a, b); }
static inline F8 to_float(I8 a) { return __builtin_convertvector(a, F8); }
// The numbers must be in the range of the result.
static inline I8 to_int(F8 a) { return __builtin_convertvector(a, I8); }

static inline F8 root(F8 a) {
    F8 r;
    EACH_LANE(j) r[j] = sqrtf(a[j]);
    return r;
}

static inline F8 whole(F8 a) {
    F8 r;
    EACH_LANE(j) r[j] = floorf(a[j]);
    return r;
}

static inline int any(I8 mask) {
    int32_t r = 0;
    EACH_LANE(j) r |= mask[j];
    return r != 0;
}

// A bit for each negative lane, the first is the lowest. Compilers do not find the instruction for it.
static inline unsigned lanes_of(I8 a) {
#if defined(__AVX__)
    return (unsigned)__builtin_ia32_movmskps256(from_bits(a));
#elif defined(__SSE__)
    F4 low, high;
    memcpy(&low, &a, sizeof low), memcpy(&high, (const char *)&a + sizeof low, sizeof high);
    return (unsigned)__builtin_ia32_movmskps(low) | (unsigned)__builtin_ia32_movmskps(high) << 4;
#else
    const I8 bits = (a >> 31) & (I8){1, 2, 4, 8, 16, 32, 64, 128};
    int32_t r = 0;
    EACH_LANE(j) r |= bits[j];
    return (unsigned)r;
#endif
}

// base ** exponent for positive bases, to about six digits; results are clipped to 2**-100 ... 2**100.
static inline F8 powers(F8 base, F8 exponent) {
    I8 bits = bits_of(base);
    const I8 high = (bits - 0x3f3504f3) >> 23;
    bits -= high * 8388608;
    const F8 m = from_bits(bits), t = (m - 1) / (m + 1), s = t * t;
    const F8 log2 = 2.88539008f * t * (1 + s * (0.33333333f + s * (0.2f + s * 0.14285714f))) + to_float(high);
    const F8 p = within(log2 * exponent, -100, 100), n = whole(p), r = (p - n) * 0.69314718f;
    const F8 two = from_bits((to_int(n) + 127) * 8388608);
    return (1 + r * (1 + r * (0.5f + r * (0.16666667f + r * (0.041666667f + r * 0.0083333333f))))) * two;
}

static inline F8 power(F8 base, float exponent) { return powers(base, splat(exponent)); }

typedef struct {
    F8 x, y, z;
} V3;

static inline F8 dot(V3 a, V3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline V3 scaled(V3 a, F8 s) { return (V3){a.x * s, a.y * s, a.z * s}; }
static inline V3 sum(V3 a, V3 b) { return (V3){a.x + b.x, a.y + b.y, a.z + b.z}; }
static inline V3 difference(V3 a, V3 b) { return (V3){a.x - b.x, a.y - b.y, a.z - b.z}; }
static inline V3 product(V3 a, V3 b) { return (V3){a.x * b.x, a.y * b.y, a.z * b.z}; }
static inline V3 grey(float a) { return (V3){splat(a), splat(a), splat(a)}; }
static inline V3 everywhere(const float *a) { return (V3){splat(a[0]), splat(a[1]), splat(a[2])}; }
static inline V3 mixed(V3 a, V3 b, F8 t) {
    return (V3){a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t, a.z + (b.z - a.z) * t};
}
static inline V3 chosen(I8 mask, V3 a, V3 b) {
    return (V3){pick(mask, a.x, b.x), pick(mask, a.y, b.y), pick(mask, a.z, b.z)};
}
static inline V3 unit(V3 a) { return scaled(a, 1 / root(greater(dot(a, a), splat(1e-30f)))); }

static inline F8 absolute(F8 a) { return from_bits(bits_of(a) & INT32_MAX); }

// Rows of four numbers become columns.
static inline void columns_of(const F4 *rows, F8 *to) {
    F8 a[4], b[4];
    for (int i = 0; i < 4; i++) a[i] = __builtin_shufflevector(rows[i], rows[i + 4], 0, 1, 2, 3, 4, 5, 6, 7);
    for (int i = 0; i < 2; i++) {
        b[2 * i] = __builtin_shufflevector(a[2 * i], a[2 * i + 1], 0, 8, 1, 9, 4, 12, 5, 13);
        b[2 * i + 1] = __builtin_shufflevector(a[2 * i], a[2 * i + 1], 2, 10, 3, 11, 6, 14, 7, 15);
    }
    for (int i = 0; i < 2; i++) {
        to[2 * i] = __builtin_shufflevector(b[i], b[i + 2], 0, 1, 8, 9, 4, 5, 12, 13);
        to[2 * i + 1] = __builtin_shufflevector(b[i], b[i + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    }
}
