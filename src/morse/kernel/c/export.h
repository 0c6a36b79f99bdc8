// Marks the functions that Python calls. All others are static, so that the library exports nothing else.
#pragma once

#ifdef _WIN32
#define MORSE_EXPORT __declspec(dllexport)
#else
#define MORSE_EXPORT __attribute__((visibility("default")))
#endif
