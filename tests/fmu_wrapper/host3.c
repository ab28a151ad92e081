/* An FMI 3.0 master that knows no Python: host3 <library> <resources path> <token> <vr> <step> <steps>
 *
 * Steps an instance with event mode and early return, twice from one stored state, and writes how each step ended, the
 * time and the value (hex). */

#include "fmi3Functions.h"
#include "host.h"

static void *library;

static void logger(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message) {
    printf("log %d %s %s%s\n", status, category, message, environment ? " (another's environment)" : "");
}

static void leave_event_mode(fmi3Instance instance) {
    LOAD(fmi3UpdateDiscreteStates);
    LOAD(fmi3EnterStepMode);
    fmi3Boolean again = fmi3True, terminate, nominals, values, defined;
    fmi3Float64 next;
    while (again) {
        CHECK(fmi3UpdateDiscreteStates(instance, &again, &terminate, &nominals, &values, &defined, &next));
    }
    CHECK(fmi3EnterStepMode(instance));
}

static void run(fmi3Instance instance, fmi3ValueReference vr, double step, int steps) {
    LOAD(fmi3DoStep);
    LOAD(fmi3GetFloat64);
    LOAD(fmi3EnterEventMode);
    double time = 0.0;
    for (int i = 0; i < steps;) {
        double end = (i + 1) * step, value;
        fmi3Boolean due, terminate, early;
        CHECK(fmi3DoStep(instance, time, end - time, fmi3False, &due, &terminate, &early, &time));
        CHECK(fmi3GetFloat64(instance, &vr, 1, &value, 1));
        printf("%s %a %a\n", due ? "event" : "step", time, value);
        if (due) {
            CHECK(fmi3EnterEventMode(instance));
            leave_event_mode(instance);
        }
        if (time >= end) {
            i++;
        }
    }
}

int main(int count, char **argument) {
    if (count != 7 || !(library = dlopen(argument[1], RTLD_NOW | RTLD_LOCAL))) {
        fprintf(stderr, "%s\n", count == 7 ? dlerror() : "wrong arguments");
        return 1;
    }
    LOAD(fmi3InstantiateCoSimulation);
    LOAD(fmi3EnterInitializationMode);
    LOAD(fmi3ExitInitializationMode);
    LOAD(fmi3GetFMUState);
    LOAD(fmi3SetFMUState);
    LOAD(fmi3FreeFMUState);
    LOAD(fmi3Terminate);
    LOAD(fmi3FreeInstance);
    fmi3Instance instance = fmi3InstantiateCoSimulation("host", argument[3], argument[2], fmi3False, fmi3False,
                                                        fmi3True, fmi3True, NULL, 0, NULL, logger, NULL);
    if (!instance) {
        return 4;
    }
    fmi3ValueReference vr = (fmi3ValueReference)atoi(argument[4]);
    fmi3FMUState start = NULL;
    CHECK(fmi3EnterInitializationMode(instance, fmi3False, 0.0, 0.0, fmi3False, 0.0));
    CHECK(fmi3ExitInitializationMode(instance));
    leave_event_mode(instance);
    CHECK(fmi3GetFMUState(instance, &start));
    for (int again = 0; again < 2; again++) {
        CHECK(fmi3SetFMUState(instance, start));
        run(instance, vr, atof(argument[5]), atoi(argument[6]));
    }
    CHECK(fmi3FreeFMUState(instance, &start));
    CHECK(fmi3Terminate(instance));
    fmi3FreeInstance(instance);
    fmi3FreeInstance(NULL);
    printf("end\n");
    return 0;
}
