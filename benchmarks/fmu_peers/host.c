/* A native master that times itself: host <library> <resources> <token> <input vr> <output vr> <output vr> <step>
 * <steps> <torque>. Compiled with -DFMI=2 or -DFMI=3. Sets the input to +-torque, steps, reads both outputs; prints the
 * fastest half's mean, in us a step, and the last output. */
#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#if FMI == 2
#include "fmi2Functions.h"
#else
#include "fmi3Functions.h"
#endif

#define LOAD(name) name##TYPE *name = (name##TYPE *)dlsym(library, #name)
#define CHECK(call) do { if ((call) > 1) { fprintf(stderr, "failed: %s\n", #call); exit(3); } } while (0)
#define BATCH 200

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

#if FMI == 2
static void logger(void *e, fmi2String name, fmi2Status status, fmi2String category, fmi2String message, ...) {
    fprintf(stderr, "%s\n", message);
}
#else
static void logger(void *e, fmi3Status status, fmi3String category, fmi3String message) {
    fprintf(stderr, "%s\n", message);
}
#endif

int main(int count, char **argument) {
    void *library = count == 10 ? dlopen(argument[1], RTLD_NOW) : NULL;
    if (!library) {
        fprintf(stderr, "%s\n", count == 10 ? dlerror() : "wrong arguments");
        return 1;
    }
    unsigned in = (unsigned)atoi(argument[4]), out[2] = {(unsigned)atoi(argument[5]), (unsigned)atoi(argument[6])};
    double step = atof(argument[7]), torque = atof(argument[9]), value = 0.0, values[2];
    int steps = atoi(argument[8]);
    double *batches = calloc((size_t)(steps / BATCH), sizeof *batches);
    double started = now();
#if FMI == 2
    LOAD(fmi2Instantiate);
    LOAD(fmi2SetupExperiment);
    LOAD(fmi2EnterInitializationMode);
    LOAD(fmi2ExitInitializationMode);
    LOAD(fmi2SetReal);
    LOAD(fmi2DoStep);
    LOAD(fmi2GetReal);
    fmi2CallbackFunctions callbacks = {logger, calloc, free, NULL, NULL};
    fmi2Component c = fmi2Instantiate("host", fmi2CoSimulation, argument[3], argument[2], &callbacks, 0, 0);
    if (!c) return 4;
    CHECK(fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0));
    CHECK(fmi2EnterInitializationMode(c));
    CHECK(fmi2ExitInitializationMode(c));
#define STEP \
    CHECK(fmi2SetReal(c, &in, 1, &value)); \
    CHECK(fmi2DoStep(c, i * step, step, 1)); \
    CHECK(fmi2GetReal(c, out, 2, values))
#else
    LOAD(fmi3InstantiateCoSimulation);
    LOAD(fmi3EnterInitializationMode);
    LOAD(fmi3ExitInitializationMode);
    LOAD(fmi3SetFloat64);
    LOAD(fmi3DoStep);
    LOAD(fmi3GetFloat64);
    fmi3Instance c = fmi3InstantiateCoSimulation("host", argument[3], argument[2], 0, 0, 0, 0, NULL, 0, NULL, logger,
                                                 NULL);
    if (!c) return 4;
    CHECK(fmi3EnterInitializationMode(c, 0, 0.0, 0.0, 0, 0.0));
    CHECK(fmi3ExitInitializationMode(c));
    fmi3Boolean due, terminate, early;
    double last;
#define STEP \
    CHECK(fmi3SetFloat64(c, &in, 1, &value, 1)); \
    CHECK(fmi3DoStep(c, i * step, step, 1, &due, &terminate, &early, &last)); \
    CHECK(fmi3GetFloat64(c, out, 2, values, 2))
#endif
    double ready = now();
    for (int i = 0; i < steps; i++) {
        if (i % BATCH == 0) batches[i / BATCH] = now();
        value = i % 2 ? torque : -torque;
        STEP;
        if (i % BATCH == BATCH - 1) batches[i / BATCH] = (now() - batches[i / BATCH]) / BATCH;
    }
    int half = steps / BATCH / 2;
    double sum = 0.0;
    qsort(batches, (size_t)(steps / BATCH), sizeof *batches, ascending);
    for (int k = 0; k < half; k++) sum += batches[k];
    printf("%.3f %.3f %.17g\n", sum / half, 1e-6 * (ready - started), values[0]);
    return 0;
}
