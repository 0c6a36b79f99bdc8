// Marks the functions that Python calls. Everything else is static: the library exports nothing by accident.
#pragma once

#ifdef _WIN32
#define MORSE_EXPORT __declspec(dllexport)
#else
#define MORSE_EXPORT __attribute__((visibility("default")))
#endif
