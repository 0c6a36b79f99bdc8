// People who walk: the directions that bring them farthest, and the ways to goals on a grid; the twin of
// `tests/kernel/twins/walking.py`.
#include <math.h>
#include <stdint.h>

#include "export.h"

typedef struct {
    int64_t people, pairs, turns, height, width;  // numbers; of cells along Y and X
    const int64_t *first;                         // (pairs,) who sees
    const double *apart, *velocity;               // (pairs, 2) from the one who is seen, m; of that one, m/s
    const double *distance, *radii;               // (pairs,) m
    const double *position, *wanted;              // (people, 2) m; unit vectors of the ways, 0 for those who stand
    const double *speed, *beside;                 // (people,) free speeds, m/s; distance of walls at which they stop, m
    const uint8_t *present;                       // (people,)
    const double *gap;                            // (height, width) distance to the nearest wall, m
    double origin[2], cell, sight;                // m
    const double *turned;                         // (turns, 2) cosines and sines of the other directions
    double *best, *free;                          // (people,) work space
    double *result;                               // (people, 2) unit vectors
} Walk;

typedef struct {
    int64_t width, count, seeds;  // cells of a row, of the grid; cells from which the search begins
    const uint8_t *is_free;       // (count,) 0 at all edges of the grid
    const double *slowness;       // (count,) time through a cell
    const int64_t *seed;          // (seeds,) cells whose times are known
    int64_t *heap, *place;        // (count,) work space: cells by their times; where they are, -1 for the others
    double *time;                 // (count,) in: known times, else infinite; out: arrivals
} Arrival;

typedef struct {
    int64_t width, corners;                                  // cells of a row of the grid; of the polygon
    int64_t first_row, last_row, first_column, last_column;  // of the cells that are near; the last ones do not belong
    const double *polygon;                                   // (corners, 2) counter-clockwise, m
    double origin[2], cell;                                  // m
    double *gap;                                             // (height, width) distances to walls so far, m; in and out
} Wall;

MORSE_EXPORT void morse_walk_wall(Wall *all);
MORSE_EXPORT void morse_walk_direction(Walk *all);
MORSE_EXPORT void morse_walk_arrival(Arrival *all);

// A coordinate in cells as an index from 0 to `last`; 0 for NaN.
static int64_t cell_index(double value, int64_t last) {
    return value >= (double)last ? last : value >= 0.0 ? (int64_t)value : 0;
}

// Limits a share to 0 to 1.
static double share_of(double value) { return value < 0.0 ? 0.0 : value > 1.0 ? 1.0 : value; }

// The distance of a place to the nearest wall, m, bilinear between the cells.
static double gap_at(const Walk *all, double x, double y) {
    const double u = (x - all->origin[0]) / all->cell, v = (y - all->origin[1]) / all->cell;
    const int64_t column = cell_index(floor(u), all->width - 2), row = cell_index(floor(v), all->height - 2);
    const double a = share_of(u - (double)column), b = share_of(v - (double)row);
    const double *low = all->gap + row * all->width + column, *high = low + all->width;
    double sum = (1.0 - a) * (1.0 - b) * low[0];
    sum += a * (1.0 - b) * low[1];
    sum += (1.0 - a) * b * high[0];
    sum += a * b * high[1];
    return sum;
}

// How far people come in the directions `wanted`, turned, at their free speeds, m, for those whose `best` is not
// negative; sets `free`.
static void find_free_ways(Walk *all, double cosine, double sine) {
    for (int64_t i = 0; i < all->people; i++) all->free[i] = all->sight;
    for (int64_t k = 0; k < all->pairs; k++) {
        const int64_t i = all->first[k];
        if (all->best[i] < 0.0) continue;
        const double x = all->wanted[2 * i], y = all->wanted[2 * i + 1], speed = all->speed[i];
        const double u = (cosine * x - sine * y) * speed - all->velocity[2 * k];
        const double v = (sine * x + cosine * y) * speed - all->velocity[2 * k + 1];
        const double closing = -(u * all->apart[2 * k] + v * all->apart[2 * k + 1]);
        const double moved = u * u + v * v, squared = moved > 1e-9 ? moved : 1e-9, far = all->distance[k];
        // bodies that touch already do not count, unless one walks into them
        const double least = 0.98 * far, radii = all->radii[k] < least ? all->radii[k] : least;
        const double root = closing * closing - squared * (far * far - radii * radii);
        if (!(closing > 0.0 && root > 0.0)) continue;
        const double time = (closing - sqrt(root)) / squared, way = (time > 0.0 ? time : 0.0) * speed;
        if (way < all->free[i]) all->free[i] = way;
    }
    for (int64_t i = 0; i < all->people; i++) {
        if (all->best[i] < 0.0) continue;
        const double x = all->wanted[2 * i], y = all->wanted[2 * i + 1];
        const double u = cosine * x - sine * y, v = sine * x + cosine * y;
        // walls 1.2 m and 0.6 m ahead: half of the way to them is free
        for (int step = 2; step; step--) {
            const double ahead = 0.6 * step;
            const double gap = gap_at(all, all->position[2 * i] + ahead * u, all->position[2 * i + 1] + ahead * v);
            if (gap < all->beside[i] && 0.5 * ahead < all->free[i]) all->free[i] = 0.5 * ahead;
        }
    }
}

// The best of the directions for each of the people; of equal ones the first, the straight one before all others.
void morse_walk_direction(Walk *all) {
    const double sight = all->sight;
    for (int64_t i = 0; i < all->people; i++) {
        const int stands = all->wanted[2 * i] == 0.0 && all->wanted[2 * i + 1] == 0.0;
        all->best[i] = stands || !all->present[i] ? -1.0 : 1.0;
        all->result[2 * i] = all->wanted[2 * i], all->result[2 * i + 1] = all->wanted[2 * i + 1];
    }
    find_free_ways(all, 1.0, 0.0);
    for (int64_t i = 0; i < all->people; i++) {
        const double free = all->free[i];
        if (all->best[i] < 0.0) continue;
        // a free way is the best one
        all->best[i] = free < sight ? sight * sight + free * free - 2.0 * sight * free : -1.0;
    }
    for (int64_t turn = 0; turn < all->turns; turn++) {
        const double cosine = all->turned[2 * turn], sine = all->turned[2 * turn + 1];
        find_free_ways(all, cosine, sine);
        for (int64_t i = 0; i < all->people; i++) {
            const double free = all->free[i], cost = sight * sight + free * free - 2.0 * sight * free * cosine;
            if (all->best[i] < 0.0 || !(cost < all->best[i] - 1e-9)) continue;
            const double x = all->wanted[2 * i], y = all->wanted[2 * i + 1];
            all->best[i] = cost;
            all->result[2 * i] = cosine * x - sine * y, all->result[2 * i + 1] = sine * x + cosine * y;
        }
    }
}

// The order of the heap, in which no cell is before its parent: by times, equal ones by the numbers of the cells.
static int is_before(const Arrival *all, int64_t one, int64_t two) {
    return all->time[one] < all->time[two] || (all->time[one] == all->time[two] && one < two);
}

// Puts a cell at a place of the heap, or nearer to its root.
static void move_up(Arrival *all, int64_t cell, int64_t place) {
    while (place > 0) {
        const int64_t parent = all->heap[(place - 1) / 2];
        if (!is_before(all, cell, parent)) break;
        all->heap[place] = parent, all->place[parent] = place;
        place = (place - 1) / 2;
    }
    all->heap[place] = cell, all->place[cell] = place;
}

// Removes the first cell of the heap.
static int64_t take_first(Arrival *all, int64_t size) {
    const int64_t first = all->heap[0], cell = all->heap[size - 1];
    int64_t place = 0;
    for (int64_t child = 1; child < size - 1; child = 2 * place + 1) {
        if (child + 1 < size - 1 && is_before(all, all->heap[child + 1], all->heap[child])) child++;
        if (!is_before(all, all->heap[child], cell)) break;
        all->heap[place] = all->heap[child], all->place[all->heap[place]] = place;
        place = child;
    }
    all->heap[place] = cell, all->place[cell] = place;
    all->place[first] = -1;
    return first;
}

// Solves the eikonal equation, the nearest cell first (Sethian 1996).
void morse_walk_arrival(Arrival *all) {
    const int64_t around[4] = {1, -1, all->width, -all->width};
    double *time = all->time;
    int64_t size = 0;
    for (int64_t i = 0; i < all->count; i++) all->place[i] = -1;
    for (int64_t i = 0; i < all->seeds; i++)
        if (all->place[all->seed[i]] < 0) move_up(all, all->seed[i], size++);
    while (size) {
        const int64_t cell = take_first(all, size--);
        for (int side = 0; side < 4; side++) {
            const int64_t next = cell + around[side];
            if (!all->is_free[next]) continue;
            const double left = time[next - 1], right = time[next + 1];
            const double below = time[next - all->width], above = time[next + all->width];
            const double a = left < right ? left : right, b = below < above ? below : above;
            const double low = a < b ? a : b, high = a < b ? b : a, step = all->slowness[next], apart = high - low;
            const double root = 2.0 * step * step - apart * apart;
            const double value = root > 0.0 && apart < step ? 0.5 * (low + high + sqrt(root)) : low + step;
            if (!(value < time[next])) continue;
            time[next] = value;
            move_up(all, next, all->place[next] < 0 ? size++ : all->place[next]);
        }
    }
}

// The distance to the edges of a polygon, m; negative within it.
static double distance_to_polygon(const Wall *all, double x, double y) {
    const double *points = all->polygon;
    const int64_t count = all->corners;
    double least = INFINITY;
    int within = count > 2;
    for (int64_t i = 0; i < count; i++) {
        const double *a = points + 2 * i, *b = points + 2 * (i + 1 < count ? i + 1 : 0);
        const double u = b[0] - a[0], v = b[1] - a[1], p = x - a[0], q = y - a[1];
        const double whole = u * u + v * v, squared = whole > 1e-12 ? whole : 1e-12;
        const double share = share_of((p * u + q * v) / squared), s = p - share * u, t = q - share * v;
        const double square = s * s + t * t;
        if (square < least) least = square;
        within = within && u * q - v * p >= 0.0;
    }
    const double distance = sqrt(least);
    return within ? -distance : distance;
}

// Shortens the distances to the nearest wall by those to a polygon.
void morse_walk_wall(Wall *all) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int64_t i = 0; i < 2 * all->corners; i++) {
        if (all->polygon[i] < low[i % 2]) low[i % 2] = all->polygon[i];
        if (all->polygon[i] > high[i % 2]) high[i % 2] = all->polygon[i];
    }
    for (int64_t row = all->first_row; row < all->last_row; row++) {
        const double y = all->origin[1] + all->cell * (double)row;
        const double v = y < low[1] ? low[1] - y : y > high[1] ? y - high[1] : 0.0;
        for (int64_t column = all->first_column; column < all->last_column; column++) {
            double *gap = all->gap + row * all->width + column;
            const double x = all->origin[0] + all->cell * (double)column;
            const double u = x < low[0] ? low[0] - x : x > high[0] ? x - high[0] : 0.0, square = u * u + v * v;
            // another wall is nearer than the box around this one; with room for rounding
            if (square > 0.0 && (*gap <= 0.0 || square > *gap * *gap * (1.0 + 1e-9))) continue;
            const double distance = distance_to_polygon(all, x, y);
            if (distance < *gap) *gap = distance;
        }
    }
}
