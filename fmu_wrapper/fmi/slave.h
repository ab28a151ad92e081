/* What the functions of FMI 2.0 and 3.0 (fmi2.c, fmi3.c) ask of an instance. There are two kinds: `../native` makes it a run
 * of the machine code (FMUs without Python), `../shim` a slave in Python.
 *
 * All but `slave_host` and `slave_new` are given an instance, and arrays and answers that are there; whether a call is
 * allowed now is theirs to say. `function` is the name of the function of FMI. Each answers with a status, and with a line in
 * the host's log unless that is OK. */
#ifndef TLISMNI_SLAVE_H
#define TLISMNI_SLAVE_H

#include "host.h"

typedef struct Slave Slave;

/* What the host asks of a new instance; the event mode and all behind it are FMI 3.0's. */
typedef struct {
    int version; /* of FMI, 2 or 3 */
    bool logging_on, event_mode, early_return;
    const uint32_t *intermediate; /* value references of the inputs that are set in intermediate updates */
    size_t intermediates;
} Asked;

typedef struct {
    bool tolerance_defined, stop_defined;
    double tolerance, start, stop; /* start and stop: s */
} Experiment;

/* How a step ended, or where the slave is if it failed (s). */
typedef struct {
    double time;
    bool event_due, early;
} StepEnd;

/* What a function takes for values other than reals and strings. `enumerations`: 0 or 1 if it is for such alone, else -1. */
typedef enum { REAL, INTEGER, BOOLEAN } Kind;
typedef struct {
    Kind kind;
    int enumerations;
    size_t size; /* of a value: 1 (bool), 4 or 8 (whole numbers), bytes */
} Type;

/* Of which outputs derivatives are asked with respect to which inputs, along which seed. */
typedef struct {
    const uint32_t *unknown;
    size_t unknowns;
    const uint32_t *known;
    size_t knowns;
    const double *seed;
    size_t seeds;
    double *sensitivity;
    size_t sensitivities;
} Question;

/* The host of an instance; NULL if `self` is none. */
Host *slave_host(const Slave *self);

/* life. `resources` is a path. NULL, with a line in the log, on failure. `host` is copied; its name
 * lives longer than the instance. */
Slave *slave_new(const Host *host, const Asked *asked, const char *function, const char *token, const char *resources);
void slave_free(Slave *self);
/* FMI 2.0 sets up before it enters initialization, with an experiment of NULL; FMI 3.0 does both at once. */
int slave_set_up(Slave *self, const char *function, const Experiment *experiment);
int slave_enter_initialization(Slave *self, const char *function, const Experiment *experiment);
int slave_exit_initialization(Slave *self, const char *function);
int slave_terminate(Slave *self, const char *function);
int slave_reset(Slave *self, const char *function);
/* The host hears other categories of the log from now on. */
int slave_log_chosen(Slave *self, const char *function, bool on, const char *const categories[], size_t count);

/* steps and events */
int slave_step(Slave *self, const char *function, double t, double h, StepEnd *end);
int slave_time(Slave *self, const char *function, double *time);
int slave_enter_event_mode(Slave *self, const char *function);
int slave_update(Slave *self, const char *function, bool *again);
int slave_enter_step_mode(Slave *self, const char *function);

/* values. Of reals there are more than references where these are of arrays; others have a value each. */
int slave_get_reals(Slave *self, const char *function, const uint32_t vr[], size_t n, double value[], size_t values);
int slave_set_reals(Slave *self, const char *function, const uint32_t vr[], size_t n, const double value[], size_t values);
int slave_get(Slave *self, const char *function, const Type *type, const uint32_t vr[], size_t n, void *value);
int slave_set(Slave *self, const char *function, const Type *type, const uint32_t vr[], size_t n, const void *value);
/* Strings stay valid until the next call of this function. */
int slave_get_strings(Slave *self, const char *function, const uint32_t vr[], size_t n, const char *value[]);
int slave_set_strings(Slave *self, const char *function, const uint32_t vr[], size_t n, const char *const value[]);

/* derivatives of outputs along inputs and back, of outputs in time, and those with which inputs go on */
int slave_directional(Slave *self, const char *function, const Question *question);
int slave_adjoint(Slave *self, const char *function, const Question *question);
int slave_output_derivatives(Slave *self, const char *function, const uint32_t vr[], size_t n, const int32_t order[],
                             double value[], size_t values);
int slave_set_rates(Slave *self, const char *function, const uint32_t vr[], size_t n, const int32_t order[],
                    const double value[]);

/* stored states: what the host holds is a handle. `slave_free_state` is given one that is not NULL. */
int slave_get_state(Slave *self, const char *function, void **state);
int slave_set_state(Slave *self, const char *function, void *state);
int slave_free_state(Slave *self, const char *function, void *state);
int slave_state_size(Slave *self, const char *function, void *state, size_t *size);
int slave_write_state(Slave *self, const char *function, void *state, void *bytes, size_t size);
int slave_read_state(Slave *self, const char *function, const void *bytes, size_t size, void **state);

#endif
