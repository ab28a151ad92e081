/* Calls of hosts in FMI 2.0 and 3.0 (-DFMI=3): an instance, made ready, reals in and out, steps, states, derivatives. */
#ifndef NATIVE_FMI_H
#define NATIVE_FMI_H

#include "host.h"

static void *library;
static const char *resources, *token;

#if FMI == 3
#include "fmi3Functions.h"

typedef fmi3Instance Instance;
typedef fmi3FMUState State;
typedef fmi3ValueReference Reference;

static void logger(fmi3InstanceEnvironment e, fmi3Status status, fmi3String category, fmi3String message) {
    (void)e;
    fprintf(stderr, "%d %s: %s\n", status, category, message);
}

static Instance fresh(void) {
    LOAD(fmi3InstantiateCoSimulation);
    Instance c = fmi3InstantiateCoSimulation("it", token, resources, fmi3False, fmi3False, fmi3False, fmi3False, NULL, 0,
                                             NULL, logger, NULL);
    if (!c) {
        exit(4);
    }
    return c;
}

static void begin(Instance c) {
    LOAD(fmi3EnterInitializationMode);
    LOAD(fmi3ExitInitializationMode);
    CHECK(fmi3EnterInitializationMode(c, fmi3False, 0.0, 0.0, fmi3False, 0.0));
    CHECK(fmi3ExitInitializationMode(c));
}

static void step_once(Instance c, fmi3DoStepTYPE *do_step, double t, double h) {
    fmi3Boolean event, terminate, early;
    double last;
    CHECK(do_step(c, t, h, fmi3True, &event, &terminate, &early, &last));
}

#define SET_REALS(c, references, n, values) fmi3SetFloat64(c, references, n, values, n)
#define GET_REALS(c, references, n, values) fmi3GetFloat64(c, references, n, values, n)
#define DO_STEP(c, t, h) step_once(c, fmi3DoStep, t, h)
#define LOAD_SET LOAD(fmi3SetFloat64)
#define LOAD_STEP     \
    LOAD_SET;         \
    LOAD(fmi3DoStep); \
    LOAD(fmi3GetFloat64)
#define LOAD_STATES              \
    LOAD(fmi3GetFMUState); \
    LOAD(fmi3SetFMUState); \
    LOAD(fmi3SerializedFMUStateSize)
#define SAVE fmi3GetFMUState
#define RESTORE fmi3SetFMUState
#define SAVED_SIZE fmi3SerializedFMUStateSize
#define LOAD_BYTES                   \
    LOAD(fmi3SerializeFMUState); \
    LOAD(fmi3DeserializeFMUState)
#define WRITE fmi3SerializeFMUState
#define READ fmi3DeserializeFMUState
#define LOAD_DERIVATIVE LOAD(fmi3GetDirectionalDerivative)
#define DERIVATIVES(c, out, n, in, seed, values) fmi3GetDirectionalDerivative(c, out, n, in, 1, seed, 1, values, n)
#define LOAD_FREE LOAD(fmi3FreeInstance)
#define FREE fmi3FreeInstance
#else
#include "fmi2Functions.h"

typedef fmi2Component Instance;
typedef fmi2FMUstate State;
typedef fmi2ValueReference Reference;

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...) {
    (void)environment;
    fprintf(stderr, "%s: %d %s: %s\n", name, status, category, message);
}

static const fmi2CallbackFunctions functions = {logger, NULL, NULL, NULL, NULL};

static Instance fresh(void) {
    LOAD(fmi2Instantiate);
    Instance c = fmi2Instantiate("it", fmi2CoSimulation, token, resources, &functions, fmi2False, fmi2False);
    if (!c) {
        exit(4);
    }
    return c;
}

static void begin(Instance c) {
    LOAD(fmi2SetupExperiment);
    LOAD(fmi2EnterInitializationMode);
    LOAD(fmi2ExitInitializationMode);
    CHECK(fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
    CHECK(fmi2EnterInitializationMode(c));
    CHECK(fmi2ExitInitializationMode(c));
}

#define SET_REALS(c, references, n, values) fmi2SetReal(c, references, n, values)
#define GET_REALS(c, references, n, values) fmi2GetReal(c, references, n, values)
#define DO_STEP(c, t, h) CHECK(fmi2DoStep(c, t, h, fmi2True))
#define LOAD_SET LOAD(fmi2SetReal)
#define LOAD_STEP     \
    LOAD_SET;         \
    LOAD(fmi2DoStep); \
    LOAD(fmi2GetReal)
#define LOAD_STATES            \
    LOAD(fmi2GetFMUstate); \
    LOAD(fmi2SetFMUstate); \
    LOAD(fmi2SerializedFMUstateSize)
#define SAVE fmi2GetFMUstate
#define RESTORE fmi2SetFMUstate
#define SAVED_SIZE fmi2SerializedFMUstateSize
#define LOAD_BYTES                  \
    LOAD(fmi2SerializeFMUstate); \
    LOAD(fmi2DeSerializeFMUstate)
#define WRITE fmi2SerializeFMUstate
#define READ fmi2DeSerializeFMUstate
#define LOAD_DERIVATIVE LOAD(fmi2GetDirectionalDerivative)
#define DERIVATIVES(c, out, n, in, seed, values) fmi2GetDirectionalDerivative(c, out, n, in, 1, seed, values)
#define LOAD_FREE LOAD(fmi2FreeInstance)
#define FREE fmi2FreeInstance
#endif

static Instance instance(void) {
    Instance c = fresh();
    begin(c);
    return c;
}

#endif
