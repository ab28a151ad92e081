/* A co-simulation master that knows no Python: host <library> <resources URI> <guid> <vr> <step> <steps> <out>
 *
 * Steps an instance, rolls it back to the middle and steps on, writes the values (hex), and stores its state in
 * <out>; with `-` for <steps> it starts from the state in <out> instead. A second thread does the second half. */
#include <pthread.h>
#include <stdarg.h>
#include <string.h>

#include "fmi2Functions.h"
#include "host.h"

static void *library;

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...) {
    va_list arguments;
    (void)environment;
    printf("log %s %d %s ", name, status, category);
    va_start(arguments, message);
    vprintf(message, arguments);
    va_end(arguments);
    printf("\n");
}

static void *allocate(size_t count, size_t size) { return calloc(count, size); }

typedef struct {
    fmi2Component instance;
    fmi2ValueReference vr;
    double step;
    int from, to;
} Part;

static void *run(void *argument) {
    Part *part = argument;
    LOAD(fmi2DoStep);
    LOAD(fmi2GetReal);
    for (int i = part->from; i < part->to; i++) {
        double value;
        CHECK(fmi2DoStep(part->instance, i * part->step, part->step, fmi2False));
        CHECK(fmi2GetReal(part->instance, &part->vr, 1, &value));
        printf("%d %a\n", i, value);
    }
    return NULL;
}

static void store(fmi2Component instance, const char *path) {
    LOAD(fmi2GetFMUstate);
    LOAD(fmi2SerializedFMUstateSize);
    LOAD(fmi2SerializeFMUstate);
    fmi2FMUstate state = NULL;
    size_t size;
    CHECK(fmi2GetFMUstate(instance, &state));
    CHECK(fmi2SerializedFMUstateSize(instance, state, &size));
    char *bytes = malloc(size);
    CHECK(fmi2SerializeFMUstate(instance, state, bytes, size));
    FILE *file = fopen(path, "wb");
    fwrite(bytes, 1, size, file);
    fclose(file);
    free(bytes);
}

int main(int count, char **argument) {
    if (count != 8 || !(library = dlopen(argument[1], RTLD_NOW | RTLD_LOCAL))) {
        fprintf(stderr, "%s\n", count == 8 ? dlerror() : "wrong arguments");
        return 1;
    }
    fmi2CallbackFunctions callbacks = {logger, allocate, free, NULL, NULL};
    LOAD(fmi2Instantiate);
    LOAD(fmi2SetupExperiment);
    LOAD(fmi2EnterInitializationMode);
    LOAD(fmi2ExitInitializationMode);
    LOAD(fmi2GetFMUstate);
    LOAD(fmi2SetFMUstate);
    LOAD(fmi2FreeFMUstate);
    LOAD(fmi2FreeInstance);
    fmi2Component instance =
        fmi2Instantiate("host", fmi2CoSimulation, argument[3], argument[2], &callbacks, fmi2False, fmi2False);
    if (!instance) {
        return 4;
    }
    int steps = atoi(argument[6]);
    Part first = {instance, (fmi2ValueReference)atoi(argument[4]), atof(argument[5]), 0, steps / 2};
    Part second = first;
    second.from = steps / 2;
    second.to = steps;
    fmi2FMUstate middle = NULL;
    CHECK(fmi2SetupExperiment(instance, fmi2False, 0.0, 0.0, fmi2False, 0.0));
    CHECK(fmi2EnterInitializationMode(instance));
    CHECK(fmi2ExitInitializationMode(instance));
    run(&first);
    store(instance, argument[7]);
    CHECK(fmi2GetFMUstate(instance, &middle));
    for (int again = 0; again < 2; again++) {
        pthread_t thread;
        pthread_create(&thread, NULL, run, &second);
        pthread_join(thread, NULL);
        CHECK(fmi2SetFMUstate(instance, middle));
    }
    CHECK(fmi2FreeFMUstate(instance, &middle));
    printf("python in the environment: %s\n", getenv("PYTHONHOME") ? getenv("PYTHONHOME") : "no");
    fmi2FreeInstance(instance);
    fmi2FreeInstance(NULL);
    dlclose(library);
    printf("end\n");
    return 0;
}
