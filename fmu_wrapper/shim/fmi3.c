/* The functions of FMI 3.0 that this FMU has: co-simulation with events. Each hands its arguments to the method of the
 * same name of `Fmi3Calls` (fmi3_calls.py). What it has not is refused in fmi3_refused.c. */

#include "forward.h"

typedef Instance *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef double fmi3Float64;
typedef int32_t fmi3Int32;
typedef int64_t fmi3Int64;
typedef bool fmi3Boolean;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef int fmi3Status;

typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, fmi3Float64, fmi3Boolean, fmi3Boolean,
                                               fmi3Boolean, fmi3Boolean, fmi3Boolean *, fmi3Float64 *);

static void log_to_host(const Instance *self, int status, const char *category, const char *message) {
    if (self->logger) {
        ((fmi3LogMessageCallback)self->logger)(self->environment, status, category, message);
    }
}

static bool update_of_host(const Instance *self, double time, bool can_return_early, double *end) {
    fmi3Boolean wanted = false;
    ((fmi3IntermediateUpdateCallback)self->updater)(self->environment, time, true, true, true, can_return_early,
                                                    &wanted, end);
    return can_return_early && wanted;
}

/* version and logging */

EXPORT const char *fmi3GetVersion(void) {
    return "3.0";
}

EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t count, const fmi3String categories[]) {
    FORWARD(c, "fmi3SetDebugLogging", "(iN)", (int)on, list_of_strings(categories, count));
}

/* life */

static Instance model_of(fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger) {
    Instance model = {0};
    model.log = log_to_host;
    model.logger = (void (*)(void))logger;
    model.environment = environment;
    return model;
}

EXPORT fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                                fmi3Boolean visible, fmi3Boolean logging_on, fmi3Boolean event_mode,
                                                fmi3Boolean early_return, const fmi3ValueReference intermediate[],
                                                size_t intermediates, fmi3InstanceEnvironment environment,
                                                fmi3LogMessageCallback logger,
                                                fmi3IntermediateUpdateCallback intermediate_update) {
    (void)visible; /* there is nothing to show */
    Instance model = model_of(environment, logger);
    model.update = intermediate_update ? update_of_host : NULL;
    model.updater = (void (*)(void))intermediate_update;
    Asked asked = {3, logging_on, event_mode, early_return, intermediate, intermediates};
    return instance_new(&model, &asked, "fmi3InstantiateCoSimulation", name, token, resources);
}

EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                                 fmi3Boolean visible, fmi3Boolean logging_on,
                                                 fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging_on;
    Instance model = model_of(environment, logger);
    instance_report(&model, "fmi3InstantiateModelExchange: this FMU does co-simulation only");
    return NULL;
}

EXPORT fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                                      fmi3Boolean visible, fmi3Boolean logging_on,
                                                      fmi3InstanceEnvironment environment,
                                                      fmi3LogMessageCallback logger, void (*update)(void *),
                                                      void (*lock)(void), void (*unlock)(void)) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging_on, (void)update, (void)lock, (void)unlock;
    Instance model = model_of(environment, logger);
    instance_report(&model, "fmi3InstantiateScheduledExecution: this FMU does co-simulation only");
    return NULL;
}

EXPORT void fmi3FreeInstance(fmi3Instance c) {
    instance_free(c);
}

EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean tolerance_defined, fmi3Float64 tolerance,
                                              fmi3Float64 start, fmi3Boolean stop_defined, fmi3Float64 stop) {
    FORWARD(c, "fmi3EnterInitializationMode", "(iddid)", (int)tolerance_defined, tolerance, start, (int)stop_defined,
            stop);
}

EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
    FORWARD(c, "fmi3ExitInitializationMode", "()");
}

EXPORT fmi3Status fmi3Terminate(fmi3Instance c) {
    FORWARD(c, "fmi3Terminate", "()");
}

EXPORT fmi3Status fmi3Reset(fmi3Instance c) {
    FORWARD(c, "fmi3Reset", "()");
}

/* values */

#define GET(name, type)                                                                                           \
    EXPORT fmi3Status fmi3Get##name(fmi3Instance c, const fmi3ValueReference vr[], size_t n, type value[],         \
                                    size_t values) {                                                              \
        FORWARD(c, "fmi3Get" #name, "(NN)", IN(vr, n), OUT(value, values));                                       \
    }
#define SET(name, type)                                                                                           \
    EXPORT fmi3Status fmi3Set##name(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const type value[],   \
                                    size_t values) {                                                              \
        FORWARD(c, "fmi3Set" #name, "(NN)", IN(vr, n), IN(value, values));                                        \
    }

EXPORT fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Float64 value[],
                                 size_t values) {
    return forward_get_reals(c, "fmi3GetFloat64", vr, n, value, values);
}

EXPORT fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Float64 value[],
                                 size_t values) {
    return forward_set_reals(c, "fmi3SetFloat64", vr, n, value, values);
}

GET(Int32, fmi3Int32)
GET(Int64, fmi3Int64) /* enumerations */
GET(Boolean, fmi3Boolean)
SET(Int32, fmi3Int32)
SET(Int64, fmi3Int64)
SET(Boolean, fmi3Boolean)

EXPORT fmi3Status fmi3GetString(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3String value[],
                                size_t values) {
    int gil;
    if (n == values) {
        return forward_get_strings(c, "fmi3GetString", vr, n, value);
    }
    if (instance_enter(c, &gil)) { /* an instance, which has a log */
        python_leave(gil);
        instance_report(c, "fmi3GetString: FmuValueError: room for %zu values was given for %zu scalar variables",
                        values, n);
    }
    return STATUS_ERROR;
}

EXPORT fmi3Status fmi3SetString(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3String value[],
                                size_t values) {
    FORWARD(c, "fmi3SetString", "(NN)", IN(vr, n), list_of_strings(value, values));
}

/* derivatives of outputs with respect to inputs */

#define DERIVATIVE(name)                                                                                            \
    EXPORT fmi3Status name(fmi3Instance c, const fmi3ValueReference unknown[], size_t unknowns,                     \
                           const fmi3ValueReference known[], size_t knowns, const fmi3Float64 seed[], size_t seeds, \
                           fmi3Float64 sensitivity[], size_t sensitivities) {                                       \
        FORWARD(c, #name, "(NNNN)", IN(unknown, unknowns), IN(known, knowns), IN(seed, seeds),                      \
                OUT(sensitivity, sensitivities));                                                                   \
    }

DERIVATIVE(fmi3GetDirectionalDerivative)
DERIVATIVE(fmi3GetAdjointDerivative)

/* derivatives of outputs in time */

EXPORT fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                           const fmi3Int32 order[], fmi3Float64 value[], size_t values) {
    FORWARD(c, "fmi3GetOutputDerivatives", "(NNN)", IN(vr, n), IN(order, n), OUT(value, values));
}

/* state */

EXPORT fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state) {
    return forward_get_state(c, "fmi3GetFMUState", state);
}

EXPORT fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) {
    FORWARD(c, "fmi3SetFMUState", "(K)", HANDLE(state));
}

EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state) {
    return forward_free_state(c, "fmi3FreeFMUState", state);
}

EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size) {
    return forward_state_size(c, "fmi3SerializedFMUStateSize", state, size);
}

EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
    FORWARD(c, "fmi3SerializeFMUState", "(KN)", HANDLE(state), OUT(bytes, size));
}

EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state) {
    return forward_read_state(c, "fmi3DeserializeFMUState", bytes, size, state);
}

/* steps and events */

EXPORT fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 step, fmi3Boolean no_set_state,
                             fmi3Boolean *event_handling_needed, fmi3Boolean *terminate, fmi3Boolean *early_return,
                             fmi3Float64 *last_successful_time) {
    (void)no_set_state; /* a stored state lives until it is freed */
    int how;
    bool complete = event_handling_needed && terminate && early_return && last_successful_time; /* else it is refused */
    const Shared *end = complete ? forward_step(c, "fmi3DoStep", time, step, &how) : NULL;
    if (end) {
        *event_handling_needed = end->event_due != 0;
        *early_return = end->early != 0;
        *terminate = false;
        *last_successful_time = end->reached;
        return how;
    }
    FORWARD(c, "fmi3DoStep", "(ddNNNN)", time, step, OUT(event_handling_needed, 1), OUT(terminate, 1),
            OUT(early_return, 1), OUT(last_successful_time, 1));
}

EXPORT fmi3Status fmi3EnterEventMode(fmi3Instance c) {
    FORWARD(c, "fmi3EnterEventMode", "()");
}

EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *terminate,
                                           fmi3Boolean *nominals_changed, fmi3Boolean *values_changed,
                                           fmi3Boolean *next_event_defined, fmi3Float64 *next_event) {
    FORWARD(c, "fmi3UpdateDiscreteStates", "(NNNNNN)", OUT(again, 1), OUT(terminate, 1), OUT(nominals_changed, 1),
            OUT(values_changed, 1), OUT(next_event_defined, 1), OUT(next_event, 1));
}

EXPORT fmi3Status fmi3EnterStepMode(fmi3Instance c) {
    FORWARD(c, "fmi3EnterStepMode", "()");
}
