/* The functions of FMI 2.0 for co-simulation. */

#include "functions.h"

#include <stdlib.h>
#include <string.h>

typedef Slave *fmi2Component;
typedef unsigned int fmi2ValueReference;
typedef const char *fmi2String;
typedef int fmi2Status;
typedef void (*fmi2CallbackLogger)(void *, fmi2String, fmi2Status, fmi2String, fmi2String, ...);

typedef struct {
    fmi2CallbackLogger logger;
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(void *, fmi2Status);
    void *componentEnvironment;
} fmi2CallbackFunctions;

enum { CO_SIMULATION = 1 };
enum { LAST_SUCCESSFUL_TIME = 2, IS_TERMINATED = 3 }; /* fmi2StatusKind */

static const Type INTEGERS = {INTEGER, -1, sizeof(int)}, BOOLEANS = {BOOLEAN, -1, sizeof(int)};

#define VALUES fmi2Component c, const fmi2ValueReference vr[], size_t n

/* The message is a format for the host: its percent signs are doubled. */
static void log_to_host(const Host *host, int status, const char *category, const char *message) {
    char *format = host->logger ? malloc(2 * strlen(message) + 1) : NULL;
    if (!format) {
        return;
    }
    char *to = format;
    for (const char *from = message; *from; from++) {
        *to++ = *from;
        if (*from == '%') {
            *to++ = '%';
        }
    }
    *to = '\0';
    ((fmi2CallbackLogger)host->logger)(host->environment, host->name ? host->name : "", status, category, format);
    free(format);
}

EXPORT const char *fmi2GetTypesPlatform(void) {
    return "default";
}

EXPORT const char *fmi2GetVersion(void) {
    return "2.0";
}

EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, int on, size_t count, const fmi2String categories[]) {
    return choose_log(c, __func__, on != 0, categories, count);
}

/* life */

EXPORT fmi2Component fmi2Instantiate(fmi2String name, int type, fmi2String guid, fmi2String resources,
                                     const fmi2CallbackFunctions *functions, int visible, int logging_on) {
    (void)visible; /* there is nothing to show */
    Host host = {.log = log_to_host};
    Asked asked = {.version = 2, .logging_on = logging_on != 0};
    if (functions) {
        host.logger = (void (*)(void))functions->logger;
        host.environment = functions->componentEnvironment;
    }
    if (type != CO_SIMULATION) {
        host_error(&host, __func__, "this FMU does co-simulation only, type %d was asked", type);
        return NULL;
    }
    return instantiate(&host, &asked, __func__, name, guid, resources);
}

EXPORT void fmi2FreeInstance(fmi2Component c) {
    free_instance(c, __func__);
}

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, int tolerance_defined, double tolerance, double start,
                                      int stop_defined, double stop) {
    Experiment experiment = {tolerance_defined != 0, stop_defined != 0, tolerance, start, stop};
    return IF(slave_host(c), slave_set_up(c, __func__, &experiment));
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    return IF(slave_host(c), slave_enter_initialization(c, __func__, NULL));
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    return IF(slave_host(c), slave_exit_initialization(c, __func__));
}

EXPORT fmi2Status fmi2Terminate(fmi2Component c) {
    return IF(slave_host(c), slave_terminate(c, __func__));
}

EXPORT fmi2Status fmi2Reset(fmi2Component c) {
    return IF(slave_host(c), slave_reset(c, __func__));
}

/* values */

EXPORT fmi2Status fmi2GetReal(VALUES, double value[]) {
    return IF(both_given(c, __func__, vr, value, n), slave_get_reals(c, __func__, vr, n, value, n));
}

EXPORT fmi2Status fmi2GetInteger(VALUES, int value[]) {
    return IF(both_given(c, __func__, vr, value, n), slave_get(c, __func__, &INTEGERS, vr, n, value));
}

EXPORT fmi2Status fmi2GetBoolean(VALUES, int value[]) {
    return IF(both_given(c, __func__, vr, value, n), slave_get(c, __func__, &BOOLEANS, vr, n, value));
}

EXPORT fmi2Status fmi2GetString(VALUES, fmi2String value[]) {
    return IF(both_given(c, __func__, vr, value, n), slave_get_strings(c, __func__, vr, n, value));
}

EXPORT fmi2Status fmi2SetReal(VALUES, const double value[]) {
    return IF(both_given(c, __func__, vr, value, n), slave_set_reals(c, __func__, vr, n, value, n));
}

EXPORT fmi2Status fmi2SetInteger(VALUES, const int value[]) {
    return IF(both_given(c, __func__, vr, value, n), slave_set(c, __func__, &INTEGERS, vr, n, value));
}

EXPORT fmi2Status fmi2SetBoolean(VALUES, const int value[]) {
    return IF(both_given(c, __func__, vr, value, n), slave_set(c, __func__, &BOOLEANS, vr, n, value));
}

EXPORT fmi2Status fmi2SetString(VALUES, const fmi2String value[]) {
    return IF(both_given(c, __func__, vr, value, n), slave_set_strings(c, __func__, vr, n, value));
}

/* states */

EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, void **state) {
    return IF(is_given(c, __func__, state), slave_get_state(c, __func__, state));
}

EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, void *state) {
    return IF(slave_host(c), slave_set_state(c, __func__, state));
}

EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, void **state) {
    return free_state(c, __func__, state);
}

EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, void *state, size_t *size) {
    return IF(is_given(c, __func__, size), slave_state_size(c, __func__, state, size));
}

EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, void *state, char bytes[], size_t size) {
    return IF(are_given(c, __func__, bytes, size), slave_write_state(c, __func__, state, bytes, size));
}

EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const char bytes[], size_t size, void **state) {
    return IF(are_given(c, __func__, bytes, size ? size : 1) && is_given(c, __func__, state),
              slave_read_state(c, __func__, bytes, size, state));
}

/* steps */

EXPORT fmi2Status fmi2DoStep(fmi2Component c, double time, double step, int no_set_state) {
    (void)no_set_state; /* a stored state lives until it is freed */
    StepEnd end;
    return IF(slave_host(c), slave_step(c, __func__, time, step, &end));
}

EXPORT fmi2Status fmi2CancelStep(fmi2Component c) {
    return IF(slave_host(c), host_error(slave_host(c), __func__, "UnavailableError: steps never run in the background "
                                        "(canRunAsynchronuously = false)"));
}

/* What is asked and is not there. */
static fmi2Status no_status(fmi2Component c, const char *function, int kind) {
    if (!slave_host(c)) {
        return STATUS_ERROR;
    }
    host_say(slave_host(c), STATUS_DISCARD, LOG_DISCARD, "%s: DiscardError: status kind %d is not available: steps are never "
             "asynchronous", function, kind);
    return STATUS_DISCARD;
}

EXPORT fmi2Status fmi2GetStatus(fmi2Component c, int kind, fmi2Status *value) {
    return IF(is_given(c, __func__, value), no_status(c, __func__, kind));
}

EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, int kind, double *value) {
    return IF(is_given(c, __func__, value),
              kind == LAST_SUCCESSFUL_TIME ? slave_time(c, __func__, value) : no_status(c, __func__, kind));
}

EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component c, int kind, int *value) {
    return IF(is_given(c, __func__, value), no_status(c, __func__, kind));
}

EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, int kind, int *value) {
    if (!is_given(c, __func__, value)) {
        return STATUS_ERROR;
    }
    *value = 0; /* it never wants to end the run */
    return kind == IS_TERMINATED ? STATUS_OK : no_status(c, __func__, kind);
}

EXPORT fmi2Status fmi2GetStringStatus(fmi2Component c, int kind, fmi2String *value) {
    if (!is_given(c, __func__, value)) {
        return STATUS_ERROR;
    }
    *value = "";
    return no_status(c, __func__, kind);
}

/* derivatives */

EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns,
                                               const fmi2ValueReference known[], size_t knowns, const double seed[],
                                               double sensitivity[]) {
    Question question = {unknown, unknowns, known, knowns, seed, knowns, sensitivity, unknowns};
    return IF(is_complete(c, __func__, &question), slave_directional(c, __func__, &question));
}

EXPORT fmi2Status fmi2SetRealInputDerivatives(VALUES, const int order[], const double value[]) {
    return IF(both_given(c, __func__, vr, value, n) && are_given(c, __func__, order, n),
              slave_set_rates(c, __func__, vr, n, order, value));
}

EXPORT fmi2Status fmi2GetRealOutputDerivatives(VALUES, const int order[], double value[]) {
    return IF(both_given(c, __func__, vr, value, n) && are_given(c, __func__, order, n),
              slave_output_derivatives(c, __func__, vr, n, order, value, n));
}
