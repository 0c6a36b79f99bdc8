// Writes numbers of the data of sensors into their messages; `kernel/recording/arrays.py` describes the arrays.
#include <math.h>

#include "record.h"

// The same as `xyzw` in `rosmsgs/parts.py`; q is w, x, y, z.
static void write_turn(uint8_t *place, const double *q) {
    const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    double numbers[4] = {0.0, 0.0, 0.0, 1.0};
    if (length > 0.0 && length < __builtin_inf()) {
        for (int k = 0; k < 4; k++) numbers[k] = length == 1.0 ? q[(k + 1) % 4] : q[(k + 1) % 4] / length;
    }
    memcpy(place, numbers, sizeof numbers);
}

void record_numbers_of(const RecordRows *rows, const RecordNumbers *all) {
    for (int64_t i = 0; i < rows->rows; i++) {
        const double *data = all->data + i * all->columns;
        uint8_t *begin = rows->chunk + rows->begins[i];
        for (int64_t k = 0; k < all->numbers; k++) {
            const RecordNumber *one = all->which + k;
            const double *from = data + one->column;
            uint8_t *place = begin + one->place;
            const double sum = *from + 0.0;  // removes the sign of zero
            const float single = (float)*from;
            switch (one->form) {
                case RECORD_DOUBLE:
                    memcpy(place, from, sizeof *from);
                    break;
                case RECORD_SUM:
                    memcpy(place, &sum, sizeof sum);
                    break;
                case RECORD_SINGLE:
                    memcpy(place, &single, sizeof single);
                    break;
                case RECORD_TURN:
                    write_turn(place, from);
                    break;
                default:
                    break;
            }
        }
    }
}
