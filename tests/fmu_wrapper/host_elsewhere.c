/* What an FMU gives, bit by bit, for any system: host_elsewhere <library> <resources> <token> <step> <steps> <parameter>
 * <value> <input> <output> ...; -DFMI=3: FMI 3.0. Without a parameter or input: 0.
 *
 * A line of outputs a step and, with an input, of their derivatives along it. Then the second half again, from a state
 * that was stored there, and once more in another instance that gets it as bytes, whose sum stands between. */

#include <stdint.h>
#include <string.h>

#include "native_fmi.h"

static char **argument;
static int outputs;
static double step;

static void show(const double *values) {
    for (int i = 0; i < outputs; i++) {
        uint64_t bits;
        memcpy(&bits, values + i, sizeof bits);
        printf("%08lx%08lx ", (unsigned long)(bits >> 32), (unsigned long)(bits & 0xffffffff));
    }
    printf("\n");
}

static void go(Instance c, int from, int to) {
    LOAD_STEP;
    LOAD_DERIVATIVE;
    const Reference in = (Reference)atol(argument[8]);
    Reference *out = malloc((size_t)outputs * sizeof *out);
    double *values = malloc((size_t)outputs * sizeof *values);
    for (int i = 0; i < outputs; i++) {
        out[i] = (Reference)atol(argument[9 + i]);
    }
    for (int k = from; k < to; k++) {
        const double force = 0.25 * (k % 5 - 2), seed = 1.0;
        if (in) {
            CHECK(SET_REALS(c, &in, 1, &force));
        }
        DO_STEP(c, k * step, step);
        CHECK(GET_REALS(c, out, (size_t)outputs, values));
        show(values);
        if (in && k % 4 == 0) {
            CHECK(DERIVATIVES(c, out, (size_t)outputs, &in, &seed, values));
            show(values);
        }
    }
    free(out);
    free(values);
}

int main(int count, char **given) {
    if (count < 10 || !(library = dlopen(given[1], RTLD_NOW | RTLD_LOCAL))) {
        fprintf(stderr, "%s\n", count < 10 ? "wrong arguments" : dlerror());
        return 1;
    }
    argument = given, outputs = count - 9;
    resources = given[2], token = given[3], step = atof(given[4]);
    LOAD_SET;
    LOAD_STATES;
    LOAD_BYTES;
    LOAD_FREE;
    const int steps = atoi(given[5]);
    const Reference parameter = (Reference)atol(given[6]);
    const double value = atof(given[7]);
    Instance c = fresh(), other = instance();
    if (parameter) {
        CHECK(SET_REALS(c, &parameter, 1, &value));
    }
    begin(c);
    go(c, 0, steps / 2);
    State state = NULL, read = NULL;
    size_t size;
    CHECK(SAVE(c, &state));
    go(c, steps / 2, steps);
    CHECK(RESTORE(c, state));
    go(c, steps / 2, steps);
    CHECK(SAVED_SIZE(c, state, &size));
    unsigned char *bytes = malloc(size);
    CHECK(WRITE(c, state, (void *)bytes, size));
    uint32_t sum = 2166136261u;
    for (size_t i = 0; i < size; i++) {
        sum = (sum ^ bytes[i]) * 16777619u;
    }
    printf("%lu bytes, sum %lx\n", (unsigned long)size, (unsigned long)sum);
    CHECK(READ(other, (const void *)bytes, size, &read));
    CHECK(RESTORE(other, read));
    go(other, steps / 2, steps);
    free(bytes);
    FREE(c);
    FREE(other);
    return 0;
}
