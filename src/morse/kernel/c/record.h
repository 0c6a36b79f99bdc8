// Records of an MCAP file: copies of templates in which numbers are replaced.
#pragma once

#include <stdint.h>
#include <string.h>

typedef struct {
    int64_t rows;              // R ticks
    int64_t size;              // bytes of the templates: the records of one tick
    const int64_t *begins;     // (R) position of the first record of a tick in the chunk
    const int64_t *moments;    // (R, 3) number of the tick, log time (ns), simulated time (ns)
    const uint8_t *templates;  // (size) records, one behind the other
    int64_t heads;
    const int64_t *head_places;  // (heads) of each record in the templates
    int64_t stamps;
    const int64_t *stamp_places;  // (stamps) of each time stamp in the templates
    uint8_t *chunk;
} RecordRows;

typedef struct {
    const double *const *positions, *const *rotations;  // (R) arrays (K, 3), (K, 9) of all rigid groups
    int64_t members;                                    // N
    const int64_t *slot;                                // (N) rigid group of each member
    const double *offsets, *turned;                     // (N, 3), (N, 9) pose of each member in its group
    const uint8_t *apart;                               // (N) 0: that of the group; 1: moved; 2: moved and rotated
    const int64_t *places;  // (N) of the seven numbers x, y, z, qx, qy, qz, qw in the templates
} RecordPoses;

typedef double (*Unary)(double);
typedef double (*Binary)(double, double);

typedef struct {
    Binary atan2;
    Unary asin, sin, cos;
} RecordFunctions;

typedef struct {
    int64_t ticks;
    const int64_t *begins;   // (ticks) position of the first record of each tick, ascending
    const int64_t *layouts;  // (ticks) the layout of each tick
    const int64_t *firsts;   // (layouts + 1) its first span
    const int64_t *spans;    // (spans, 4) offset in the tick, length, distance of similar bytes, number of the column;
                             // distance 0: the similar bytes are those of the column in the tick before
    int64_t columns;
    int64_t *last;  // (columns) receives the position of each column in the last tick
} PackTicks;

enum { RECORD_DOUBLE, RECORD_SUM, RECORD_SINGLE, RECORD_TURN };

typedef struct {
    int64_t form;
    int64_t place;   // in the templates
    int64_t column;  // of the number in the data; of a turn the first of four
} RecordNumber;

typedef struct {
    int64_t columns;
    const double *data;  // (R, columns)
    int64_t numbers;
    const RecordNumber *which;
} RecordNumbers;

void record_numbers_of(const RecordRows *rows, const RecordNumbers *all);
void record_rows(const RecordRows *rows);
int64_t record_poses(const RecordRows *rows, const RecordPoses *all, const RecordFunctions *use, uint8_t *left);
int64_t record_frames(const RecordRows *rows, const RecordPoses *all, const double *origins, const int64_t *parents,
                      uint8_t *left);
void record_scans(const RecordRows *rows, int64_t members, const int64_t *scans, int64_t rays, int64_t kept,
                  const double *const *distances, const double *reaches, const int64_t *places);
void record_index(int64_t rows, const int64_t *begins, const int64_t *moments, int64_t heads,
                  const int64_t *head_places, const int64_t *channels, uint8_t *index);
int64_t record_pack(const uint8_t *plain, int64_t size, const PackTicks *ticks, uint8_t *frame, uint32_t *room);

typedef struct {
    double position[3];
    double rotation[9];
} RecordPose;

// C = A B, in the order of additions of `product` in `mathutils/rotations.py`.
static inline void record_product(const double *a, const double *b, double *c) {
    for (int i = 0; i < 9; i += 3) {
        for (int j = 0; j < 3; j++) c[i + j] = a[i] * b[j] + a[i + 1] * b[3 + j] + a[i + 2] * b[6 + j];
    }
}

// The pose of a member in the world, as `Mounting.carried` returns it.
static inline RecordPose record_pose(const RecordPoses *all, int64_t row, int64_t member) {
    const int64_t slot = all->slot[member];
    const double *p = all->positions[row] + 3 * slot, *r = all->rotations[row] + 9 * slot;
    RecordPose pose;
    memcpy(pose.position, p, sizeof pose.position);
    memcpy(pose.rotation, r, sizeof pose.rotation);
    if (!all->apart[member]) return pose;
    const double *v = all->offsets + 3 * member;
    for (int i = 0; i < 3; i++) {
        pose.position[i] = p[i] + (r[3 * i] * v[0] + r[3 * i + 1] * v[1] + r[3 * i + 2] * v[2]);
    }
    if (all->apart[member] == 2) record_product(r, all->turned + 9 * member, pose.rotation);
    return pose;
}

// Writes x, y, z and the quaternion, which is given as w, x, y, z and is scaled to the length 1, as `quaternion` in
// `rosmsgs/parts.py` does. Returns 0 if its length is none.
static inline int record_numbers(uint8_t *place, const double *position, const double *q, double length) {
    if (!(length > 0.0) || !(length < __builtin_inf())) return 0;
    double numbers[7] = {position[0], position[1], position[2], q[1], q[2], q[3], q[0]};
    if (length != 1.0) {
        for (int i = 3; i < 7; i++) numbers[i] = numbers[i] / length;
    }
    memcpy(place, numbers, sizeof numbers);
    return 1;
}
