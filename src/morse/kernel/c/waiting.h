// Waiting for other threads, for a time too short to sleep.
#pragma once
#ifdef _WIN32
// windows.h defines `near` and `far` as macros
__declspec(dllimport) int __stdcall SwitchToThread(void);
#else
#include <sched.h>
#endif

// Number of checks before other threads may use the processor.
#define CHECKS 256

// Lets some time pass; `count` is the number of calls before.
static inline void pass_time(int count) {
    if (count >= CHECKS) {
#ifdef _WIN32
        SwitchToThread();
#else
        sched_yield();
#endif
        return;
    }
#if defined __x86_64__
    __builtin_ia32_pause();
#elif defined __aarch64__
    __asm__ volatile("yield");
#endif
}
