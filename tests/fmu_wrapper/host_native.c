/* An FMI 2.0 master for where there is nothing but a C library: host_native <library> <resources> <guid> <step> <steps>
 * <value reference> ...; a line of values (hex) a step. */

#include "fmi2Functions.h"
#include "host.h"

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...) {
    (void)environment;
    fprintf(stderr, "%s: %d %s: %s\n", name, status, category, message);
}

int main(int count, char **argument) {
    void *library = count > 6 ? dlopen(argument[1], RTLD_NOW | RTLD_LOCAL) : NULL;
    if (!library) {
        fprintf(stderr, "%s\n", count > 6 ? dlerror() : "wrong arguments");
        return 1;
    }
    LOAD(fmi2Instantiate);
    LOAD(fmi2SetupExperiment);
    LOAD(fmi2EnterInitializationMode);
    LOAD(fmi2ExitInitializationMode);
    LOAD(fmi2DoStep);
    LOAD(fmi2GetReal);
    LOAD(fmi2FreeInstance);
    const fmi2CallbackFunctions functions = {logger, NULL, NULL, NULL, NULL};
    fmi2Component c = fmi2Instantiate("it", fmi2CoSimulation, argument[3], argument[2], &functions, fmi2False, fmi2False);
    if (!c) {
        return 2;
    }
    double step = atof(argument[4]);
    CHECK(fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
    CHECK(fmi2EnterInitializationMode(c));
    CHECK(fmi2ExitInitializationMode(c));
    for (int i = 0; i < atoi(argument[5]); i++) {
        CHECK(fmi2DoStep(c, i * step, step, fmi2True));
        for (int k = 6; k < count; k++) {
            fmi2ValueReference vr = (fmi2ValueReference)atoi(argument[k]);
            double value;
            CHECK(fmi2GetReal(c, &vr, 1, &value));
            printf("%a ", value);
        }
        printf("\n");
    }
    fmi2FreeInstance(c);
    return 0;
}
