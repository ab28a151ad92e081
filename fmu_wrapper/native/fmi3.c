/* The functions of FMI 3.0 that an FMU without Python has: co-simulation with events. Others: fmi3_refused.c. */

#include "slave.h"

#include <math.h>

typedef Slave *fmi3Instance;
typedef uint32_t fmi3ValueReference;
typedef const char *fmi3String;
typedef int fmi3Status;

typedef void (*fmi3LogMessageCallback)(void *, fmi3Status, fmi3String, fmi3String);
typedef void (*fmi3IntermediateUpdateCallback)(void *, double, bool, bool, bool, bool, bool *, double *);

static void log_to_host(const Slave *self, int status, const char *category, const char *message) {
    if (self->logger) {
        ((fmi3LogMessageCallback)self->logger)(self->environment, status, category, message);
    }
}

static bool update_of_host(const Slave *self, double time, bool may_end_early, double *end) {
    bool wanted = false;
    *end = time;
    ((fmi3IntermediateUpdateCallback)self->updater)(self->environment, time, true, true, true, may_end_early, &wanted, end);
    return may_end_early && wanted;
}

static Slave given_by(void *environment, fmi3LogMessageCallback logger) {
    Slave given = {0};
    given.log = log_to_host;
    given.logger = (void (*)(void))logger;
    given.environment = environment;
    return given;
}

EXPORT const char *fmi3GetVersion(void) {
    return "3.0";
}

EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance c, bool on, size_t count, const fmi3String categories[]) {
    return slave_choose_log(c, "fmi3SetDebugLogging", on, categories, count);
}

/* life */

EXPORT fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, bool visible,
                                                bool logging_on, bool event_mode, bool early_return,
                                                const fmi3ValueReference intermediate[], size_t intermediates,
                                                void *environment, fmi3LogMessageCallback logger,
                                                fmi3IntermediateUpdateCallback update) {
    (void)visible; /* there is nothing to show */
    Slave given = given_by(environment, logger);
    given.event_mode = event_mode;
    given.early_return = early_return;
    given.update = update ? update_of_host : NULL;
    given.updater = (void (*)(void))update;
    given.intermediate = (uint32_t *)(uintptr_t)intermediate; /* copied, not written into */
    given.intermediates = intermediate ? intermediates : 0;
    return slave_new(&given, "fmi3InstantiateCoSimulation", name, token, resources, logging_on);
}

EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, bool visible,
                                                 bool logging_on, void *environment, fmi3LogMessageCallback logger) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging_on;
    Slave given = given_by(environment, logger);
    slave_error(&given, "fmi3InstantiateModelExchange", "this FMU does co-simulation only");
    return NULL;
}

EXPORT fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources, bool visible,
                                                      bool logging_on, void *environment, fmi3LogMessageCallback logger,
                                                      void (*update)(void *), void (*lock)(void), void (*unlock)(void)) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging_on, (void)update, (void)lock, (void)unlock;
    Slave given = given_by(environment, logger);
    slave_error(&given, "fmi3InstantiateScheduledExecution", "this FMU does co-simulation only");
    return NULL;
}

EXPORT void fmi3FreeInstance(fmi3Instance c) {
    slave_free(c);
}

EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance c, bool tolerance_defined, double tolerance, double start,
                                              bool stop_defined, double stop) {
    int status = slave_set_up(c, "fmi3EnterInitializationMode", tolerance_defined, tolerance, start, stop_defined, stop);
    return status == STATUS_OK ? slave_enter_initialization(c, "fmi3EnterInitializationMode") : status;
}

EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
    return slave_exit_initialization(c, "fmi3ExitInitializationMode");
}

EXPORT fmi3Status fmi3Terminate(fmi3Instance c) {
    return slave_terminate(c, "fmi3Terminate");
}

EXPORT fmi3Status fmi3Reset(fmi3Instance c) {
    return slave_reset(c, "fmi3Reset");
}

/* values */

/* A value for each scalar, those of arrays too. */
static bool of_one_length(fmi3Instance c, const char *function, size_t n, size_t values) {
    if (slave_alive(c) && n != values) {
        slave_error(c, function, "room for %zu values was given for %zu scalars", values, n);
        return false;
    }
    return true;
}

EXPORT fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, double value[], size_t values) {
    Elements e;
    int status = STATUS_ERROR;
    if (slave_elements(c, "fmi3GetFloat64", vr, n, NULL, &e) && of_one_length(c, "fmi3GetFloat64", e.n, values)) {
        status = slave_get_reals(c, "fmi3GetFloat64", e.vr, e.n, value);
    }
    slave_elements_end(&e);
    return status;
}

EXPORT fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const double value[],
                                 size_t values) {
    Elements e;
    int status = STATUS_ERROR;
    if (slave_elements(c, "fmi3SetFloat64", vr, n, NULL, &e) && of_one_length(c, "fmi3SetFloat64", e.n, values)) {
        status = slave_set_reals(c, "fmi3SetFloat64", e.vr, e.n, value);
    }
    slave_elements_end(&e);
    return status;
}

#define WHOLE(name, type, kind, enumerations)                                                                           \
    EXPORT fmi3Status fmi3Get##name(fmi3Instance c, const fmi3ValueReference vr[], size_t n, type value[],              \
                                    size_t values) {                                                                    \
        if (!of_one_length(c, "fmi3Get" #name, n, values) ||                                                            \
            (slave_alive(c) && !slave_has_room(c, "fmi3Get" #name, value, n))) {                                        \
            return STATUS_ERROR;                                                                                        \
        }                                                                                                               \
        for (size_t k = 0; k < n || !k; k++) {                                                                          \
            int64_t found = 0;                                                                                          \
            int status = slave_get_wholes(c, "fmi3Get" #name, kind, enumerations, vr ? vr + k : NULL, n > 0, &found);   \
            if (status != STATUS_OK || !n) {                                                                            \
                return status;                                                                                          \
            }                                                                                                           \
            value[k] = (type)found;                                                                                     \
        }                                                                                                               \
        return STATUS_OK;                                                                                               \
    }                                                                                                                   \
    EXPORT fmi3Status fmi3Set##name(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const type value[],        \
                                    size_t values) {                                                                    \
        (void)value, (void)values;                                                                                      \
        return slave_set_others(c, "fmi3Set" #name, vr, n);                                                             \
    }

WHOLE(Int32, int32_t, INTEGER, 0)
WHOLE(Int64, int64_t, INTEGER, 1) /* enumerations */
WHOLE(Boolean, bool, BOOLEAN, -1)

EXPORT fmi3Status fmi3GetString(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3String value[], size_t values) {
    (void)vr, (void)value;
    if (!slave_may(c, "fmi3GetString", ~0u)) {
        return STATUS_ERROR;
    }
    return n || values ? slave_error(c, "fmi3GetString", "this FMU has no strings") : STATUS_OK;
}

EXPORT fmi3Status fmi3SetString(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3String value[],
                                size_t values) {
    (void)value, (void)values;
    return slave_set_others(c, "fmi3SetString", vr, n);
}

/* states */

EXPORT fmi3Status fmi3GetFMUState(fmi3Instance c, void **state) {
    return slave_get_state(c, "fmi3GetFMUState", state);
}

EXPORT fmi3Status fmi3SetFMUState(fmi3Instance c, void *state) {
    return slave_set_state(c, "fmi3SetFMUState", state);
}

EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance c, void **state) {
    return slave_free_state(c, "fmi3FreeFMUState", state);
}

EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, void *state, size_t *size) {
    return slave_state_size(c, "fmi3SerializedFMUStateSize", state, size);
}

EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance c, void *state, uint8_t bytes[], size_t size) {
    return slave_write_state(c, "fmi3SerializeFMUState", state, bytes, size);
}

EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const uint8_t bytes[], size_t size, void **state) {
    return slave_read_state(c, "fmi3DeserializeFMUState", bytes, size, state);
}

/* steps and events */

EXPORT fmi3Status fmi3DoStep(fmi3Instance c, double time, double step, bool no_set_state, bool *event_handling_needed,
                             bool *terminate, bool *early_return, double *last_successful_time) {
    (void)no_set_state; /* a stored state lives until it is freed */
    if (!(event_handling_needed && terminate && early_return && last_successful_time)) {
        return slave_may(c, "fmi3DoStep", ~0u)
                   ? slave_error(c, "fmi3DoStep", "NULL was given for an answer: pass the address of a variable")
                   : STATUS_ERROR;
    }
    *event_handling_needed = *terminate = *early_return = false;
    if (!slave_alive(c)) {
        return STATUS_ERROR;
    }
    *last_successful_time = tlismni_time(c->run);
    StepEnd end = {*last_successful_time, false, false};
    int status = slave_step(c, "fmi3DoStep", time, step, &end);
    *event_handling_needed = end.event_due;
    *early_return = end.early;
    *last_successful_time = end.time;
    return status;
}

EXPORT fmi3Status fmi3EnterEventMode(fmi3Instance c) {
    return slave_enter_event_mode(c, "fmi3EnterEventMode");
}

EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, bool *again, bool *terminate, bool *nominals_changed,
                                           bool *values_changed, bool *next_event_defined, double *next_event) {
    bool *flags[] = {again, terminate, nominals_changed, values_changed, next_event_defined};
    bool more = false;
    for (int k = 0; k < 5; k++) {
        if (flags[k]) {
            *flags[k] = false;
        }
    }
    if (next_event) {
        *next_event = 0.0; /* the next one is not known before it comes */
    }
    if (slave_alive(c) && !slave_has_room(c, "fmi3UpdateDiscreteStates", again, 1)) {
        return STATUS_ERROR;
    }
    int status = slave_update(c, "fmi3UpdateDiscreteStates", &more);
    if (again) {
        *again = more;
    }
    return status;
}

EXPORT fmi3Status fmi3EnterStepMode(fmi3Instance c) {
    return slave_enter_step_mode(c, "fmi3EnterStepMode");
}

/* derivatives */

#define OF_KNOWNS                                                                                                       \
    fmi3Instance c, const fmi3ValueReference unknown[], size_t unknowns, const fmi3ValueReference known[], size_t knowns, \
        const double seed[], size_t seeds, double sensitivity[], size_t sensitivities

static bool of_lengths(fmi3Instance c, const char *function, size_t seeds, size_t wanted, size_t room, size_t needed) {
    if (slave_alive(c) && (seeds != wanted || room != needed)) {
        slave_error(c, function, "a seed of %zu numbers and room for %zu sensitivities were given, %zu and %zu are needed",
                    seeds, room, wanted, needed);
        return false;
    }
    return true;
}

EXPORT fmi3Status fmi3GetDirectionalDerivative(OF_KNOWNS) {
    const char *name = "fmi3GetDirectionalDerivative";
    Elements e;
    int status = STATUS_ERROR;
    if (slave_elements(c, name, unknown, unknowns, NULL, &e) && of_lengths(c, name, seeds, knowns, sensitivities, e.n)) {
        status = slave_directional(c, name, e.vr, e.n, known, knowns, seed, sensitivity);
    }
    slave_elements_end(&e);
    return status;
}

EXPORT fmi3Status fmi3GetAdjointDerivative(OF_KNOWNS) {
    const char *name = "fmi3GetAdjointDerivative";
    Elements e;
    int status = STATUS_ERROR;
    if (slave_elements(c, name, unknown, unknowns, NULL, &e) && of_lengths(c, name, seeds, e.n, sensitivities, knowns)) {
        status = slave_adjoint(c, name, e.vr, e.n, known, knowns, seed, sensitivity);
    }
    slave_elements_end(&e);
    return status;
}

EXPORT fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const int32_t order[],
                                           double value[], size_t values) {
    const char *name = "fmi3GetOutputDerivatives";
    Elements e;
    int status = STATUS_ERROR;
    if (slave_elements(c, name, vr, n, order, &e) && of_one_length(c, name, e.n, values)) {
        status = slave_output_derivatives(c, name, e.vr, e.n, e.order, value);
    }
    slave_elements_end(&e);
    return status;
}
