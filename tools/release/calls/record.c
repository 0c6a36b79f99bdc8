/* A kernel that passes each call on to the real one, and writes the first calls of each function to a file: arguments,
 * and the contents of all pages of memory that the call touches, before and after. Linux on x86-64; one thread.
 *
 * Before a call, all writable memory but the stack is protected. The handler of the faults copies the touched page and
 * releases it. Between protection and release only this file's own code runs: library code has data of its own. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { PAGE = 4096, STACK = 1 << 20, REGIONS = 4096, PAGES = 16384, ARGUMENTS = 10, CALLS = 12 };

typedef int64_t (*Function)(int64_t, int64_t, int64_t, int64_t, int64_t, int64_t, int64_t, int64_t, int64_t, int64_t);

/* all that this file uses while memory is protected */
static struct {
    struct {
        uint64_t begin, end;
    } regions[REGIONS];
    uint64_t touched[PAGES];
    char (*before)[PAGE], *other_stack;
    int region_count, page_count, is_recording;
} store;

static int64_t protect(uint64_t begin, uint64_t size, uint64_t rights) {
    int64_t result;
    __asm__ volatile("syscall"
                     : "=a"(result)
                     : "a"(SYS_mprotect), "D"(begin), "S"(size), "d"(rights)
                     : "rcx", "r11", "memory");
    return result;
}

static void end_process(void) { __asm__ volatile("syscall" : : "a"(SYS_exit_group), "D"(99) : "rcx", "r11", "memory"); }

static void touch(int number, siginfo_t *info, void *context) {
    (void)number, (void)context;
    const uint64_t page = (uint64_t)info->si_addr & ~(uint64_t)(PAGE - 1);
    int is_ours = 0;
    for (int i = 0; i < store.region_count; i++)
        is_ours |= store.regions[i].begin <= page && page < store.regions[i].end;
    if (!is_ours || store.page_count == PAGES || protect(page, PAGE, PROT_READ | PROT_WRITE)) end_process();
    store.touched[store.page_count] = page;
    void *to = store.before[store.page_count++];
    const void *from = (const void *)page;
    uint64_t bytes = PAGE;
    __asm__ volatile("rep movsb" : "+D"(to), "+S"(from), "+c"(bytes) : : "memory");
}

enum { HOLES = 4 };

/* Add a region without the pages of the holes from a number on. */
static void add(uint64_t begin, uint64_t end, const uint64_t (*holes)[2], int hole) {
    for (; hole < HOLES; hole++) {
        const uint64_t first = holes[hole][0] & ~(uint64_t)(PAGE - 1), last = (holes[hole][1] | (PAGE - 1)) + 1;
        if (end <= first || last <= begin) continue;
        add(begin, first, holes, hole + 1);
        begin = last;
    }
    if (begin >= end || store.region_count == REGIONS) return;
    store.regions[store.region_count].begin = begin;
    store.regions[store.region_count++].end = end;
}

/* The writable memory of the process but for its stack, what this file uses, and the real kernel. */
static void find_regions(const char *own, const char *real) {
    FILE *file = fopen("/proc/self/maps", "re");
    char line[1024];
    // the system itself writes to the variables of a thread
    const uint64_t thread = (uint64_t)pthread_self();
    const uint64_t holes[HOLES][2] = {
        {thread, thread + 0xb00},
        {(uint64_t)store.before, (uint64_t)store.before + (uint64_t)PAGES * PAGE - 1},
        {(uint64_t)store.other_stack, (uint64_t)store.other_stack + STACK - 1},
        {(uint64_t)&store, (uint64_t)&store + sizeof store - 1},
    };
    store.region_count = 0;
    while (file && fgets(line, sizeof line, file)) {
        uint64_t begin, end;
        char rights[8];
        if (sscanf(line, "%lx-%lx %7s", &begin, &end, rights) != 3 || strncmp(rights, "rw-", 3)) continue;
        if (strstr(line, own) || strstr(line, real) || strstr(line, "[stack") || strstr(line, "[v")) continue;
        add(begin, end, holes, 0);
    }
    if (file) fclose(file);
}

/* Memory that is in no region of others. */
static void *reserve(size_t size) {
    char *all = mmap(NULL, size + 2 * PAGE, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    mprotect(all + PAGE, size, PROT_READ | PROT_WRITE);
    return all + PAGE;
}

// A FILE would change the heap that it writes.
static void put(int file, const void *data, size_t size) {
    if (write(file, data, size) != (ssize_t)size) abort();
}

static int is_single(void) {
    char text[4096] = "";
    FILE *file = fopen("/proc/self/status", "re");
    const size_t size = file ? fread(text, 1, sizeof text - 1, file) : 0;
    if (file) fclose(file);
    text[size] = 0;
    const char *at = strstr(text, "Threads:");
    return at && atoi(at + 8) == 1;
}

static int64_t pass(const char *name, int has_result, int *calls, const int64_t a[ARGUMENTS]) {
    static void *kernel;
    static int output;
    const char *real = getenv("MORSE_RECORDED_KERNEL"), *path = getenv("MORSE_RECORDED_CALLS");
    if (!kernel) kernel = dlopen(real, RTLD_NOW);
    const Function function = kernel ? (Function)dlsym(kernel, name) : NULL;
    if (!function) abort();
    if (store.is_recording || *calls >= CALLS || !is_single())
        return function(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8], a[9]);
    store.is_recording = 1, ++*calls;
    if (!output) {
        output = open(path, O_WRONLY | O_CREAT | O_APPEND, 0600);
        store.before = reserve((size_t)PAGES * PAGE);
        store.other_stack = reserve(STACK);
    }
    Dl_info own;
    dladdr((void *)pass, &own);
    const stack_t stack = {.ss_sp = store.other_stack, .ss_size = STACK};
    stack_t old_stack;
    struct sigaction action = {.sa_sigaction = touch, .sa_flags = SA_SIGINFO | SA_ONSTACK | SA_NODEFER}, old;
    sigaltstack(&stack, &old_stack);
    sigaction(SIGSEGV, &action, &old);
    store.page_count = 0;
    find_regions(own.dli_fname, real);
    for (int i = 0; i < store.region_count; i++)
        protect(store.regions[i].begin, store.regions[i].end - store.regions[i].begin, PROT_NONE);
    const int64_t result = function(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8], a[9]);
    for (int i = 0; i < store.region_count; i++)
        protect(store.regions[i].begin, store.regions[i].end - store.regions[i].begin, PROT_READ | PROT_WRITE);
    sigaction(SIGSEGV, &old, NULL);
    sigaltstack(&old_stack, NULL);
    char title[32] = {0};
    snprintf(title, sizeof title, "%s", name);
    const int64_t numbers[] = {store.page_count, has_result, (int32_t)result};
    put(output, title, sizeof title);
    put(output, numbers, sizeof numbers);
    put(output, a, ARGUMENTS * sizeof *a);
    for (int i = 0; i < store.page_count; i++) {
        put(output, &store.touched[i], sizeof *store.touched);
        put(output, store.before[i], PAGE);
        put(output, (void *)store.touched[i], PAGE);
    }
    store.is_recording = 0;
    return result;
}

#define FUNCTION(name, has_result)                                                                                  \
    int64_t name(int64_t a, int64_t b, int64_t c, int64_t d, int64_t e, int64_t f, int64_t g, int64_t h, int64_t i, \
                 int64_t j) {                                                                                       \
        static int calls;                                                                                           \
        const int64_t all[ARGUMENTS] = {a, b, c, d, e, f, g, h, i, j};                                              \
        return pass(#name, has_result, &calls, all);                                                                \
    }
#include "functions.h"
