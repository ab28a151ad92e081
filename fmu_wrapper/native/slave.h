/* A native FMU's instance: a run (`tlismni.h`), the variables that the model description lists, and where in its life it
 * is. FMI 2.0 and 3.0 differ in the names and types of their functions only (fmi2.c, fmi3.c). */
#ifndef TLISMNI_SLAVE_H
#define TLISMNI_SLAVE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tlismni.h"

#define EXPORT TLISMNI_API
#if defined _WIN32
#define PRINTF_LIKE(text, first)
#else
#define PRINTF_LIKE(text, first) __attribute__((format(printf, text, first)))
#endif

/* Status numbers of FMI 2.0 and 3.0. */
typedef enum { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR, STATUS_FATAL } Status;

typedef enum { INSTANTIATED, INITIALIZATION, STEP_MODE, INTERMEDIATE, EVENT_DUE, EVENT_MODE, FAILED, TERMINATED } Phase;

enum { LOG_EVENTS, LOG_WARNING, LOG_DISCARD, LOG_ERROR, LOG_COMPILATION, LOG_TRACEBACK, LOG_ALL, LOG_CATEGORIES };

/* What a variable's values are, and where they come from (`variable_file.py`). */
typedef enum { REAL, INTEGER, BOOLEAN } Kind;
typedef enum { TIME, CONSTANT, INPUT, PARAMETER, CHANNEL, EVENT_COUNT } Source;
typedef struct {
    int32_t kind, source, enumeration, number;
    double start, least, largest;
} Variable;

/* An array: its elements are variables (`elements` of the slave). */
typedef struct {
    int32_t first, count;
} ArrayOf;

typedef struct Slave Slave;

/* Hands one message to the host, in the manner of the FMI version. */
typedef void (*HostLogger)(const Slave *, int status, const char *category, const char *message);

/* Intermediate update at `time` (FMI 3.0): true if the host wants the step to end at `*end`. */
typedef bool (*HostUpdate)(const Slave *, double time, bool may_end_early, double *end);

typedef struct Stored {
    struct Stored *next;
    Phase phase;
    double stop;
    size_t room;  /* bytes of: */
    char saved[]; /* what `tlismni_save` writes */
} Stored;

struct Slave {
    unsigned magic;
    HostLogger log;
    void (*logger)(void); /* the host's callback, of the type that `log` knows; NULL for none */
    void *environment;
    HostUpdate update;      /* NULL: no intermediate updates */
    void (*updater)(void);  /* the host's callback, of the type that `update` knows */
    uint32_t *intermediate; /* value references of the inputs that are set in these */
    size_t intermediates;
    char *name;
    unsigned heard; /* bits of the log categories */
    bool event_mode, early_return;
    Phase phase;
    double start, stop; /* s; no stop is infinity */
    bool fresh;  /* the channels that the run reads are those of the present time and inputs */
    bool asked;  /* outputs have been asked for since the last step: */
    size_t *wanted;  /* these channels, each once: the first `wants` */
    size_t wants;
    bool *is_wanted; /* of each channel, whether it is among them */
    tlismni_model *model;
    tlismni_run *run;
    double *parameters; /* values, behind them room for those before, for the inputs and their derivatives */
    double *room;       /* for derivatives; NULL until they are asked for */
    void *file; /* the variables' */
    const Variable *variables;
    size_t count;
    const ArrayOf *arrays; /* which have the references behind those of the variables */
    size_t array_count;
    const uint32_t *elements;
    double rtol;
    Stored *stored;
};

/* How a step ended. */
typedef struct {
    double time;
    bool event_due, early;
} StepEnd;

/* life (slave.c). `given` is copied: it has what concerns the log. NULL, with a line in the host's log, on failure. */
Slave *slave_new(const Slave *given, const char *function, const char *name, const char *token, const char *resources,
                 bool logging_on);
void slave_free(Slave *self);
bool slave_alive(const Slave *self);
int slave_set_up(Slave *self, const char *function, bool tolerance_defined, double tolerance, double start,
                 bool stop_defined, double stop);
int slave_enter_initialization(Slave *self, const char *function);
int slave_exit_initialization(Slave *self, const char *function);
int slave_terminate(Slave *self, const char *function);
int slave_reset(Slave *self, const char *function);

/* steps and events (steps.c) */
int slave_step(Slave *self, const char *function, double t, double h, StepEnd *end);
int slave_enter_event_mode(Slave *self, const char *function);
int slave_update(Slave *self, const char *function, bool *again);
int slave_enter_step_mode(Slave *self, const char *function);

/* values (values.c): of reals, whole numbers and truth values; `enumerations`: 0 or 1 if only such may be asked, else -1 */
int slave_get_reals(Slave *self, const char *function, const uint32_t vr[], size_t n, double value[]);
int slave_get_wholes(Slave *self, const char *function, Kind kind, int enumerations, const uint32_t vr[], size_t n,
                     int64_t value[]);
int slave_set_reals(Slave *self, const char *function, const uint32_t vr[], size_t n, const double value[]);
/* Derivatives in time, of first or second order, with which inputs go on. */
int slave_set_rates(Slave *self, const char *function, const uint32_t vr[], size_t n, const int32_t order[],
                    const double value[]);
/* Parameters and start time as the run has them, after it has been restarted or restored. */
void slave_take_parameters(Slave *self);
/* None but reals can be set: says so. */
int slave_set_others(Slave *self, const char *function, const uint32_t vr[], size_t n);

/* References with those of the elements in place of arrays (arrays.c), and the orders that belong to them. */
typedef struct {
    const uint32_t *vr;
    const int32_t *order;
    size_t n;
    uint32_t *made; /* what `slave_elements_end` frees */
    int32_t *orders;
} Elements;
/* `order` may be NULL. False, with a line in the log, without memory. */
bool slave_elements(const Slave *self, const char *function, const uint32_t vr[], size_t n, const int32_t order[],
                    Elements *found);
void slave_elements_end(Elements *found);

/* What a reference of this kind stands for; NULL with a line in the log. */
const Variable *slave_variable(const Slave *self, const char *function, uint32_t reference, Kind kind);
/* Have all channels at the present time with the present inputs. */
int slave_look_at_all(Slave *self, const char *function);
/* Let the run read only what has been asked for since this was last called. */
void slave_want_what_was_asked(Slave *self);

/* derivatives (derivatives.c) */
int slave_directional(Slave *self, const char *function, const uint32_t unknown[], size_t unknowns, const uint32_t known[],
                      size_t knowns, const double seed[], double sensitivity[]);
int slave_adjoint(Slave *self, const char *function, const uint32_t unknown[], size_t unknowns, const uint32_t known[],
                  size_t knowns, const double seed[], double sensitivity[]);
int slave_output_derivatives(Slave *self, const char *function, const uint32_t vr[], size_t n, const int32_t order[],
                             double value[]);

/* states (states.c) */
int slave_get_state(Slave *self, const char *function, void **state);
int slave_set_state(Slave *self, const char *function, void *state);
int slave_free_state(Slave *self, const char *function, void **state);
int slave_state_size(Slave *self, const char *function, void *state, size_t *size);
int slave_write_state(Slave *self, const char *function, void *state, void *bytes, size_t size);
int slave_read_state(Slave *self, const char *function, const void *bytes, size_t size, void **state);
void slave_forget_states(Slave *self);

/* log (log.c) */
int slave_choose_log(Slave *self, const char *function, bool on, const char *const categories[], size_t count);
void slave_say(const Slave *self, int status, int category, const char *format, ...) PRINTF_LIKE(4, 5);
/* Log an error "function: what is wrong" and answer with its status. */
int slave_error(const Slave *self, const char *function, const char *format, ...) PRINTF_LIKE(3, 4);
/* The same for a function that this FMU has not. */
int slave_refuses(const Slave *self, const char *function);
/* The same for a status of the run. */
int slave_run_error(Slave *self, const char *function, int status);
/* The same for a parameter that the run does not take: names the one that excludes it. */
int slave_not_set(Slave *self, const char *function, size_t number, int status);
/* Log an error unless `self` is in one of `phases` (bits); false then, or if it is no instance. */
bool slave_may(const Slave *self, const char *function, unsigned phases);
bool slave_has_room(const Slave *self, const char *function, const void *room, size_t n);
void slave_log_events(Slave *self);

#define IN(phase) (1u << (phase))

#endif
