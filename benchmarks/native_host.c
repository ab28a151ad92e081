/* What an FMU costs a C host: native_host <library> <resources> <guid> <end> <input> <output 1> <output 2>
 *
 * Prints, one a line: ms to load the library; ms to instantiate and initialise; us for setReal + doStep + 2 getReal where
 * the solver has nothing to do; us to store and to restore a state; bytes of a serialised one; us a step of a hundredth of
 * <end>, all included, and the longest of them (each the best of five runs); ms for each of a thousand instances; us a step in
 * each of 16 threads at once. <input> 0: none. CPU time of the process, but for the threads. */

#include <pthread.h>
#include <string.h>
#include <time.h>

#include "../tests/fmu_wrapper/native_fmi.h"

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

/* Seconds for `steps` steps of size h from time t, with what a master does around each. */
static double steps_of(Instance c, double t, double h, int steps) {
    LOAD_STEP;
    const Reference in = (Reference)atoi(argument[5]);
    const Reference out[] = {(Reference)atoi(argument[6]), (Reference)atoi(argument[7])};
    double value[2], zero = 0.0, began = now();
    for (int i = 0; i < steps; i++) {
        if (in) {
            CHECK(SET_REALS(c, &in, 1, &zero));
        }
        DO_STEP(c, t + i * h, h);
        CHECK(GET_REALS(c, out, 2, value));
    }
    return now() - began;
}

/* The longest step of a hundredth of the run, each the best of five runs: s. */
static double longest_step(void) {
    LOAD_FREE;
    double best[100], longest = 0.0;
    for (int turn = 0; turn < 5; turn++) {
        Instance c = instance();
        for (int i = 0; i < 100; i++) {
            double seconds = steps_of(c, 0.01 * end * i, 0.01 * end, 1);
            best[i] = turn && best[i] < seconds ? best[i] : seconds;
        }
        FREE(c);
    }
    for (int i = 0; i < 100; i++) {
        longest = best[i] > longest ? best[i] : longest;
    }
    return longest;
}

static void *in_thread(void *seconds) {
    LOAD_FREE;
    Instance c = instance();
    double t = at_clock(CLOCK_MONOTONIC);
    steps_of(c, 0.0, 0.01 * end, 100);
    *(double *)seconds = at_clock(CLOCK_MONOTONIC) - t;
    FREE(c);
    return NULL;
}

int main(int count, char **given) {
    argument = given;
    double t = now();
    if (count != 8 || !(library = dlopen(given[1], RTLD_NOW | RTLD_LOCAL))) {
        fprintf(stderr, "%s\n", count == 8 ? dlerror() : "wrong arguments");
        return 1;
    }
    resources = given[2], token = given[3], end = atof(given[4]);
    setvbuf(stdout, NULL, _IOLBF, 0);
    LOAD_FREE;
    LOAD_STATES;
    printf("load_ms %.3f\n", 1e3 * (now() - t));
    t = now();
    Instance c = instance();
    printf("instantiate_ms %.3f\n", 1e3 * (now() - t));
    steps_of(c, 0.0, 1e-3 * end, 100);
    enum { MANY = 20000 };
    double at = 1e-3 * end * 100;
    /* so short that the solver is ahead */
    printf("overhead_us %.3f\n", 1e6 * steps_of(c, at, 1e-12 * end, MANY) / MANY);
    State state = NULL;
    size_t size;
    if (SAVE(c, &state) == 0) {
        t = now();
        for (int i = 0; i < MANY; i++) {
            CHECK(SAVE(c, &state));
        }
        printf("save_us %.3f\n", 1e6 * (now() - t) / MANY);
        t = now();
        for (int i = 0; i < MANY; i++) {
            CHECK(RESTORE(c, state));
        }
        printf("restore_us %.3f\n", 1e6 * (now() - t) / MANY);
        CHECK(SAVED_SIZE(c, state, &size));
        printf("state_bytes %zu\n", size);
    }
    FREE(c);
    c = instance();
    printf("step_us %.3f\n", 1e6 * steps_of(c, 0.0, 0.01 * end, 100) / 100);
    FREE(c);
    printf("longest_step_us %.3f\n", 1e6 * longest_step());
    enum { INSTANCES = 1000, THREADS = 16 };
    static Instance all[INSTANCES];
    t = now();
    for (int i = 0; i < INSTANCES; i++) {
        all[i] = instance();
    }
    printf("instance_of_1000_ms %.3f\n", 1e3 * (now() - t) / INSTANCES);
    for (int i = 0; i < INSTANCES; i++) {
        steps_of(all[i], 0.0, 1e-3 * end, 1);
        FREE(all[i]);
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
