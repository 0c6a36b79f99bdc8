// Determines the build of this library that the processor can run.
#include <stdint.h>

#include "export.h"

// The digest of all structures and signatures, see `kernel/layout.py`: Python refuses a library with others.
#ifndef MORSE_LAYOUT
#define MORSE_LAYOUT 0
#endif

MORSE_EXPORT uint64_t morse_layout(void);
MORSE_EXPORT int32_t morse_processor_level(void);

uint64_t morse_layout(void) { return MORSE_LAYOUT; }

#if defined(__x86_64__) && !defined(_MSC_VER)
#include <cpuid.h>

#define HAS(value, bit) (((value) >> (bit)) & 1u)

// The registers that the operating system saves: AVX needs those of SSE (bit 1) and of AVX (bit 2).
static uint32_t saved_registers(void) {
    uint32_t low, high;
    __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return low;
}

// Returns the level of the x86-64 psABI, 1 to 3.
int32_t morse_processor_level(void) {
    uint32_t a, b, c, d, extended_b = 0, extended_c = 0;
    if (!__get_cpuid(1, &a, &b, &c, &d)) return 1;
    const uint32_t basic = c;
    // SSE3, SSSE3, CMPXCHG16B, SSE4.1, SSE4.2, POPCNT
    if (!(HAS(basic, 0) && HAS(basic, 9) && HAS(basic, 13) && HAS(basic, 19) && HAS(basic, 20) && HAS(basic, 23))) {
        return 1;
    }
    if (__get_cpuid_count(7, 0, &a, &b, &c, &d)) extended_b = b;
    if (__get_cpuid(0x80000001u, &a, &b, &c, &d)) extended_c = c;
    // FMA, MOVBE, OSXSAVE, AVX, F16C
    if (!(HAS(basic, 12) && HAS(basic, 22) && HAS(basic, 27) && HAS(basic, 28) && HAS(basic, 29))) return 2;
    if ((saved_registers() & 6u) != 6u) return 2;
    // BMI1, AVX2, BMI2, LZCNT
    return HAS(extended_b, 3) && HAS(extended_b, 5) && HAS(extended_b, 8) && HAS(extended_c, 5) ? 3 : 2;
}
#else
int32_t morse_processor_level(void) { return 0; }
#endif
