// XXH64, the checksum of Zstandard frames (RFC 8878, section 3.1.1; github.com/Cyan4973/xxHash, doc/xxhash_spec.md).
#pragma once

#include <stdint.h>
#include <string.h>

static const uint64_t XXH_PRIMES[5] = {0x9E3779B185EBCA87u, 0xC2B2AE3D27D4EB4Fu, 0x165667B19E3779F9u,
                                       0x85EBCA77C2B2AE63u, 0x27D4EB2F165667C5u};

static inline uint64_t xxh_turn(uint64_t value, int bits) { return (value << bits) | (value >> (64 - bits)); }

static inline uint64_t xxh_round(uint64_t sum, const uint8_t *at) {
    uint64_t word;
    memcpy(&word, at, 8);
    return xxh_turn(sum + word * XXH_PRIMES[1], 31) * XXH_PRIMES[0];
}

// The checksum with seed 0.
static uint64_t xxh64(const uint8_t *data, int64_t size) {
    const uint64_t *p = XXH_PRIMES;
    const uint8_t *at = data, *end = data + size;
    uint64_t sum = p[4];
    if (size >= 32) {
        uint64_t lanes[4] = {p[0] + p[1], p[1], 0, 0 - p[0]};
        for (; end - at >= 32; at += 32) {
            for (int k = 0; k < 4; k++) lanes[k] = xxh_round(lanes[k], at + 8 * k);
        }
        sum = xxh_turn(lanes[0], 1) + xxh_turn(lanes[1], 7) + xxh_turn(lanes[2], 12) + xxh_turn(lanes[3], 18);
        for (int k = 0; k < 4; k++) sum = (sum ^ xxh_turn(lanes[k] * p[1], 31) * p[0]) * p[0] + p[3];
    }
    sum += (uint64_t)size;
    for (; end - at >= 8; at += 8) sum = xxh_turn(sum ^ xxh_round(0, at), 27) * p[0] + p[3];
    if (end - at >= 4) {
        uint32_t word;
        memcpy(&word, at, 4);
        sum = xxh_turn(sum ^ word * p[0], 23) * p[1] + p[2];
        at += 4;
    }
    for (; at < end; at++) sum = xxh_turn(sum ^ *at * p[4], 11) * p[0];
    sum = (sum ^ (sum >> 33)) * p[1];
    sum = (sum ^ (sum >> 29)) * p[2];
    return sum ^ (sum >> 32);
}
