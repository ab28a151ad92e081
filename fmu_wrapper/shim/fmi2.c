/* The functions of FMI 2.0 for co-simulation. Each hands its arguments to the method of the same name of
 * `Fmi2Calls` (fmi2_calls.py); what a status means is decided there. */

#include <stdlib.h>
#include <string.h>

#include "forward.h"

typedef Instance *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;
typedef int fmi2Status;
typedef int fmi2Type;
typedef int fmi2StatusKind;

typedef void (*fmi2CallbackLogger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);

typedef struct {
    fmi2CallbackLogger logger;
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

enum { CO_SIMULATION = 1 };

/* The message is a format for the host: its percent signs are doubled. */
static void log_to_host(const Instance *self, int status, const char *category, const char *message) {
    if (!self->logger) {
        return;
    }
    char *format = malloc(2 * strlen(message) + 1);
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

/* version and logging */

EXPORT const char *fmi2GetTypesPlatform(void) {
    return "default";
}

EXPORT const char *fmi2GetVersion(void) {
    return "2.0";
}

EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[]) {
    FORWARD(c, "fmi2SetDebugLogging", "(iN)", on, list_of_strings(categories, count));
}

/* life */

EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                     const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                                     fmi2Boolean logging_on) {
    (void)visible; /* there is nothing to show */
    Instance model = {0};
    model.log = log_to_host;
    if (functions) {
        model.logger = (void (*)(void))functions->logger;
        model.environment = functions->componentEnvironment;
    }
    if (type != CO_SIMULATION) {
        instance_report(&model, "fmi2Instantiate: this FMU does co-simulation only, type %d was asked", type);
        return NULL;
    }
    Asked asked = {2, logging_on, false, false, NULL, 0};
    return instance_new(&model, &asked, "fmi2Instantiate", name, guid, resources);
}

EXPORT void fmi2FreeInstance(fmi2Component c) {
    instance_free(c);
}

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                                      fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop) {
    FORWARD(c, "fmi2SetupExperiment", "(iddid)", tolerance_defined, tolerance, start, stop_defined, stop);
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    FORWARD(c, "fmi2EnterInitializationMode", "()");
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    FORWARD(c, "fmi2ExitInitializationMode", "()");
}

EXPORT fmi2Status fmi2Terminate(fmi2Component c) {
    FORWARD(c, "fmi2Terminate", "()");
}

EXPORT fmi2Status fmi2Reset(fmi2Component c) {
    FORWARD(c, "fmi2Reset", "()");
}

/* values */

EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    return forward_get_reals(c, "fmi2GetReal", vr, n, value, n);
}

EXPORT fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Integer value[]) {
    FORWARD(c, "fmi2GetInteger", "(NN)", IN(vr, n), OUT(value, n));
}

EXPORT fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Boolean value[]) {
    FORWARD(c, "fmi2GetBoolean", "(NN)", IN(vr, n), OUT(value, n));
}

EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    return forward_set_reals(c, "fmi2SetReal", vr, n, value, n);
}

EXPORT fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                 const fmi2Integer value[]) {
    FORWARD(c, "fmi2SetInteger", "(NN)", IN(vr, n), IN(value, n));
}

EXPORT fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                 const fmi2Boolean value[]) {
    FORWARD(c, "fmi2SetBoolean", "(NN)", IN(vr, n), IN(value, n));
}

EXPORT fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String value[]) {
    FORWARD(c, "fmi2SetString", "(NN)", IN(vr, n), list_of_strings(value, n));
}

EXPORT fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String value[]) {
    return forward_get_strings(c, "fmi2GetString", vr, n, value);
}

/* state: the pointer that the host holds is a number, not an address */

EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    return forward_get_state(c, "fmi2GetFMUstate", state);
}

EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    FORWARD(c, "fmi2SetFMUstate", "(K)", HANDLE(state));
}

EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    return forward_free_state(c, "fmi2FreeFMUstate", state);
}

EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    return forward_state_size(c, "fmi2SerializedFMUstateSize", state, size);
}

EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    FORWARD(c, "fmi2SerializeFMUstate", "(KN)", HANDLE(state), OUT(bytes, size));
}

EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                          fmi2FMUstate *state) {
    return forward_read_state(c, "fmi2DeSerializeFMUstate", bytes, size, state);
}

/* steps */

EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_set_state) {
    (void)no_set_state; /* a stored state lives until it is freed */
    int how;
    if (forward_step(c, "fmi2DoStep", time, step, &how)) {
        return how;
    }
    FORWARD(c, "fmi2DoStep", "(dd)", time, step);
}

EXPORT fmi2Status fmi2CancelStep(fmi2Component c) {
    FORWARD(c, "fmi2CancelStep", "()");
}

EXPORT fmi2Status fmi2GetStatus(fmi2Component c, fmi2StatusKind kind, fmi2Status *value) {
    FORWARD(c, "fmi2GetStatus", "(iN)", kind, OUT(value, 1));
}

EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real *value) {
    FORWARD(c, "fmi2GetRealStatus", "(iN)", kind, OUT(value, 1));
}

EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component c, fmi2StatusKind kind, fmi2Integer *value) {
    FORWARD(c, "fmi2GetIntegerStatus", "(iN)", kind, OUT(value, 1));
}

EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind, fmi2Boolean *value) {
    FORWARD(c, "fmi2GetBooleanStatus", "(iN)", kind, OUT(value, 1));
}

EXPORT fmi2Status fmi2GetStringStatus(fmi2Component c, fmi2StatusKind kind, fmi2String *value) {
    if (!forward_has_room(c, "fmi2GetStringStatus", value)) {
        return STATUS_ERROR;
    }
    *value = "";
    FORWARD(c, "fmi2GetStringStatus", "(i)", kind);
}

/* derivatives of outputs along a direction of inputs */

EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns,
                                               const fmi2ValueReference known[], size_t knowns,
                                               const fmi2Real seed[], fmi2Real sensitivity[]) {
    FORWARD(c, "fmi2GetDirectionalDerivative", "(NNNN)", IN(unknown, unknowns), IN(known, knowns), IN(seed, knowns),
            OUT(sensitivity, unknowns));
}

EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                              const fmi2Integer order[], const fmi2Real value[]) {
    FORWARD(c, "fmi2SetRealInputDerivatives", "(NNN)", IN(vr, n), IN(order, n), IN(value, n));
}

EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                               const fmi2Integer order[], fmi2Real value[]) {
    FORWARD(c, "fmi2GetRealOutputDerivatives", "(NNN)", IN(vr, n), IN(order, n), OUT(value, n));
}
