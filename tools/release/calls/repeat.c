/* Repeats recorded calls with another build of the kernel, for Windows: `repeat CALLS LIBRARY`. Each page has its
 * recorded place and contents; afterwards it has to be as it was on the machine that recorded. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <windows.h>

enum { PAGE = 4096, BLOCK = 65536, PAGES = 16384, ARGUMENTS = 10 };

typedef int64_t (*Function)(int64_t, int64_t, int64_t, int64_t, int64_t, int64_t, int64_t, int64_t, int64_t, int64_t);

static uint64_t addresses[PAGES];
static char after[PAGES][PAGE], before[PAGE];

int main(int count, char **words) {
    if (count != 3) return fprintf(stderr, "usage: repeat CALLS LIBRARY\n"), 2;
    FILE *file = fopen(words[1], "rb");
    const HMODULE library = LoadLibraryA(words[2]);
    if (!file || !library) return fprintf(stderr, "%s cannot be read\n", file ? words[2] : words[1]), 2;
    char name[32];
    int64_t numbers[3], a[ARGUMENTS];
    int calls = 0, errors = 0;
    while (fread(name, sizeof name, 1, file) == 1) {
        if (fread(numbers, sizeof numbers, 1, file) != 1 || fread(a, sizeof a, 1, file) != 1) return 2;
        for (int64_t i = 0; i < numbers[0]; i++) {
            if (fread(&addresses[i], 8, 1, file) != 1 || fread(before, PAGE, 1, file) != 1) return 2;
            if (fread(after[i], PAGE, 1, file) != 1) return 2;
            VirtualAlloc((void *)(addresses[i] & ~(uint64_t)(BLOCK - 1)), BLOCK, MEM_RESERVE, PAGE_READWRITE);
            if (!VirtualAlloc((void *)addresses[i], PAGE, MEM_COMMIT, PAGE_READWRITE))
                return fprintf(stderr, "no memory at %p\n", (void *)addresses[i]), 2;
            memcpy((void *)addresses[i], before, PAGE);
        }
        const Function function = (Function)(void *)GetProcAddress(library, name);
        if (!function) return fprintf(stderr, "%s is missing\n", name), 2;
        const int64_t result = function(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8], a[9]);
        int different = numbers[1] && (int32_t)result != numbers[2];
        for (int64_t i = 0; i < numbers[0]; i++) different |= memcmp((void *)addresses[i], after[i], PAGE) != 0;
        if (different) printf("%s: other bits in call %d\n", name, calls);
        calls++, errors += different;
    }
    printf("%d calls, %d with other bits\n", calls, errors);
    return errors || !calls;
}
