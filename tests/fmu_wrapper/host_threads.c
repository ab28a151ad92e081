/* A co-simulation master that knows no Python and makes its instances in threads, all at once:
 * host_threads <threads> <steps> <step> (<library> <resources URI> <guid> <vr>)...
 *
 * The threads take the FMUs in turn. Each makes an instance and, with <steps> above 0, steps it once all are ready. A line
 * for each: number of the FMU, its last value (hex), wall-clock time of its steps, s. */
#include <pthread.h>
#include <stdarg.h>
#include <time.h>

#include "fmi2Functions.h"
#include "host.h"

enum { MOST = 64 };

static pthread_barrier_t all;
static int steps;
static double step;

typedef struct {
    void *library;
    const char *resources, *guid;
    fmi2ValueReference vr;
    pthread_t thread;
    double value, seconds;
} Part;

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...) {
    va_list arguments;
    (void)environment, (void)name, (void)status, (void)category;
    va_start(arguments, message);
    vfprintf(stderr, message, arguments);
    va_end(arguments);
    fputc('\n', stderr);
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void *allocate(size_t count, size_t size) { return calloc(count, size); }

static void *run(void *argument) {
    static const fmi2CallbackFunctions callbacks = {logger, allocate, free, NULL, NULL};
    Part *part = argument;
    void *library = part->library;
    LOAD(fmi2Instantiate);
    LOAD(fmi2SetupExperiment);
    LOAD(fmi2EnterInitializationMode);
    LOAD(fmi2ExitInitializationMode);
    LOAD(fmi2DoStep);
    LOAD(fmi2GetReal);
    LOAD(fmi2FreeInstance);
    pthread_barrier_wait(&all);
    fmi2Component instance =
        fmi2Instantiate("thread", fmi2CoSimulation, part->guid, part->resources, &callbacks, fmi2False, fmi2False);
    if (!instance) {
        return steps > 0 ? (exit(4), NULL) : NULL; /* the others wait for it */
    }
    if (steps > 0) {
        CHECK(fmi2SetupExperiment(instance, fmi2False, 0.0, 0.0, fmi2False, 0.0));
        CHECK(fmi2EnterInitializationMode(instance));
        CHECK(fmi2ExitInitializationMode(instance));
        CHECK(fmi2DoStep(instance, 0.0, step, fmi2False)); /* compiled or loaded now */
        pthread_barrier_wait(&all);
    }
    double begin = now();
    for (int i = 1; i < steps; i++) {
        CHECK(fmi2DoStep(instance, i * step, step, fmi2False));
        CHECK(fmi2GetReal(instance, &part->vr, 1, &part->value));
    }
    part->seconds = now() - begin;
    fmi2FreeInstance(instance);
    return part;
}

int main(int count, char **argument) {
    static Part parts[MOST];
    int threads = count > 1 ? atoi(argument[1]) : 0, fmus = (count - 4) / 4, good = 0;
    if (threads < 1 || threads > MOST || fmus < 1) {
        fprintf(stderr, "wrong arguments\n");
        return 1;
    }
    steps = atoi(argument[2]);
    step = atof(argument[3]);
    pthread_barrier_init(&all, NULL, (unsigned)threads);
    for (int i = 0; i < threads; i++) {
        char **fmu = argument + 4 + 4 * (i % fmus);
        parts[i] = (Part){dlopen(fmu[0], RTLD_NOW | RTLD_LOCAL), fmu[1], fmu[2], (fmi2ValueReference)atoi(fmu[3]),
                          0, 0.0, 0.0};
        if (!parts[i].library || pthread_create(&parts[i].thread, NULL, run, &parts[i]) != 0) {
            fprintf(stderr, "cannot start: %s\n", dlerror());
            return 1;
        }
    }
    for (int i = 0; i < threads; i++) {
        void *done = NULL;
        pthread_join(parts[i].thread, &done);
        good += done != NULL;
        printf("%d %a %.6f\n", i % fmus, parts[i].value, parts[i].seconds);
    }
    return good == threads ? 0 : 4;
}
