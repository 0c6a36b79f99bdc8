// Runs several steps of the encoding of a chunk in one call; `kernel/recording/batch.py` describes the steps.
#include "export.h"
#include "record.h"

enum { ROWS, POSES, FRAMES, SCANS, INDEX, PACK, APPEND, NUMBERS };

typedef struct {
    int64_t kind;
    int64_t result;        // of POSES, FRAMES: number of messages that are left to Python; of PACK: size of the frame
    int64_t arguments[8];  // numbers and addresses
} RecordStep;

MORSE_EXPORT int64_t morse_record_batch(RecordStep *steps, int64_t count);

static void *at(const RecordStep *step, int k) { return (void *)(intptr_t)step->arguments[k]; }

static void run(RecordStep *step, const RecordStep *before) {
    const int64_t *n = step->arguments;
    switch (step->kind) {
        case ROWS:
            record_rows(at(step, 0));
            break;
        case POSES:
            step->result = record_poses(at(step, 0), at(step, 1), at(step, 2), at(step, 3));
            break;
        case FRAMES:
            step->result = record_frames(at(step, 0), at(step, 1), at(step, 2), at(step, 3), at(step, 4));
            break;
        case SCANS:
            record_scans(at(step, 0), n[1], at(step, 2), n[3], n[4], at(step, 5), at(step, 6), at(step, 7));
            break;
        case INDEX:
            record_index(n[0], at(step, 1), at(step, 2), n[3], at(step, 4), at(step, 5), at(step, 6));
            break;
        case PACK:
            step->result = record_pack(at(step, 0), n[1], at(step, 2), at(step, 3), at(step, 4));
            break;
        case APPEND:  // behind the frame of the step before
            memcpy((uint8_t *)at(step, 0) + before->result, at(step, 1), (size_t)n[2]);
            break;
        case NUMBERS:
            record_numbers_of(at(step, 0), at(step, 1));
            break;
        default:
            break;
    }
}

// Runs the steps in order, up to the first one that leaves messages to Python. Returns the number of steps that have
// run.
int64_t morse_record_batch(RecordStep *steps, int64_t count) {
    for (int64_t k = 0; k < count; k++) {
        run(steps + k, steps + k - 1);
        if ((steps[k].kind == POSES || steps[k].kind == FRAMES) && steps[k].result != 0) return k + 1;
    }
    return count;
}
