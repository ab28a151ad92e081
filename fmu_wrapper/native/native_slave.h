/* The instance of an FMU that needs no Python: a run (`tlismni.h`), the variables that the model description lists, and
 * where in its life it is. */
#ifndef TLISMNI_NATIVE_SLAVE_H
#define TLISMNI_NATIVE_SLAVE_H

#include "../fmi/slave.h"
#include "tlismni.h"

typedef enum { INSTANTIATED, INITIALIZATION, STEP_MODE, INTERMEDIATE, EVENT_DUE, EVENT_MODE, FAILED, TERMINATED } Phase;

/* Where a variable's values come from (`native_export.py`). */
typedef enum { TIME, CONSTANT, INPUT, PARAMETER, CHANNEL, EVENT_COUNT } Source;
typedef struct {
    int32_t kind, source, enumeration, number;
    double start, least, largest;
} Variable;

/* An array: its elements are variables (`elements` of the slave). */
typedef struct {
    int32_t first, count;
} ArrayOf;

typedef struct Stored {
    struct Stored *next;
    Phase phase;
    double stop;
    size_t room;  /* bytes of: */
    char saved[]; /* what `tlismni_save` writes */
} Stored;

struct Slave {
    unsigned magic;
    Host host;
    uint32_t *intermediate; /* value references of the inputs that are set in intermediate updates */
    size_t intermediates;
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

/* Parameters and start time as the run has them, after it has been restarted or restored. */
void native_take_parameters(Slave *self);

/* References with those of the elements in place of arrays (arrays.c), and the orders that belong to them. */
typedef struct {
    const uint32_t *vr;
    const int32_t *order;
    size_t n;
    uint32_t *made; /* what `native_elements_end` frees */
    int32_t *orders;
} Elements;
/* `order` may be NULL. False, with a line in the log, without memory, or unless there are `values` of them. */
bool native_elements(const Slave *self, const char *function, const uint32_t vr[], size_t n, const int32_t order[],
                     size_t values, Elements *found);
void native_elements_end(Elements *found);

/* What a reference of this kind stands for; NULL with a line in the log. */
const Variable *native_variable(const Slave *self, const char *function, uint32_t reference, Kind kind);
/* Have all channels at the present time with the present inputs. */
int native_look_at_all(Slave *self, const char *function);
/* Let the run read only what has been asked for since this was last called. */
void native_want_what_was_asked(Slave *self);

void native_forget_states(Slave *self);

/* what the host is told (messages.c) */

/* Log an error "function: what is wrong" and answer with its status. */
#define native_error(self, ...) host_error(&(self)->host, __VA_ARGS__)
/* The same for a status of the run. */
int native_run_error(Slave *self, const char *function, int status);
/* The same for a parameter that the run does not take: names the one that excludes it. */
int native_not_set(Slave *self, const char *function, size_t number, int status);
/* Log an error unless `self` is in one of `phases` (bits); false then. */
bool native_may(const Slave *self, const char *function, unsigned phases);
void native_log_events(Slave *self);

#define IN(phase) (1u << (phase))

#endif
