// Encodes the recorded data of many ticks; `kernel/recording/arrays.py` describes the arrays.
#include "record.h"

#include <math.h>

// Offsets in the header of a record, after the opcode (1), the length (8) and the channel (2).
enum { SEQUENCE = 11, LOG_TIME = 15, PUBLISH_TIME = 23 };

// Copies the templates into the chunk, and writes the time of each tick into the copies.
void record_rows(const RecordRows *rows) {
    for (int64_t i = 0; i < rows->rows; i++) {
        uint8_t *begin = rows->chunk + rows->begins[i];
        const int64_t *moment = rows->moments + 3 * i;
        const uint32_t sequence = (uint32_t)moment[0];
        const int64_t second = 1000000000;
        const int64_t seconds = moment[2] / second - (moment[2] % second < 0);
        const uint32_t stamp[2] = {(uint32_t)seconds, (uint32_t)(moment[2] - seconds * second)};
        memcpy(begin, rows->templates, (size_t)rows->size);
        for (int64_t k = 0; k < rows->heads; k++) {
            uint8_t *head = begin + rows->head_places[k];
            memcpy(head + SEQUENCE, &sequence, sizeof sequence);
            memcpy(head + LOG_TIME, moment + 1, 8);
            memcpy(head + PUBLISH_TIME, moment + 2, 8);
        }
        for (int64_t k = 0; k < rows->stamps; k++) memcpy(begin + rows->stamp_places[k], stamp, sizeof stamp);
    }
}

// A Z axis with a steeper slope than this has one set of angles; see `helpers/transformation.py`.
#define UPRIGHT 0.51

// Poses as measured by the sensor `Pose`: the quaternion is computed from the angles, with the functions that Python
// calls. Returns the number of messages that are left to Python; `left` (R, N) marks them.
int64_t record_poses(const RecordRows *rows, const RecordPoses *all, const RecordFunctions *use, uint8_t *left) {
    int64_t count = 0;
    for (int64_t i = 0; i < rows->rows; i++) {
        for (int64_t k = 0; k < all->members; k++) {
            const RecordPose pose = record_pose(all, i, k);
            const double *m = pose.rotation;
            uint8_t *is_left = left + i * all->members + k;
            *is_left = 1;
            count++;
            if (!(m[8] > UPRIGHT) || !(fabs(m[6]) <= 1.0)) continue;
            const double yaw = use->atan2(m[3], m[0]), c = 0.5 * yaw;
            double cr = 1.0, sr = m[7], cp = 1.0, sp = -m[6];
            // these functions return a zero of the same sign for zero
            if (m[7] != 0.0) {
                const double a = 0.5 * use->atan2(m[7], m[8]);
                cr = use->cos(a), sr = use->sin(a);
            }
            if (m[6] != 0.0) {
                const double b = 0.5 * -use->asin(m[6]);
                cp = use->cos(b), sp = use->sin(b);
            }
            const double cy = use->cos(c), sy = use->sin(c);
            double q[4] = {cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy,
                           cr * cp * sy - sr * sp * cy};
            if (!(q[0] >= 0.0)) {
                for (int j = 0; j < 4; j++) q[j] = -q[j];
            }
            const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
            // fields are added to an offset of zero, which removes the sign of zero
            const double position[3] = {pose.position[0] + 0.0, pose.position[1] + 0.0, pose.position[2] + 0.0};
            if (!record_numbers(rows->chunk + rows->begins[i] + all->places[k], position, q, length)) continue;
            *is_left = 0;
            count--;
        }
    }
    return count;
}

static double at_least_zero(double value) { return value > 0.0 ? value : 0.0; }

static double or_one(double value) { return value != 0.0 ? value : 1.0; }

// The same as `quaternion_from_rotation` in `mathutils/rotations.py`.
static void quaternion_of(const double *m, double *q) {
    const double a = m[0], b = m[1], c = m[2], d = m[3], e = m[4], f = m[5], g = m[6], h = m[7], i = m[8];
    double s;
    if (a + e + i > 0.0) {
        s = 2.0 * sqrt(1.0 + a + e + i);
        q[0] = s / 4, q[1] = (h - f) / s, q[2] = (c - g) / s, q[3] = (d - b) / s;
    } else if (a >= e && a >= i) {
        s = or_one(2.0 * sqrt(at_least_zero(1.0 + a - e - i)));
        q[0] = (h - f) / s, q[1] = s / 4, q[2] = (b + d) / s, q[3] = (c + g) / s;
    } else if (e >= i) {
        s = or_one(2.0 * sqrt(at_least_zero(1.0 + e - a - i)));
        q[0] = (c - g) / s, q[1] = (b + d) / s, q[2] = s / 4, q[3] = (f + h) / s;
    } else {
        s = or_one(2.0 * sqrt(at_least_zero(1.0 + i - a - e)));
        q[0] = (d - b) / s, q[1] = (c + g) / s, q[2] = (f + h) / s, q[3] = s / 4;
    }
    const double scale = copysign(1.0 / or_one(sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])), q[0]);
    for (int k = 0; k < 4; k++) q[k] = q[k] * scale;
}

// Poses in other frames: in that of the rigid group `parents` (N) in the same tick, or, where it is negative, in the
// frame `origins` (N, 12), position and rotation, such as the initial pose of a robot. Returns the number of messages
// that are left to Python; `left` (R, N) marks them.
int64_t record_frames(const RecordRows *rows, const RecordPoses *all, const double *origins, const int64_t *parents,
                      uint8_t *left) {
    int64_t count = 0;
    for (int64_t i = 0; i < rows->rows; i++) {
        for (int64_t k = 0; k < all->members; k++) {
            const RecordPose pose = record_pose(all, i, k);
            const int64_t parent = parents[k];
            const double *p = parent < 0 ? origins + 12 * k : all->positions[i] + 3 * parent;
            const double *r = parent < 0 ? p + 3 : all->rotations[i] + 9 * parent;
            const double x = pose.position[0] - p[0], y = pose.position[1] - p[1], z = pose.position[2] - p[2];
            const double position[3] = {r[0] * x + r[3] * y + r[6] * z, r[1] * x + r[4] * y + r[7] * z,
                                        r[2] * x + r[5] * y + r[8] * z};
            const double back[9] = {r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]};
            double turned[9], q[4];
            record_product(back, pose.rotation, turned);
            quaternion_of(turned, q);
            const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
            uint8_t *place = rows->chunk + rows->begins[i] + all->places[k];
            left[i * all->members + k] = !record_numbers(place, position, q, length);
            count += left[i * all->members + k];
        }
    }
    return count;
}

// Distances (R) (B, rays) of scanners, in single precision; infinite at or above the range of the scanner. The first
// `kept` rays of each scan are written. `scans` (N) are the rows of the scanners.
void record_scans(const RecordRows *rows, int64_t members, const int64_t *scans, int64_t rays, int64_t kept,
                  const double *const *distances, const double *reaches, const int64_t *places) {
    for (int64_t i = 0; i < rows->rows; i++) {
        for (int64_t k = 0; k < members; k++) {
            const double *from = distances[i] + scans[k] * rays;
            uint8_t *place = rows->chunk + rows->begins[i] + places[k];
            for (int64_t j = 0; j < kept; j++) {
                const float range = from[j] >= reaches[k] ? __builtin_inff() : (float)from[j];
                memcpy(place + 4 * j, &range, sizeof range);
            }
        }
    }
}

// Writes a record ``MessageIndex`` for each of the channels, one behind the other: log time and position of its
// messages.
void record_index(int64_t rows, const int64_t *begins, const int64_t *moments, int64_t heads,
                  const int64_t *head_places, const int64_t *channels, uint8_t *index) {
    enum { OPCODE = 7 };
    for (int64_t k = 0; k < heads; k++) {
        const uint64_t length = (uint64_t)(6 + 16 * rows);
        const uint32_t size = (uint32_t)(16 * rows);
        const uint16_t channel = (uint16_t)channels[k];
        index[0] = OPCODE;
        memcpy(index + 1, &length, 8);
        memcpy(index + 9, &channel, 2);
        memcpy(index + 11, &size, 4);
        index += 15;
        for (int64_t i = 0; i < rows; i++, index += 16) {
            const int64_t entry[2] = {moments[3 * i + 1], begins[i] + head_places[k]};
            memcpy(index, entry, sizeof entry);
        }
    }
}
