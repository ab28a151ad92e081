/* What fmi2.c and fmi3.c have in common: how functions are shown, and arguments checked. */
#ifndef TLISMNI_FUNCTIONS_H
#define TLISMNI_FUNCTIONS_H

#include "slave.h"

/* The library of machine code shows its functions by visibility on Windows too: `dllexport` would hide compiled ones, which
 * do not say it. The shim has no others. */
#if defined _WIN32 && defined TLISMNI_SHIM
#define EXPORT __declspec(dllexport)
#elif defined _MSC_VER && !defined __clang__
#define EXPORT
#else
#define EXPORT __attribute__((visibility("default")))
#endif

/* The answer of a call, if `ready`. */
#define IF(ready, call) ((ready) ? (call) : STATUS_ERROR)

/* False, with a line in the log, unless an instance was given, and an array or answer for `count` items. */
bool are_given(const Slave *c, const char *function, const void *items, size_t count);
bool is_given(const Slave *c, const char *function, const void *answer);
bool both_given(const Slave *c, const char *function, const void *references, const void *values, size_t count);

/* False, with a line in the log, unless there is room for a value of each of `n` scalars. */
bool is_of_length(const Slave *c, const char *function, size_t n, size_t values);

/* Whether all that belongs to a question was given. */
bool is_complete(const Slave *c, const char *function, const Question *question);

/* A new instance; NULL, with a line in the log, on failure. */
Slave *instantiate(Host *host, const Asked *asked, const char *function, const char *name, const char *token,
                   const char *resource_location);

/* Free an instance, unless it is none or at work. */
void free_instance(Slave *c, const char *function);

int choose_log(Slave *c, const char *function, bool on, const char *const categories[], size_t count);

/* Forget a stored state; NULL is allowed. */
int free_state(Slave *c, const char *function, void **state);

#endif
