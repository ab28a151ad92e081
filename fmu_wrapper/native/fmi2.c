/* The functions of FMI 2.0 for co-simulation, of an FMU that needs no Python. */

#include "slave.h"

#include <math.h>
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
enum { LAST_SUCCESSFUL_TIME = 2, IS_TERMINATED = 3 };
enum { CHUNK_OF_WHOLES = 64 };

/* The message is a format for the host: its percent signs are doubled. */
static void log_to_host(const Slave *self, int status, const char *category, const char *message) {
    char *format = self->logger ? malloc(2 * strlen(message) + 1) : NULL;
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
    ((fmi2CallbackLogger)self->logger)(self->environment, self->name ? self->name : "", status, category, format);
    free(format);
}

EXPORT const char *fmi2GetTypesPlatform(void) {
    return "default";
}

EXPORT const char *fmi2GetVersion(void) {
    return "2.0";
}

EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, int on, size_t count, const fmi2String categories[]) {
    return slave_choose_log(c, "fmi2SetDebugLogging", on != 0, categories, count);
}

/* life */

EXPORT fmi2Component fmi2Instantiate(fmi2String name, int type, fmi2String guid, fmi2String resources,
                                     const fmi2CallbackFunctions *functions, int visible, int logging_on) {
    (void)visible; /* there is nothing to show */
    Slave given = {0};
    given.log = log_to_host;
    if (functions) {
        given.logger = (void (*)(void))functions->logger;
        given.environment = functions->componentEnvironment;
    }
    if (type != CO_SIMULATION) {
        slave_error(&given, "fmi2Instantiate", "this FMU does co-simulation only, type %d was asked", type);
        return NULL;
    }
    return slave_new(&given, "fmi2Instantiate", name, guid, resources, logging_on != 0);
}

EXPORT void fmi2FreeInstance(fmi2Component c) {
    slave_free(c);
}

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, int tolerance_defined, double tolerance, double start,
                                      int stop_defined, double stop) {
    return slave_set_up(c, "fmi2SetupExperiment", tolerance_defined != 0, tolerance, start, stop_defined != 0, stop);
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    return slave_enter_initialization(c, "fmi2EnterInitializationMode");
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    return slave_exit_initialization(c, "fmi2ExitInitializationMode");
}

EXPORT fmi2Status fmi2Terminate(fmi2Component c) {
    return slave_terminate(c, "fmi2Terminate");
}

EXPORT fmi2Status fmi2Reset(fmi2Component c) {
    return slave_reset(c, "fmi2Reset");
}

/* values */

EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, double value[]) {
    return slave_get_reals(c, "fmi2GetReal", vr, n, value);
}

static fmi2Status get_ints(fmi2Component c, const char *function, Kind kind, const fmi2ValueReference vr[], size_t n,
                           int value[]) {
    int64_t found[CHUNK_OF_WHOLES];
    if (slave_alive(c) && !slave_has_room(c, function, value, n)) {
        return STATUS_ERROR;
    }
    for (size_t first = 0; first < n || !first; first += CHUNK_OF_WHOLES) {
        size_t count = n - first < CHUNK_OF_WHOLES ? n - first : CHUNK_OF_WHOLES;
        int status = slave_get_wholes(c, function, kind, -1, vr ? vr + first : NULL, count, found);
        if (status != STATUS_OK) {
            return status;
        }
        for (size_t k = 0; k < count; k++) {
            value[first + k] = (int)found[k];
        }
    }
    return STATUS_OK;
}

EXPORT fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, int value[]) {
    return get_ints(c, "fmi2GetInteger", INTEGER, vr, n, value);
}

EXPORT fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n, int value[]) {
    return get_ints(c, "fmi2GetBoolean", BOOLEAN, vr, n, value);
}

EXPORT fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String value[]) {
    (void)vr, (void)value;
    if (!slave_may(c, "fmi2GetString", ~0u)) {
        return STATUS_ERROR;
    }
    return n ? slave_error(c, "fmi2GetString", "this FMU has no strings") : STATUS_OK;
}

EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const double value[]) {
    return slave_set_reals(c, "fmi2SetReal", vr, n, value);
}

EXPORT fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, const int value[]) {
    (void)value;
    return slave_set_others(c, "fmi2SetInteger", vr, n);
}

EXPORT fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n, const int value[]) {
    (void)value;
    return slave_set_others(c, "fmi2SetBoolean", vr, n);
}

EXPORT fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String value[]) {
    (void)value;
    return slave_set_others(c, "fmi2SetString", vr, n);
}

/* states */

EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, void **state) {
    return slave_get_state(c, "fmi2GetFMUstate", state);
}

EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, void *state) {
    return slave_set_state(c, "fmi2SetFMUstate", state);
}

EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, void **state) {
    return slave_free_state(c, "fmi2FreeFMUstate", state);
}

EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, void *state, size_t *size) {
    return slave_state_size(c, "fmi2SerializedFMUstateSize", state, size);
}

EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, void *state, char bytes[], size_t size) {
    return slave_write_state(c, "fmi2SerializeFMUstate", state, bytes, size);
}

EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const char bytes[], size_t size, void **state) {
    return slave_read_state(c, "fmi2DeSerializeFMUstate", bytes, size, state);
}

/* steps */

EXPORT fmi2Status fmi2DoStep(fmi2Component c, double time, double step, int no_set_state) {
    (void)no_set_state; /* a stored state lives until it is freed */
    StepEnd end;
    return slave_step(c, "fmi2DoStep", time, step, &end);
}

EXPORT fmi2Status fmi2CancelStep(fmi2Component c) {
    if (!slave_may(c, "fmi2CancelStep", ~0u)) {
        return STATUS_ERROR;
    }
    return slave_error(c, "fmi2CancelStep", "steps never run in the background (canRunAsynchronuously = false)");
}

/* What is asked and is not there. */
static fmi2Status no_status(fmi2Component c, const char *function, int kind) {
    if (!slave_may(c, function, ~0u)) {
        return STATUS_ERROR;
    }
    slave_say(c, STATUS_DISCARD, LOG_DISCARD, "%s: status kind %d is not available: steps are never asynchronous", function,
              kind);
    return STATUS_DISCARD;
}

EXPORT fmi2Status fmi2GetStatus(fmi2Component c, int kind, fmi2Status *value) {
    (void)value;
    return no_status(c, "fmi2GetStatus", kind);
}

EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, int kind, double *value) {
    if (kind != LAST_SUCCESSFUL_TIME) {
        return no_status(c, "fmi2GetRealStatus", kind);
    }
    if (!slave_may(c, "fmi2GetRealStatus", ~0u) || !slave_has_room(c, "fmi2GetRealStatus", value, 1)) {
        return STATUS_ERROR;
    }
    *value = tlismni_time(c->run);
    return STATUS_OK;
}

EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component c, int kind, int *value) {
    (void)value;
    return no_status(c, "fmi2GetIntegerStatus", kind);
}

EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, int kind, int *value) {
    if (kind != IS_TERMINATED) {
        return no_status(c, "fmi2GetBooleanStatus", kind);
    }
    if (!slave_may(c, "fmi2GetBooleanStatus", ~0u) || !slave_has_room(c, "fmi2GetBooleanStatus", value, 1)) {
        return STATUS_ERROR;
    }
    *value = 0;
    return STATUS_OK;
}

EXPORT fmi2Status fmi2GetStringStatus(fmi2Component c, int kind, fmi2String *value) {
    if (value) {
        *value = "";
    }
    return no_status(c, "fmi2GetStringStatus", kind);
}

/* derivatives */

EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns,
                                               const fmi2ValueReference known[], size_t knowns, const double seed[],
                                               double sensitivity[]) {
    return slave_directional(c, "fmi2GetDirectionalDerivative", unknown, unknowns, known, knowns, seed, sensitivity);
}

EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n, const int order[],
                                              const double value[]) {
    return slave_set_rates(c, "fmi2SetRealInputDerivatives", vr, n, order, value);
}

EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n, const int order[],
                                               double value[]) {
    return slave_output_derivatives(c, "fmi2GetRealOutputDerivatives", vr, n, order, value);
}
