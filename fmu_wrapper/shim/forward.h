/* From C calls to the methods of the same names in Python, for FMI 2.0 and 3.0 alike. */
#ifndef TLISMNI_FORWARD_H
#define TLISMNI_FORWARD_H

#include "instance.h"

/* Return the status of a method; its arguments are made with Python's lock. */
#define FORWARD(c, method, ...)                                   \
    do {                                                          \
        int gil;                                                  \
        if (!instance_enter(c, &gil)) {                           \
            return STATUS_ERROR;                                  \
        }                                                         \
        int status = instance_status(c, method, __VA_ARGS__);     \
        python_leave(gil);                                        \
        return status;                                            \
    } while (0)

#define IN(array, count) view_of(array, count, sizeof *(array))
#define OUT(array, count) writable_view_of(array, count, sizeof *(array))
/* A stored state is a number to the host, not an address. */
#define HANDLE(state) ((unsigned long long)(uintptr_t)(state))

/* Reals, most of the time without Python; `values` is their number, that of the references for FMI 2.0. */
int forward_get_reals(Instance *c, const char *method, const unsigned vr[], size_t n, double value[], size_t values);
int forward_set_reals(Instance *c, const char *method, const unsigned vr[], size_t n, const double value[],
                      size_t values);

/* A step from `time`, if the Python side shares what that takes: its status, and the answer says how it ended. NULL:
 * nothing has been done. */
const Shared *forward_step(Instance *c, const char *method, double time, double step, int *status);

/* Whether the host has given something to answer into; if not, its log says so. */
bool forward_has_room(const Instance *c, const char *method, const void *room);

/* Strings into `value`; they stay valid until the next call of this function, the instance keeps their bytes. */
int forward_get_strings(Instance *c, const char *method, const unsigned vr[], size_t n, const char *value[]);

/* Stored states: a handle for a new one, an old one freed, its size in bytes, one made from bytes. */
int forward_get_state(Instance *c, const char *method, void **state);
int forward_free_state(Instance *c, const char *method, void **state);
int forward_state_size(Instance *c, const char *method, void *state, size_t *size);
int forward_read_state(Instance *c, const char *method, const void *bytes, size_t size, void **state);

#endif
