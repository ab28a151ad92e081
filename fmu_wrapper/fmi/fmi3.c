/* The functions of FMI 3.0 that our FMUs have: co-simulation with events. Others: fmi3_refused.c. */

#include "functions.h"

typedef Slave *fmi3Instance;
typedef uint32_t fmi3ValueReference;
typedef const char *fmi3String;
typedef int fmi3Status;

typedef void (*fmi3LogMessageCallback)(void *, fmi3Status, fmi3String, fmi3String);
typedef void (*fmi3IntermediateUpdateCallback)(void *, double, bool, bool, bool, bool, bool *, double *);

#define VALUES fmi3Instance c, const fmi3ValueReference vr[], size_t n

static void log_to_host(const Host *host, int status, const char *category, const char *message) {
    if (host->logger) {
        ((fmi3LogMessageCallback)host->logger)(host->environment, status, category, message);
    }
}

static bool update_of_host(Host *host, double time, bool may_end_early, double *end) {
    bool wanted = false;
    *end = time;
    host->updating = true;
    ((fmi3IntermediateUpdateCallback)host->updater)(host->environment, time, true, true, true, may_end_early, &wanted, end);
    host->updating = false;
    return may_end_early && wanted;
}

static Host host_of(void *environment, fmi3LogMessageCallback logger) {
    return (Host){.log = log_to_host, .logger = (void (*)(void))logger, .environment = environment};
}

EXPORT const char *fmi3GetVersion(void) {
    return "3.0";
}

EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance c, bool on, size_t count, const fmi3String categories[]) {
    return choose_log(c, __func__, on, categories, count);
}

/* life */

EXPORT fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, bool visible,
                                                bool logging_on, bool event_mode, bool early_return,
                                                const fmi3ValueReference intermediate[], size_t intermediates,
                                                void *environment, fmi3LogMessageCallback logger,
                                                fmi3IntermediateUpdateCallback update) {
    (void)visible; /* there is nothing to show */
    Host host = host_of(environment, logger);
    Asked asked = {3, logging_on, event_mode, early_return, intermediate, update ? intermediates : 0};
    host.update = update ? update_of_host : NULL;
    host.updater = (void (*)(void))update;
    return instantiate(&host, &asked, __func__, name, token, resources);
}

EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, bool visible,
                                                 bool logging_on, void *environment, fmi3LogMessageCallback logger) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging_on;
    Host host = host_of(environment, logger);
    host_error(&host, __func__, "this FMU does co-simulation only");
    return NULL;
}

EXPORT fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources, bool visible,
                                                      bool logging_on, void *environment, fmi3LogMessageCallback logger,
                                                      void (*update)(void *), void (*lock)(void), void (*unlock)(void)) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging_on, (void)update, (void)lock, (void)unlock;
    Host host = host_of(environment, logger);
    host_error(&host, __func__, "this FMU does co-simulation only");
    return NULL;
}

EXPORT void fmi3FreeInstance(fmi3Instance c) {
    free_instance(c, __func__);
}

EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance c, bool tolerance_defined, double tolerance, double start,
                                              bool stop_defined, double stop) {
    Experiment experiment = {tolerance_defined, stop_defined, tolerance, start, stop};
    return IF(slave_host(c), slave_enter_initialization(c, __func__, &experiment));
}

EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
    return IF(slave_host(c), slave_exit_initialization(c, __func__));
}

EXPORT fmi3Status fmi3Terminate(fmi3Instance c) {
    return IF(slave_host(c), slave_terminate(c, __func__));
}

EXPORT fmi3Status fmi3Reset(fmi3Instance c) {
    return IF(slave_host(c), slave_reset(c, __func__));
}

/* values */

EXPORT fmi3Status fmi3GetFloat64(VALUES, double value[], size_t values) {
    return IF(are_given(c, __func__, vr, n) && are_given(c, __func__, value, values),
              slave_get_reals(c, __func__, vr, n, value, values));
}

EXPORT fmi3Status fmi3SetFloat64(VALUES, const double value[], size_t values) {
    return IF(are_given(c, __func__, vr, n) && are_given(c, __func__, value, values),
              slave_set_reals(c, __func__, vr, n, value, values));
}

#define TYPE(name, type, kind, enumerations)                                                                             \
    static const Type name##s = {kind, enumerations, sizeof(type)};                                                      \
    EXPORT fmi3Status fmi3Get##name(VALUES, type value[], size_t values) {                                               \
        return IF(is_of_length(c, __func__, n, values) && both_given(c, __func__, vr, value, n),                         \
                  slave_get(c, __func__, &name##s, vr, n, value));                                                       \
    }                                                                                                                    \
    EXPORT fmi3Status fmi3Set##name(VALUES, const type value[], size_t values) {                                         \
        return IF(is_of_length(c, __func__, n, values) && both_given(c, __func__, vr, value, n),                         \
                  slave_set(c, __func__, &name##s, vr, n, value));                                                       \
    }

TYPE(Int32, int32_t, INTEGER, 0)
TYPE(Int64, int64_t, INTEGER, 1) /* enumerations */
TYPE(Boolean, bool, BOOLEAN, -1)

EXPORT fmi3Status fmi3GetString(VALUES, fmi3String value[], size_t values) {
    return IF(is_of_length(c, __func__, n, values) && both_given(c, __func__, vr, value, n),
              slave_get_strings(c, __func__, vr, n, value));
}

EXPORT fmi3Status fmi3SetString(VALUES, const fmi3String value[], size_t values) {
    return IF(is_of_length(c, __func__, n, values) && both_given(c, __func__, vr, value, n),
              slave_set_strings(c, __func__, vr, n, value));
}

/* states */

EXPORT fmi3Status fmi3GetFMUState(fmi3Instance c, void **state) {
    return IF(is_given(c, __func__, state), slave_get_state(c, __func__, state));
}

EXPORT fmi3Status fmi3SetFMUState(fmi3Instance c, void *state) {
    return IF(slave_host(c), slave_set_state(c, __func__, state));
}

EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance c, void **state) {
    return free_state(c, __func__, state);
}

EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, void *state, size_t *size) {
    return IF(is_given(c, __func__, size), slave_state_size(c, __func__, state, size));
}

EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance c, void *state, uint8_t bytes[], size_t size) {
    return IF(are_given(c, __func__, bytes, size), slave_write_state(c, __func__, state, bytes, size));
}

EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const uint8_t bytes[], size_t size, void **state) {
    return IF(are_given(c, __func__, bytes, size ? size : 1) && is_given(c, __func__, state),
              slave_read_state(c, __func__, bytes, size, state));
}

/* steps and events */

EXPORT fmi3Status fmi3DoStep(fmi3Instance c, double time, double step, bool no_set_state, bool *event_handling_needed,
                             bool *terminate, bool *early_return, double *last_successful_time) {
    (void)no_set_state; /* a stored state lives until it is freed */
    if (!is_given(c, __func__, event_handling_needed) || !is_given(c, __func__, terminate) ||
        !is_given(c, __func__, early_return) || !is_given(c, __func__, last_successful_time)) {
        return STATUS_ERROR;
    }
    StepEnd end = {time, false, false};
    int status = slave_step(c, __func__, time, step, &end);
    *event_handling_needed = end.event_due;
    *terminate = false;
    *early_return = end.early;
    *last_successful_time = end.time;
    return status;
}

EXPORT fmi3Status fmi3EnterEventMode(fmi3Instance c) {
    return IF(slave_host(c), slave_enter_event_mode(c, __func__));
}

EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, bool *again, bool *terminate, bool *nominals_changed,
                                           bool *values_changed, bool *next_event_defined, double *next_event) {
    bool *flags[] = {again, terminate, nominals_changed, values_changed, next_event_defined};
    for (int k = 0; k < 5; k++) {
        if (!is_given(c, __func__, flags[k])) {
            return STATUS_ERROR;
        }
        *flags[k] = false;
    }
    if (!is_given(c, __func__, next_event)) {
        return STATUS_ERROR;
    }
    *next_event = 0.0; /* the next one is not known before it comes */
    return slave_update(c, __func__, again);
}

EXPORT fmi3Status fmi3EnterStepMode(fmi3Instance c) {
    return IF(slave_host(c), slave_enter_step_mode(c, __func__));
}

/* derivatives */

#define OF_KNOWNS                                                                                                       \
    fmi3Instance c, const fmi3ValueReference unknown[], size_t unknowns, const fmi3ValueReference known[], size_t knowns, \
        const double seed[], size_t seeds, double sensitivity[], size_t sensitivities

EXPORT fmi3Status fmi3GetDirectionalDerivative(OF_KNOWNS) {
    Question question = {unknown, unknowns, known, knowns, seed, seeds, sensitivity, sensitivities};
    return IF(is_complete(c, __func__, &question), slave_directional(c, __func__, &question));
}

EXPORT fmi3Status fmi3GetAdjointDerivative(OF_KNOWNS) {
    Question question = {unknown, unknowns, known, knowns, seed, seeds, sensitivity, sensitivities};
    return IF(is_complete(c, __func__, &question), slave_adjoint(c, __func__, &question));
}

EXPORT fmi3Status fmi3GetOutputDerivatives(VALUES, const int32_t order[], double value[], size_t values) {
    return IF(both_given(c, __func__, vr, order, n) && are_given(c, __func__, value, values),
              slave_output_derivatives(c, __func__, vr, n, order, value, values));
}
