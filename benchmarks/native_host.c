/* What an FMU costs a C host: native_host <library> <resources> <guid> <end> <input> <output 1> <output 2>
 *
 * Prints, one a line: ms to load the library; ms to instantiate and initialise; us for setReal + doStep + 2 getReal where
 * the solver has nothing to do; us to store and to restore a state; bytes of a serialised one; us a step of a hundredth of
 * <end>, all included, and the longest of them (each the best of five runs); ms for each of a thousand instances; us a step in
 * each of 16 threads at once. <input> 0: none. CPU time of the process, but for the threads. */

#include <pthread.h>
#include <string.h>
#include <time.h>

#include "fmi2Functions.h"
#include "../tests/fmu_wrapper/host.h"

static void *library;
static char **argument;
static double end;

static double at_clock(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double now(void) {
    return at_clock(CLOCK_PROCESS_CPUTIME_ID);
}

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...) {
    (void)environment;
    fprintf(stderr, "%s: %d %s: %s\n", name, status, category, message);
}

static const fmi2CallbackFunctions functions = {logger, NULL, NULL, NULL, NULL};

static fmi2Component begin(void) {
    LOAD(fmi2Instantiate);
    LOAD(fmi2SetupExperiment);
    LOAD(fmi2EnterInitializationMode);
    LOAD(fmi2ExitInitializationMode);
    fmi2Component c = fmi2Instantiate("it", fmi2CoSimulation, argument[3], argument[2], &functions, fmi2False, fmi2False);
    if (!c) {
        exit(4);
    }
    CHECK(fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
    CHECK(fmi2EnterInitializationMode(c));
    CHECK(fmi2ExitInitializationMode(c));
    return c;
}

/* Seconds for `steps` steps of size h from time t, with what a master does around each. */
static double steps_of(fmi2Component c, double t, double h, int steps) {
    LOAD(fmi2SetReal);
    LOAD(fmi2DoStep);
    LOAD(fmi2GetReal);
    const fmi2ValueReference in = (fmi2ValueReference)atoi(argument[5]);
    const fmi2ValueReference out[] = {(fmi2ValueReference)atoi(argument[6]), (fmi2ValueReference)atoi(argument[7])};
    double value[2], zero = 0.0, began = now();
    for (int i = 0; i < steps; i++) {
        if (in) {
            CHECK(fmi2SetReal(c, &in, 1, &zero));
        }
        CHECK(fmi2DoStep(c, t + i * h, h, fmi2True));
        CHECK(fmi2GetReal(c, out, 2, value));
    }
    return now() - began;
}

/* The longest step of a hundredth of the run, each the best of five runs: s. */
static double longest_step(void) {
    LOAD(fmi2FreeInstance);
    double best[100], longest = 0.0;
    for (int turn = 0; turn < 5; turn++) {
        fmi2Component c = begin();
        for (int i = 0; i < 100; i++) {
            double seconds = steps_of(c, 0.01 * end * i, 0.01 * end, 1);
            best[i] = turn && best[i] < seconds ? best[i] : seconds;
        }
        fmi2FreeInstance(c);
    }
    for (int i = 0; i < 100; i++) {
        longest = best[i] > longest ? best[i] : longest;
    }
    return longest;
}

static void *in_thread(void *seconds) {
    LOAD(fmi2FreeInstance);
    fmi2Component c = begin();
    double t = at_clock(CLOCK_MONOTONIC);
    steps_of(c, 0.0, 0.01 * end, 100);
    *(double *)seconds = at_clock(CLOCK_MONOTONIC) - t;
    fmi2FreeInstance(c);
    return NULL;
}

int main(int count, char **given) {
    argument = given;
    double t = now();
    if (count != 8 || !(library = dlopen(given[1], RTLD_NOW | RTLD_LOCAL))) {
        fprintf(stderr, "%s\n", count == 8 ? dlerror() : "wrong arguments");
        return 1;
    }
    end = atof(given[4]);
    LOAD(fmi2FreeInstance);
    LOAD(fmi2GetFMUstate);
    LOAD(fmi2SetFMUstate);
    LOAD(fmi2SerializedFMUstateSize);
    printf("load_ms %.3f\n", 1e3 * (now() - t));
    t = now();
    fmi2Component c = begin();
    printf("instantiate_ms %.3f\n", 1e3 * (now() - t));
    steps_of(c, 0.0, 1e-3 * end, 100);
    enum { MANY = 20000 };
    double at = 1e-3 * end * 100;
    /* so short that the solver is ahead */
    printf("overhead_us %.3f\n", 1e6 * steps_of(c, at, 1e-12 * end, MANY) / MANY);
    fmi2FMUstate state = NULL;
    size_t size;
    CHECK(fmi2GetFMUstate(c, &state));
    t = now();
    for (int i = 0; i < MANY; i++) {
        CHECK(fmi2GetFMUstate(c, &state));
    }
    printf("save_us %.3f\n", 1e6 * (now() - t) / MANY);
    t = now();
    for (int i = 0; i < MANY; i++) {
        CHECK(fmi2SetFMUstate(c, state));
    }
    printf("restore_us %.3f\n", 1e6 * (now() - t) / MANY);
    CHECK(fmi2SerializedFMUstateSize(c, state, &size));
    printf("state_bytes %zu\n", size);
    fmi2FreeInstance(c);
    c = begin();
    printf("step_us %.3f\n", 1e6 * steps_of(c, 0.0, 0.01 * end, 100) / 100);
    fmi2FreeInstance(c);
    printf("longest_step_us %.3f\n", 1e6 * longest_step());
    enum { INSTANCES = 1000, THREADS = 16 };
    static fmi2Component all[INSTANCES];
    t = now();
    for (int i = 0; i < INSTANCES; i++) {
        all[i] = begin();
    }
    printf("instance_of_1000_ms %.3f\n", 1e3 * (now() - t) / INSTANCES);
    for (int i = 0; i < INSTANCES; i++) {
        steps_of(all[i], 0.0, 1e-3 * end, 1);
        fmi2FreeInstance(all[i]);
    }
    pthread_t thread[THREADS];
    double seconds[THREADS], sum = 0.0;
    for (int i = 0; i < THREADS; i++) {
        pthread_create(&thread[i], NULL, in_thread, &seconds[i]);
    }
    for (int i = 0; i < THREADS; i++) {
        pthread_join(thread[i], NULL);
        sum += seconds[i];
    }
    printf("step_in_16_threads_us %.3f\n", 1e6 * sum / THREADS / 100);
    return 0;
}
