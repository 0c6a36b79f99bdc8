// Compresses the records of many ticks into a Zstandard frame (RFC 8878), which any decoder of Zstandard reads.
//
// A record resembles the record of the same sensor in the tick before, or that of the sensor before. The bytes are
// compared with these only, instead of being searched for: that takes a quarter of the time of the fastest level of
// the library, for files that are a little larger.
#include "checksum.h"
#include "record.h"
#include "sequences.h"

#define BLOCK (1 << 17)  // maximum size of a block, bytes
#define LEAST 8          // minimum length of a match: one word
#define MOST_DISTANCE (1 << 27)

typedef struct {
    const uint8_t *plain;
    int64_t block, block_end, anchor, end;  // begin and end of the block; literals since; end of all bytes
    uint8_t *to, *literals;
    Sequence *sequences;
    int64_t count;
    uint32_t repeats[3], repeats_before[3];  // the last three offsets, and those at the begin of the block
    Predefined predefined;
} Packer;

static void begin_block(Packer *packer) {
    packer->block = packer->anchor = packer->block_end;
    packer->block_end = packer->end - packer->block < BLOCK ? packer->end : packer->block + BLOCK;
    packer->literals = packer->to + 6;  // after the headers of the block and of its literals
    packer->count = 0;
    memcpy(packer->repeats_before, packer->repeats, sizeof packer->repeats);
}

static void put_literals(Packer *packer, int64_t until) {
    const int64_t count = until - packer->anchor;
    memcpy(packer->literals, packer->plain + packer->anchor, (size_t)count);
    packer->literals += count;
}

static void end_block(Packer *packer) {
    put_literals(packer, packer->block_end);
    const int64_t size = packer->block_end - packer->block, kept = packer->literals - packer->to - 6;
    const uint32_t is_last = packer->block_end == packer->end;
    uint8_t *end = write_sequences(&packer->predefined, packer->sequences, packer->count, packer->literals);
    int64_t content = end - packer->to - 3;
    uint32_t head = is_last | 2 << 1 | (uint32_t)content << 3;
    if (content >= size || packer->count == 0) {  // a raw block, after which the offsets are those before
        memcpy(packer->repeats, packer->repeats_before, sizeof packer->repeats);
        memcpy(packer->to + 3, packer->plain + packer->block, (size_t)size);
        content = size;
        head = is_last | (uint32_t)size << 3;
    } else {
        const uint32_t raw = 3 << 2 | (uint32_t)kept << 4;
        memcpy(packer->to + 3, &raw, 3);
    }
    memcpy(packer->to, &head, 3);
    packer->to += 3 + content;
}

// The value of an offset, which may be one of the last three (section 3.1.1.5).
static uint32_t value_of(uint32_t *last, uint32_t offset, int follows_literals) {
    const uint32_t a = last[0], b = last[1], c = last[2];
    if (follows_literals && offset == a) return 1;
    last[0] = offset, last[1] = a;
    if (offset == b) return follows_literals ? 2 : 1;
    last[2] = b;
    if (offset == c) return follows_literals ? 3 : 2;
    return offset + 3;
}

static inline uint64_t difference(const uint8_t *at, int64_t distance) {
    uint64_t a, b;
    memcpy(&a, at, 8);
    memcpy(&b, at - distance, 8);
    return a ^ b;
}

// Replaces bytes that repeat those at a distance before them, within the block.
static void pack_part(Packer *packer, int64_t begin, int64_t end, int64_t distance) {
    const uint8_t *plain = packer->plain;
    int64_t at = begin;
    while (at + LEAST <= end) {
        const uint64_t other = difference(plain + at, distance);
        if (other != 0) {
            at += 8 - (__builtin_clzll(other) >> 3);  // a match begins after the last different byte
            continue;
        }
        int64_t until = at + LEAST;
        while (until + 8 <= end && difference(plain + until, distance) == 0) until += 8;
        while (until < end && plain[until] == plain[until - distance]) until++;
        put_literals(packer, at);
        const uint32_t literals = (uint32_t)(at - packer->anchor);
        const uint32_t value = value_of(packer->repeats, (uint32_t)distance, literals > 0);
        packer->sequences[packer->count++] = (Sequence){literals, (uint32_t)(until - at), value};
        packer->anchor = at = until;
    }
}

static void pack_span(Packer *packer, int64_t begin, int64_t end, int64_t distance) {
    const int is_alike = distance > 0 && distance <= begin && distance < MOST_DISTANCE;
    while (begin < end) {
        const int64_t until = end < packer->block_end ? end : packer->block_end;
        if (is_alike) pack_part(packer, begin, until, distance);
        begin = until;
        if (begin == packer->block_end && begin < packer->end) {
            end_block(packer);
            begin_block(packer);
        }
    }
}

// Returns the size of the frame, which takes up to 5 / 4 of the size of the bytes, and 1024 more. `room` are 3 numbers
// for each LEAST bytes of a block.
int64_t record_pack(const uint8_t *plain, int64_t size, const PackTicks *ticks, uint8_t *frame, uint32_t *room) {
    Packer packer = {.plain = plain, .end = size, .sequences = (Sequence *)room, .repeats = {1, 4, 8}};
    const uint32_t magic = 0xFD2FB528;
    const uint64_t content = (uint64_t)size;
    memcpy(frame, &magic, 4);
    frame[4] = 3 << 6 | 1 << 5 | 1 << 2;  // size in 8 bytes, one segment, checksum
    memcpy(frame + 5, &content, 8);
    packer.to = frame + 13;
    make_predefined(&packer.predefined);
    for (int64_t k = 0; k < ticks->columns; k++) ticks->last[k] = -1;
    begin_block(&packer);
    int64_t at = 0;
    for (int64_t i = 0; i < ticks->ticks; i++) {
        const int64_t begin = ticks->begins[i], layout = ticks->layouts[i];
        pack_span(&packer, at, begin, 0);
        at = begin;
        for (int64_t k = ticks->firsts[layout]; k < ticks->firsts[layout + 1]; k++) {
            const int64_t *span = ticks->spans + 4 * k;
            const int64_t first = begin + span[0];
            int64_t *last = ticks->last + span[3], distance = span[2];
            if (distance == 0) {
                distance = *last < 0 ? 0 : first - *last;
                *last = first;
            }
            pack_span(&packer, first, first + span[1], distance);
            at = first + span[1];
        }
    }
    pack_span(&packer, at, size, 0);
    end_block(&packer);
    const uint32_t checksum = (uint32_t)xxh64(plain, size);
    memcpy(packer.to, &checksum, 4);
    return packer.to + 4 - frame;
}
