/* Random sequences of FMI 3.0 calls on an FMU without Python: fuzz_native <resources> <token> <seed> <sequences> <variables>
 *
 * Linked with the C sources themselves, so that sanitizers see them. Calls come in any order, with arguments that are
 * wrong now and then; whatever they answer, each instance must go on living, and nothing may leak. */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi3Functions.h"

extern int fmi2SetRealInputDerivatives(void *c, const unsigned vr[], size_t n, const int order[], const double value[]);

enum { INSTANCES = 3, STATES = 4, MOST = 12 };
#define END 0.4 /* s: a step beyond it is refused, and so none takes long */

static unsigned long long seed;
static unsigned variables;
static long calls, refused;

static unsigned any(unsigned below) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (unsigned)(seed >> 33) % below;
}

static void logger(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message) {
    (void)environment, (void)status;
    if (!category || !message || !strlen(message)) {
        abort();
    }
}

typedef struct {
    fmi3Instance fmu;
    fmi3FMUState state[STATES];
    fmi3Byte *bytes;
    size_t size;
    double time;
} Held;

static double number(void) {
    static const double odd[] = {0.0, -1.0, NAN, INFINITY, 1e300, -1e-300, 5.0, 0.5};
    return any(6) ? any(1000) * 0.01 - 5.0 : odd[any(8)];
}

static void values(Held *h) {
    fmi3ValueReference vr[MOST];
    double reals[MOST];
    fmi3Int32 ints[MOST];
    fmi3Int64 longs[MOST];
    fmi3Boolean flags[MOST];
    size_t n = any(MOST), room = any(20) ? n : any(MOST);
    for (size_t k = 0; k < n; k++) {
        vr[k] = any(30) ? 1 + any(variables) : any(100000);
        reals[k] = number();
        ints[k] = 1, longs[k] = 1, flags[k] = true;
    }
    const fmi3ValueReference *given = any(60) ? vr : NULL;
    fmi3Status s = fmi3OK;
    switch (any(8)) {
    case 0: case 1: case 2: s = fmi3GetFloat64(h->fmu, given, n, any(60) ? reals : NULL, room); break;
    case 3:
        n = any(3) ? 1 : n;
        s = fmi3SetFloat64(h->fmu, given, n, any(60) ? reals : NULL, any(3) ? n : room);
        break;
    case 4: s = fmi3GetInt32(h->fmu, given, n, any(60) ? ints : NULL, room); break;
    case 5: s = fmi3GetInt64(h->fmu, given, n, any(60) ? longs : NULL, room); break;
    case 6: s = fmi3GetBoolean(h->fmu, given, n, any(60) ? flags : NULL, room); break;
    default: s = fmi3SetInt32(h->fmu, given, n, ints, n);
    }
    refused += s != fmi3OK;
}

static void step(Held *h) {
    fmi3Boolean due = false, terminate, early, again = false, nominals, changed, defined;
    double last = h->time, next, length = any(10) ? 0.001 * any(60) : number();
    fmi3Status s = fmi3DoStep(h->fmu, any(30) ? h->time : number(), length, false, any(80) ? &due : NULL, &terminate, &early,
                              &last);
    if (s == fmi3OK) {
        h->time = last;
    }
    refused += s != fmi3OK;
    if (due || !any(12)) {
        fmi3EnterEventMode(h->fmu);
        for (int k = 0; k < 60 && (k == 0 || again); k++) {
            fmi3UpdateDiscreteStates(h->fmu, any(40) ? &again : NULL, &terminate, &nominals, &changed, &defined, &next);
        }
        if (any(12)) {
            fmi3EnterStepMode(h->fmu);
        }
    }
}

static void states(Held *h) {
    unsigned k = any(STATES);
    size_t size = 0;
    fmi3Status s = fmi3OK;
    switch (any(7)) {
    case 0: case 1: s = fmi3GetFMUState(h->fmu, any(60) ? &h->state[k] : NULL); break;
    case 2: s = fmi3SetFMUState(h->fmu, h->state[k]); break;
    case 3: s = fmi3FreeFMUState(h->fmu, &h->state[k]); break;
    case 4: s = fmi3SetFMUState(h->fmu, (fmi3FMUState)&size); break;
    case 5:
        s = fmi3SerializedFMUStateSize(h->fmu, h->state[k], &size);
        if (s == fmi3OK) {
            free(h->bytes);
            h->bytes = malloc(size);
            h->size = size;
            s = fmi3SerializeFMUState(h->fmu, h->state[k], h->bytes, any(20) ? size : size / 2);
        }
        break;
    default:
        if (h->bytes) {
            if (!any(3)) {
                h->bytes[any((unsigned)h->size)] ^= 1 << any(8);
            }
            s = fmi3DeserializeFMUState(h->fmu, h->bytes, any(20) ? h->size : any((unsigned)h->size), &h->state[k]);
        }
    }
    refused += s != fmi3OK;
    if (s == fmi3OK) {
        fmi3ValueReference time = 1;
        fmi3GetFloat64(h->fmu, &time, 1, &h->time, 1);
    }
}

static void life(Held *h) {
    fmi3String categories[] = {"logEvents", "nothing", NULL};
    fmi3Status s = fmi3OK;
    switch (any(8)) {
    case 0: s = fmi3EnterInitializationMode(h->fmu, any(3) == 0, number(), any(9) ? 0.0 : number(), true, END); break;
    case 1: case 2: s = fmi3ExitInitializationMode(h->fmu); break;
    case 3: s = any(12) ? fmi3OK : fmi3Terminate(h->fmu); break;
    case 4: s = fmi3SetDebugLogging(h->fmu, any(2), any(3), any(30) ? categories : NULL); break;
    case 5: s = fmi3EnterEventMode(h->fmu); break;
    case 6: s = fmi3EnterStepMode(h->fmu); break;
    default:
        if (!any(6)) {
            s = fmi3Reset(h->fmu);
            h->time = 0.0;
        }
    }
    refused += s != fmi3OK;
}

static void derivatives(Held *h) {
    fmi3ValueReference unknown[MOST], known[MOST];
    double seeds[MOST], found[MOST];
    fmi3Int32 order[MOST];
    size_t n = 1 + any(2), m = 1 + any(2), room = any(12) ? n : any(MOST);
    for (size_t k = 0; k < MOST; k++) {
        unknown[k] = 1 + any(variables), known[k] = 1 + any(variables);
        seeds[k] = number();
        order[k] = any(20) ? 1 : 2;
    }
    fmi3Status s;
    switch (any(4)) {
    case 3: /* FMI 2.0 has what 3.0 has not, and instances are the same */
        s = (fmi3Status)fmi2SetRealInputDerivatives(h->fmu, known, m, any(60) ? order : NULL, seeds);
        break;
    case 0: s = fmi3GetDirectionalDerivative(h->fmu, unknown, n, known, m, any(60) ? seeds : NULL, m, found, room); break;
    case 1: s = fmi3GetAdjointDerivative(h->fmu, unknown, m, known, n, seeds, m, any(60) ? found : NULL, room); break;
    default: s = fmi3GetOutputDerivatives(h->fmu, unknown, n, any(60) ? order : NULL, found, room);
    }
    refused += s != fmi3OK;
}

/* What a host may do in an intermediate update, and what it may not. */
static void update(fmi3InstanceEnvironment environment, double time, fmi3Boolean set, fmi3Boolean get, fmi3Boolean finished,
                   fmi3Boolean may_return, fmi3Boolean *returns, double *return_time) {
    (void)set, (void)get, (void)finished;
    Held *h = environment;
    if (h->fmu) {
        unsigned what = any(12);
        double now = h->time;
        calls++;
        (what < 5 ? values : what < 7 ? derivatives : what < 9 ? states : what < 10 ? step : life)(h);
        h->time = now;
    }
    *returns = may_return && !any(9);
    *return_time = any(3) ? time : number();
}

static void end(Held *h) {
    fmi3FreeInstance(h->fmu);
    free(h->bytes);
    memset(h, 0, sizeof *h);
}

int main(int count, char **argument) {
    static Held held[INSTANCES];
    if (count != 6) {
        return 1;
    }
    seed = (unsigned long long)atoll(argument[3]);
    variables = (unsigned)atoi(argument[5]);
    for (long k = 0; k < atol(argument[4]); k++) {
        Held *h = &held[any(INSTANCES)];
        if (!h->fmu || !any(8)) {
            fmi3ValueReference wanted[] = {1 + any(variables), 1 + any(variables)};
            end(h);
            h->fmu = fmi3InstantiateCoSimulation("it", any(50) ? argument[2] : "{other}", any(50) ? argument[1] : NULL, false,
                                                 any(2), any(2), any(2), wanted, any(3), h, logger, any(3) ? NULL : update);
            for (unsigned sets = any(4); h->fmu && sets; sets--) { /* parameters, at times */
                values(h);
            }
            if (h->fmu && any(10)) {
                fmi3EnterInitializationMode(h->fmu, false, 0.0, 0.0, true, END);
                fmi3ExitInitializationMode(h->fmu);
                fmi3EnterStepMode(h->fmu);
            }
        }
        for (unsigned more = any(20); h->fmu && more; more--, calls++) {
            unsigned what = any(11);
            (what < 4 ? step : what < 7 ? values : what < 8 ? derivatives : what < 10 ? states : life)(h);
        }
    }
    for (int k = 0; k < INSTANCES; k++) {
        end(&held[k]);
    }
    printf("%ld calls, %ld refused\n", calls, refused);
    return 0;
}
