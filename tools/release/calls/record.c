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

enum { PAGE = 4096, REGIONS = 4096, PAGES = 16384, ARGUMENTS = 10, CALLS = 12 };

typedef int64_t (*Function)(int64_t, int64_t, int64_t, int64_t, int64_t, int64_t, int64_t, int64_t, int64_t, int64_t);

static struct {
    uint64_t begin, end;
} regions[REGIONS];
static uint64_t touched[PAGES];
static char (*before)[PAGE], *other_stack;
static int region_count, page_count, is_recording;

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
    for (int i = 0; i < region_count; i++) is_ours |= regions[i].begin <= page && page < regions[i].end;
    if (!is_ours || page_count == PAGES || protect(page, PAGE, PROT_READ | PROT_WRITE)) end_process();
    touched[page_count] = page;
    void *to = before[page_count++];
    const void *from = (const void *)page;
    uint64_t bytes = PAGE;
    __asm__ volatile("rep movsb" : "+D"(to), "+S"(from), "+c"(bytes) : : "memory");
}

/* The writable memory of the process but for its stacks, this library and the real kernel. */
static void find_regions(const char *own, const char *real) {
    FILE *file = fopen("/proc/self/maps", "re");
    char line[1024];
    region_count = 0;
    while (file && fgets(line, sizeof line, file) && region_count < REGIONS - 1) {
        uint64_t begin, end;
        char rights[8];
        if (sscanf(line, "%lx-%lx %7s", &begin, &end, rights) != 3 || strncmp(rights, "rw-", 3)) continue;
        const uint64_t used[] = {
            (uint64_t)line,          (uint64_t)other_stack,
            (uint64_t)before,        (uint64_t)&before,
            (uint64_t)regions,       (uint64_t)(regions + REGIONS) - 1,
            (uint64_t)touched,       (uint64_t)(touched + PAGES) - 1,
            (uint64_t)&region_count, (uint64_t)&page_count,
        };
        int is_used = strstr(line, own) || strstr(line, real) || strstr(line, "[stack") || strstr(line, "[v");
        for (size_t i = 0; i < sizeof used / sizeof *used; i++) is_used |= begin <= used[i] && used[i] < end;
        if (is_used) continue;
        // the system itself writes to the variables of a thread
        const uint64_t thread = (uint64_t)pthread_self() & ~(uint64_t)(PAGE - 1);
        if (begin <= thread && thread < end) {
            if (begin < thread - PAGE) regions[region_count].begin = begin, regions[region_count++].end = thread - PAGE;
            begin = thread + 2 * PAGE;
        }
        if (begin < end) regions[region_count].begin = begin, regions[region_count++].end = end;
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
    if (is_recording || *calls >= CALLS || !is_single())
        return function(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8], a[9]);
    is_recording = 1, ++*calls;
    if (!output) {
        output = open(path, O_WRONLY | O_CREAT | O_APPEND, 0600);
        before = reserve((size_t)PAGES * PAGE);
        other_stack = reserve(1 << 20);
    }
    Dl_info own;
    dladdr((void *)pass, &own);
    const stack_t stack = {.ss_sp = other_stack, .ss_size = 1 << 20};
    stack_t old_stack;
    struct sigaction action = {.sa_sigaction = touch, .sa_flags = SA_SIGINFO | SA_ONSTACK | SA_NODEFER}, old;
    sigaltstack(&stack, &old_stack);
    sigaction(SIGSEGV, &action, &old);
    page_count = 0;
    find_regions(own.dli_fname, real);
    for (int i = 0; i < region_count; i++) protect(regions[i].begin, regions[i].end - regions[i].begin, PROT_NONE);
    const int64_t result = function(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8], a[9]);
    for (int i = 0; i < region_count; i++)
        protect(regions[i].begin, regions[i].end - regions[i].begin, PROT_READ | PROT_WRITE);
    sigaction(SIGSEGV, &old, NULL);
    sigaltstack(&old_stack, NULL);
    char title[32] = {0};
    snprintf(title, sizeof title, "%s", name);
    const int64_t numbers[] = {page_count, has_result, (int32_t)result};
    put(output, title, sizeof title);
    put(output, numbers, sizeof numbers);
    put(output, a, ARGUMENTS * sizeof *a);
    for (int i = 0; i < page_count; i++) {
        put(output, &touched[i], sizeof *touched);
        put(output, before[i], PAGE);
        put(output, (void *)touched[i], PAGE);
    }
    is_recording = 0;
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
