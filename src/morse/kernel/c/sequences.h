// The sequences section of Zstandard blocks with the predefined distributions (RFC 8878, section 3.1.1.3.2).
#pragma once

#include <stdint.h>
#include <string.h>

typedef struct {
    uint32_t literals;  // copied before the match
    uint32_t length;    // of the match
    uint32_t offset;    // value of the offset: 1 to 3 repeat a former one, others are 3 more than the offset
} Sequence;

enum { LITERAL_CODES = 36, LENGTH_CODES = 53, OFFSET_CODES = 29 };

static const int8_t LITERAL_SHARES[LITERAL_CODES] = {4, 3, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 1, 1,  1,  2,  2,
                                                     2, 2, 2, 2, 2, 2, 2, 3, 2, 1, 1, 1, 1, 1, -1, -1, -1, -1};
static const int8_t LENGTH_SHARES[LENGTH_CODES] = {1, 4, 3, 2, 2, 2, 2, 2, 2, 1, 1,  1,  1,  1,  1,  1,  1, 1,
                                                   1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1,  1,  1,  1,  1,  1,  1, 1,
                                                   1, 1, 1, 1, 1, 1, 1, 1, 1, 1, -1, -1, -1, -1, -1, -1, -1};
static const int8_t OFFSET_SHARES[OFFSET_CODES] = {1, 1, 1, 1, 1, 1, 2, 2, 2, 1,  1,  1,  1,  1, 1,
                                                   1, 1, 1, 1, 1, 1, 1, 1, 1, -1, -1, -1, -1, -1};

// The codes of numbers above 15 literals or 34 bytes: the smallest number, and the number of bits that are added to it.
static const uint32_t LITERAL_BASES[20] = {16,  18,  20,  22,   24,   28,   32,   40,    48,    64,
                                           128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768, 65536};
static const uint8_t LITERAL_BITS[20] = {1, 1, 1, 1, 2, 2, 3, 3, 4, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
static const uint32_t LENGTH_BASES[21] = {35,  37,  39,  41,   43,   47,   51,   59,    67,    83,   99,
                                          131, 259, 515, 1027, 2051, 4099, 8195, 16387, 32771, 65539};
static const uint8_t LENGTH_BITS[21] = {1, 1, 1, 1, 2, 2, 3, 3, 4, 4, 5, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};

typedef struct {
    int log;
    uint8_t bits[64];         // of each state
    uint8_t base[64];         // and the first of the states that may follow
    uint8_t before[53 * 64];  // the state of a code that a state may follow
} States;

static int highest_bit(uint32_t value) { return 31 - __builtin_clz(value); }

// The states of a distribution, as a decoder has them (section 4.1.1), and for each code and next state the one before.
static void make_states(States *states, const int8_t *shares, int codes, int log) {
    const int size = 1 << log, step = (size >> 1) + (size >> 3) + 3;
    uint8_t code_of[64], next[LENGTH_CODES];
    int high = size - 1, at = 0;
    states->log = log;
    for (int code = 0; code < codes; code++) {
        next[code] = (uint8_t)(shares[code] < 0 ? 1 : shares[code]);
        if (shares[code] < 0) code_of[high--] = (uint8_t)code;
    }
    for (int code = 0; code < codes; code++) {
        for (int k = 0; k < shares[code]; k++) {
            code_of[at] = (uint8_t)code;
            do at = (at + step) & (size - 1);
            while (at > high);
        }
    }
    for (int state = 0; state < size; state++) {
        const int number = next[code_of[state]]++, bits = log - highest_bit((uint32_t)number);
        const int base = (number << bits) - size;
        states->bits[state] = (uint8_t)bits;
        states->base[state] = (uint8_t)base;
        memset(states->before + 64 * code_of[state] + base, state, (size_t)1 << bits);
    }
}

// Bits are appended, and read in the opposite order.
typedef struct {
    uint64_t word;
    int count;
    uint8_t *at;
} Bits;

static inline void put_bits(Bits *to, uint64_t value, int count) {
    to->word |= (value & (((uint64_t)1 << count) - 1)) << to->count;
    to->count += count;
}

static inline void store_bits(Bits *to) {
    memcpy(to->at, &to->word, 8);
    const int whole = to->count >> 3;
    to->at += whole;
    to->word >>= 8 * whole;
    to->count &= 7;
}

static inline void step_back(Bits *to, const States *states, int *state, int code) {
    const int before = states->before[64 * code + *state];
    put_bits(to, (uint64_t)(*state - states->base[before]), states->bits[before]);
    *state = before;
}

static inline int literal_code(uint32_t count) {
    if (count < 16) return (int)count;
    if (count >= 64) return 19 + highest_bit(count);
    int code = 0;
    while (LITERAL_BASES[code + 1] <= count) code++;
    return 16 + code;
}

static inline int length_code(uint32_t length) {
    if (length < 35) return (int)length - 3;
    if (length >= 131) return 36 + highest_bit(length - 3);
    int code = 0;
    while (LENGTH_BASES[code + 1] <= length) code++;
    return 32 + code;
}

typedef struct {
    States literals, lengths, offsets;
} Predefined;

static void make_predefined(Predefined *made) {
    make_states(&made->literals, LITERAL_SHARES, LITERAL_CODES, 6);
    make_states(&made->lengths, LENGTH_SHARES, LENGTH_CODES, 6);
    make_states(&made->offsets, OFFSET_SHARES, OFFSET_CODES, 5);
}

// Writes the section of at most 0x7EFF sequences; returns its end. It has at most 10 bytes for a sequence, and 16 more.
static uint8_t *write_sequences(const Predefined *use, const Sequence *sequences, int64_t count, uint8_t *to) {
    if (count < 128) {
        *to++ = (uint8_t)count;
    } else {
        *to++ = (uint8_t)(128 + (count >> 8)), *to++ = (uint8_t)count;
    }
    if (count == 0) return to;
    *to++ = 0;  // all three distributions are predefined
    Bits bits = {0, 0, to};
    int literal = 0, length = 0, offset = 0;
    for (int64_t i = count - 1; i >= 0; i--) {
        const Sequence *one = sequences + i;
        const int a = literal_code(one->literals), b = length_code(one->length), c = highest_bit(one->offset);
        if (i == count - 1) {
            // any state of these codes
            literal = use->literals.before[64 * a], length = use->lengths.before[64 * b];
            offset = use->offsets.before[64 * c];
        } else {
            step_back(&bits, &use->offsets, &offset, c);
            step_back(&bits, &use->lengths, &length, b);
            step_back(&bits, &use->literals, &literal, a);
            store_bits(&bits);
        }
        if (a >= 16) put_bits(&bits, one->literals - LITERAL_BASES[a - 16], LITERAL_BITS[a - 16]);
        if (b >= 32) put_bits(&bits, one->length - LENGTH_BASES[b - 32], LENGTH_BITS[b - 32]);
        store_bits(&bits);
        put_bits(&bits, one->offset - ((uint32_t)1 << c), c);
        store_bits(&bits);
    }
    put_bits(&bits, (uint64_t)length, use->lengths.log);
    put_bits(&bits, (uint64_t)offset, use->offsets.log);
    put_bits(&bits, (uint64_t)literal, use->literals.log);
    put_bits(&bits, 1, 1);
    store_bits(&bits);
    return bits.at + (bits.count > 0);
}
